"""The confidence interval of a rate that was counted in a number of runs."""

from math import floor, log10

CONFIDENCE = 0.95
LARGEST = 1e12  # runs


def exact(count, runs, confidence=CONFIDENCE):
    """Lowest and highest rate compatible with ``count`` of ``runs`` (exact, Clopper-Pearson), with
    (1 - ``confidence``) / 2 beyond each end."""
    from scipy.special import betaincinv  # imported here: only commands that run scenes wait for SciPy

    if not 0 <= count <= runs or not 1 <= runs <= LARGEST or count != int(count) or runs != int(runs):
        raise ValueError(
            f"count = {count} must be a whole number in 0 .. runs, and runs = {runs} one in 1 .. {LARGEST:g}"
        )
    tail = (1.0 - confidence) / 2.0
    low = float(betaincinv(count, runs - count + 1, tail)) if count else 0.0
    high = float(betaincinv(count + 1, runs - count, 1.0 - tail)) if count < runs else 1.0
    return low, high


def rate(count, runs):
    """The entry of a summary: {"count", "runs", "rate", "low", "high"}, the last three as shares."""
    low, high = exact(count, runs)
    shares = {"rate": count / runs, "low": low, "high": high}
    return {"count": count, "runs": runs, **{key: _rounded(share) for key, share in shares.items()}}


def _rounded(share):
    """``share`` to six decimals, or to as many as show three digits of its distance from the nearer of 0 and
    1: an end of an interval that differs from both still does."""
    apart = min(share, 1.0 - share)
    return round(share, max(6, 2 - floor(log10(apart)))) if apart > 0 else share


def words(found, of="runs"):
    """``3 of 40 runs (7.5 %, 95 % interval 1.57 to 20.4 %)``; ``of``: what was counted."""
    between = ends(found["low"], found["high"])
    share = f"{_percent(found['rate'])} %, 95 % interval {between} %"
    return f"{found['count']} of {found['runs']} {of} ({share})"


def ends(low, high):
    """Two shares as percentages: ``0 to 3.62``."""
    return f"{_percent(low)} to {_percent(high)}"


def _percent(share):
    """Three digits, and near 100 % those of the distance from it."""
    apart = float(f"{100 * (1.0 - share):.3g}")
    return f"{100 * share:.{1 - floor(log10(apart))}f}" if 0 < apart < 0.05 else f"{100 * share:.3g}"
