"""The confidence interval of a rate that was counted in a number of runs."""

CONFIDENCE = 0.95


def exact(count, runs, confidence=CONFIDENCE):
    """Lowest and highest rate compatible with ``count`` of ``runs`` (exact, Clopper-Pearson), with
    (1 - ``confidence``) / 2 beyond each end."""
    from scipy.special import betaincinv  # imported here: only commands that run scenes wait for SciPy

    if not 0 <= count <= runs or runs < 1:
        raise ValueError(f"count = {count} must lie in 0 .. runs, and runs = {runs} must be 1 or more")
    tail = (1.0 - confidence) / 2.0
    low = float(betaincinv(count, runs - count + 1, tail)) if count else 0.0
    high = float(betaincinv(count + 1, runs - count, 1.0 - tail)) if count < runs else 1.0
    return low, high


def rate(count, runs):
    """The entry of a summary: {"count", "runs", "rate", "low", "high"}, the last three as shares."""
    low, high = exact(count, runs)
    shares = {"rate": count / runs, "low": low, "high": high}
    return {"count": count, "runs": runs, **{key: round(share, 6) for key, share in shares.items()}}


def words(found, of="runs"):
    """``3 of 40 runs (7.5 %, 95 % interval 1.57 to 20.4 %)``; ``of``: what was counted."""
    between = ends(found["low"], found["high"])
    share = f"{100 * found['rate']:.3g} %, 95 % interval {between} %"
    return f"{found['count']} of {found['runs']} {of} ({share})"


def ends(low, high):
    """Two shares as percentages: ``0 to 3.62``."""
    return f"{100 * low:.3g} to {100 * high:.3g}"
