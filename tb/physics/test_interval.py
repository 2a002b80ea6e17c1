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


@pytest.mark.parametrize("count, runs", [(-1, 3), (4, 3), (0, 0)])
def test_impossible_counts_are_refused(count, runs):
    with pytest.raises(ValueError, match="count"):
        interval.exact(count, runs)
