"""Exact intervals of rates, against sums of the binomial distribution in fractions, and against SciPy."""

from fractions import Fraction
from math import comb

import pytest

from meissner import interval


def tail(rate, counts, runs):
    rate = Fraction(rate)
    return float(sum(comb(runs, k) * rate**k * (1 - rate) ** (runs - k) for k in counts))


@pytest.mark.parametrize("count, runs", [(0, 100), (1, 7), (3, 40), (39, 40), (40, 40), (0, 1)])
def test_ends_leave_a_fortieth_on_either_side(count, runs):
    from scipy.stats import binomtest  # takes 0.2 s to import, in each worker

    low, high = interval.exact(count, runs)
    if count:
        assert tail(low, range(count, runs + 1), runs) == pytest.approx(0.025, rel=1e-9)
    else:
        assert low == 0
    if count < runs:
        assert tail(high, range(count + 1), runs) == pytest.approx(0.025, rel=1e-9)
    else:
        assert high == 1
    theirs = binomtest(count, runs).proportion_ci(0.95, "exact")
    assert (low, high) == pytest.approx((theirs.low, theirs.high), abs=1e-12)


def test_no_miss_in_a_hundred_runs_leaves_three_and_a_half_percent():
    """By hand: (1 - p)^100 = 0.025, so p = 1 - 0.025^(1/100) = 3.62 %."""
    found = interval.rate(0, 100)
    assert found == {"count": 0, "runs": 100, "rate": 0.0, "low": 0.0, "high": 0.036217}
    assert interval.words(found) == "0 of 100 runs (0 %, 95 % interval 0 to 3.62 %)"


@pytest.mark.parametrize("runs", [10**6, 10**9, 10**12])
def test_an_end_is_neither_0_nor_1_unless_it_is(runs):
    """By hand: 0.025^(1/n) = exp(-3.6889/n), so of n runs without a miss the upper end is 3.6889/n; of n
    misses the lower end has the same distance from 1. One of n is 1/n."""
    none, every = interval.rate(0, runs), interval.rate(runs, runs)
    assert none["low"] == 0 and none["high"] == pytest.approx(3.6889 / runs, rel=2e-3)
    assert every["high"] == 1 and 1 - every["low"] == pytest.approx(3.6889 / runs, rel=4e-3)
    assert interval.rate(1, runs)["rate"] == pytest.approx(1 / runs)
    assert 0 < 1 - interval.rate(runs - 1, runs)["rate"] < 2 / runs
    assert " 0 to 0 %" not in interval.words(none) and "100 to 100 %" not in interval.words(every)
    assert interval.words(interval.rate(runs - 1, runs)).count("100 %") == 0


def test_percentages_near_100_by_hand():
    found = {"count": 9999, "runs": 10000, "rate": 0.9999, "low": 0.99944, "high": 0.9999975}
    assert interval.words(found) == "9999 of 10000 runs (99.990 %, 95 % interval 99.9 to 99.99975 %)"


@pytest.mark.parametrize(
    "count, runs",
    [(-1, 3), (4, 3), (0, 0), (float("nan"), 3), (0, float("inf")), (0.5, 3), (1, 2.5), (0, 1e13)],
)
def test_impossible_counts_are_refused(count, runs):
    with pytest.raises(ValueError, match="count"):
        interval.exact(count, runs)
