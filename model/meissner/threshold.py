"""``meissner threshold``: thresholds of slip from a quiet hold, with the rate of false alarms they promise.

The largest p2p of a block of windows, over all channels, follows a generalised extreme-value law G as
blocks get long. p2p is an integer, so a block's largest is k with probability G(k + 1/2) - G(k - 1/2);
location, scale and shape are those of the greatest likelihood. A threshold T gives an alarm in a block with
p = 1 - G(T + 1/2).

p's interval: the p for which the greatest likelihood of the other two parameters is within the 95 % point of
chi-squared(1) (profile likelihood). T is the smallest whose interval ends at or below the rate wanted.

Noise with a memory: blocks are doubled until the ranks of one and the next do not correlate; alarms within a
block count as one.
"""

from dataclasses import dataclass

import numpy as np

from meissner.engines import load
from meissner.files import check_out, written
from meissner.interval import CONFIDENCE
from meissner.terminal import plain

LEAST_BLOCKS = 50
MOST_BLOCKS = 400  # of the fit; more blocks would be shorter ones, and less extreme
LEAST_WINDOWS = 20  # of a block
EXTRAPOLATED = 100  # longest time between promised alarms, in recordings
SHAPES = 0.5  # largest size of the shape: beyond, likelihood or mean do not exist
CORRELATED = 2.6  # standard deviations of a rank correlation that is none: 1 in 200
UNLIKELY = 1e-3  # p of a test that refuses a recording
KEEP_SHARE = 0.01  # of quiet windows above keep_threshold


@dataclass(frozen=True)
class Law:
    """The law of the blocks' largest p2p, and what it rests on.

    ``values``, ``counts``: the largest p2p of blocks; ``block_s``: seconds of one; ``windows``: in all;
    ``likelihood``: of the best parameters (location, log scale, shape).
    """

    values: np.ndarray
    counts: np.ndarray
    block_s: float
    windows: int
    best: np.ndarray
    likelihood: float

    @property
    def blocks(self):
        return int(self.counts.sum())

    @property
    def seconds(self):
        return self.blocks * self.block_s

    def per_hour(self, chance):
        """Alarms an hour of a chance for each block."""
        return chance * 3600 / self.block_s

    def rate(self, threshold):
        """The best estimate of alarms an hour above ``threshold``."""
        return self.per_hour(-np.expm1(-_tail(np.array([threshold + 0.5]), *self.best)[0]))

    def _profile(self, threshold, chance):
        """Twice the log likelihood that is lost if an alarm in a block has this ``chance``."""
        from scipy.optimize import minimize

        tail = -np.log1p(-chance)

        def cost(free):
            log_scale, shape = free
            if abs(shape) > SHAPES:
                return np.inf
            rise = -np.log(tail) if abs(shape) < 1e-9 else (tail**-shape - 1) / shape
            location = threshold + 0.5 - np.exp(log_scale) * rise
            return -_log_likelihood(self.values, self.counts, location, log_scale, shape)

        starts = [[self.best[1], self.best[2]], [self.best[1] + 0.5, min(self.best[2] + 0.2, 0.4)]]
        least = min(
            minimize(cost, start, method="Nelder-Mead", options={"xatol": 1e-3, "fatol": 1e-3}).fun
            for start in starts
        )
        return 2 * (least + self.likelihood)

    def excluded(self, threshold, per_hour):
        """Whether more than ``per_hour`` alarms above ``threshold`` are outside the interval."""
        from scipy.stats import chi2

        chance = per_hour * self.block_s / 3600
        if self.rate(threshold) >= per_hour or chance >= 1:
            return chance >= 1
        return self._profile(threshold, chance) > chi2.ppf(CONFIDENCE, 1)

    def interval(self, threshold, within=0.001):
        """(lowest, highest) alarms an hour above ``threshold`` that fit the recording; each end
        at most a share ``within`` too far out."""
        from scipy.stats import chi2

        limit, rate = chi2.ppf(CONFIDENCE, 1), self.rate(threshold)
        best = min(max(rate * self.block_s / 3600, 1e-12), 1 - 1e-9)
        ends = []
        for outside in (1e-12, 1 - 1e-9):
            inner, outer = np.log([best, outside])
            if self._profile(threshold, outside) > limit:
                while abs(outer - inner) > within:
                    middle = (inner + outer) / 2
                    far = self._profile(threshold, np.exp(middle)) > limit
                    inner, outer = (inner, middle) if far else (middle, outer)
            ends.append(self.per_hour(np.exp(outer)))
        return (0.0 if ends[0] <= self.per_hour(2e-12) else ends[0]), ends[1]


def _tail(x, location, log_scale, shape):
    """-log G(x)."""
    z = (x - location) / np.exp(log_scale)
    if abs(shape) < 1e-9:
        return np.exp(np.minimum(-z, 700))
    inside = 1 + shape * z
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        beyond = 0.0 if shape < 0 else np.inf
        return np.where(inside > 0, np.power(np.maximum(inside, 0), -1 / shape), beyond)


def _log_likelihood(values, counts, location, log_scale, shape):
    low, high = (_tail(values + half, location, log_scale, shape) for half in (-0.5, 0.5))
    with np.errstate(divide="ignore", invalid="ignore"):
        each = np.where(low > high, -high + np.log(-np.expm1(high - low)), -np.inf)
    found = counts @ each
    return found if np.isfinite(found) else -1e300


def fit(largest, window_s):
    """The Law of the ``largest`` p2p [windows] of a quiet recording, one each ``window_s``.

    ValueError with one sentence for a recording that is too short or not quiet.
    """
    from scipy.optimize import minimize
    from scipy.stats import mannwhitneyu, rankdata

    if not largest.any():
        raise ValueError(
            "the recording never moves: p2p is 0 codes in every window; is the sensor connected?"
        )
    size, blocks = max(LEAST_WINDOWS, len(largest) // MOST_BLOCKS), largest[:0]
    while (count := len(largest) // size) >= LEAST_BLOCKS:
        blocks = largest[: count * size].reshape(count, size).max(axis=1)
        ranks = rankdata(blocks)
        if not np.ptp(blocks) or np.corrcoef(ranks[:-1], ranks[1:])[0, 1] * count**0.5 < CORRELATED:
            break
        size *= 2
    halves = blocks[: len(blocks) // 2], blocks[len(blocks) // 2 :]
    if len(blocks) and np.ptp(blocks) and mannwhitneyu(*halves).pvalue < UNLIKELY:
        medians = [np.median(half) for half in halves]
        raise ValueError(
            f"the recording is no quiet hold: the median of the largest p2p of blocks is {medians[0]:g} "
            f"codes in its first half and {medians[1]:g} in its second"
        )
    if count < LEAST_BLOCKS:
        why = "" if size == LEAST_WINDOWS else f" (noise correlated over {size * window_s / 2:.3g} s)"
        raise ValueError(
            f"{len(largest) * window_s:.3g} s of hold{why} are too short to promise anything: "
            f"{LEAST_BLOCKS * size * window_s:.3g} s or more are needed"
        )
    values, counts = np.unique(blocks, return_counts=True)
    spread = max(blocks.std() * 6**0.5 / np.pi, 0.2)
    cost = lambda p: (
        np.inf if abs(p[2]) > SHAPES else -_log_likelihood(values, counts, p[0], np.clip(p[1], -5, 30), p[2])
    )
    starts = [[blocks.mean() - 0.5772 * spread, np.log(spread), shape] for shape in (-0.1, 0.1)]
    options = {"xatol": 1e-4, "fatol": 1e-4, "maxiter": 4000, "maxfev": 4000}
    found = [minimize(cost, start, method="Nelder-Mead", options=options) for start in starts]
    best = min(found, key=lambda one: one.fun)
    law = Law(values, counts, size * window_s, len(largest), best.x, -best.fun)
    rare = law.rate(values[-1] - 1) * law.seconds / 3600  # how often it was to be expected
    if rare < UNLIKELY:
        raise ValueError(
            f"the recording is no quiet hold: p2p at {np.argmax(largest) * window_s:.3f} s is {values[-1]} "
            f"codes, which its other noise would reach once in {law.seconds / 3600 / rare:.2g} hours"
        )
    _check_fit(law)
    return law


def _check_fit(law):
    """ValueError if blocks do not follow the law: chi-squared of groups of five or more expected ones."""
    from scipy.stats import chi2

    edges = np.arange(law.values[0], law.values[-1] + 1) + 0.5
    below = np.exp(-_tail(edges, *law.best))
    below[-1] = 1.0
    seen = np.cumsum([law.counts[law.values == k].sum() for k in edges - 0.5])
    groups, last = [], (0.0, 0)
    for share, count in zip(below, seen):
        if (share - last[0]) * law.blocks >= 5 and ((1 - share) * law.blocks >= 5 or share == 1):
            groups.append(((share - last[0]) * law.blocks, count - last[1]))
            last = share, count
    free = len(groups) - 4
    if free < 1:
        return
    far = sum((count - expected) ** 2 / expected for expected, count in groups)
    if chi2.sf(far, free) < UNLIKELY:
        raise ValueError(
            f"the largest p2p of {law.block_s:.3g} s, {law.values[0]} to {law.values[-1]} codes, follow no "
            "extreme-value law: is there more than a quiet hold in the recording?"
        )


def smallest(law, per_hour, full_scale):
    """The smallest threshold that promises at most ``per_hour`` alarms; ValueError if there is none."""
    shortest = 1 / EXTRAPOLATED
    if per_hour * law.seconds / 3600 < shortest:
        need = 3600 * shortest / per_hour
        raise ValueError(
            f"{law.seconds:.3g} s of hold are too short to promise {per_hour:g} false alarms an hour: "
            f"{need:.3g} s or more are needed, or a higher --per-hour"
        )
    low, high = int(law.values[0]) - 1, int(law.values[-1]) + 1
    while not law.excluded(high, per_hour):
        low, high = high, 2 * high
        if low > full_scale:
            raise ValueError(
                f"no threshold up to {full_scale} codes promises {per_hour:g} false alarms an hour: the tail "
                "of "
                f"the noise is too long, or {law.seconds:.3g} s of hold too short"
            )
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if law.excluded(middle, per_hour) else (middle, high)
    return high


def windows_of(x, config):
    """p2p [channels, windows] of samples; ValueError if they fill no window."""
    count = (x.shape[1] - config.window) // config.hop + 1
    if count < 1:
        raise ValueError(f"{x.shape[1]} samples do not fill one window of {config.window}")
    return load("fixed").windows(x, config, count)[0]


def keep_of(p2p, threshold):
    """The smallest code that at most KEEP_SHARE of quiet windows exceed, and no more than the threshold."""
    return min(int(np.ceil(np.quantile(p2p, 1 - KEEP_SHARE, method="higher"))), threshold)


def amount(code, lsb, level, digits=3):
    """The shortest decimal that becomes ``code``: of (code + 1/2) lsb, which is rounded down to it."""
    from meissner.builds.units import floor_root
    from meissner.tables import exact

    middle = (code + 0.5) * lsb / 2 ** (level / 2)
    for digits in range(2, 17):
        text = f"{middle:.{digits}g}"
        if floor_root(exact(float(text)) / exact(lsb), level) == code:
            return float(text)
    return middle


def command(arguments):
    """``meissner threshold``."""
    from meissner import process

    if not 0 < arguments.per_hour < float("inf"):
        raise ValueError(f"per-hour = {arguments.per_hour:g} must be a number above 0")
    picture = check_out(arguments.out)
    if picture.suffix.lower() not in (".png", ".svg"):
        raise ValueError(f"{picture} must be a .png or a .svg file")
    build = None if arguments.config is None else process.build_of(arguments.config)
    config = process.settings(arguments, build, needed=False)
    x, rate_hz, said = process.samples(arguments, build=build)
    p2p, slips, lines = windows_of(x, config), None, [said]
    if arguments.slips is not None:
        y, slips_hz, told = process.samples(arguments, arguments.slips, build)
        if abs(slips_hz - rate_hz) > process.RATE_ERROR * rate_hz:
            raise ValueError(
                f"{arguments.input} has {rate_hz:g} Hz and {arguments.slips} {slips_hz:g} Hz: their windows "
                "are not alike"
            )
        slips = windows_of(y, config)
        lines.append(told)
    law = fit(p2p.max(axis=0), config.hop / rate_hz)
    full = (1 << 17 + config.level) - 1
    if build is not None and build.units.codes:
        full = (build.units.codes[1] - build.units.codes[0] << config.level) - 1
    threshold = smallest(law, arguments.per_hour, full)
    low, high = law.interval(threshold)
    keep = keep_of(p2p, threshold)
    gross, why = min(2 * threshold, full), "twice the threshold: no slips were given"
    if slips is not None:
        over = slips[slips > threshold]
        gross = int(np.median(over)) if len(over) else gross
        why = (
            "half of the slips' windows over the threshold exceed it" if len(over) else "twice the threshold"
        )
    lines += [
        f"quiet: {p2p.shape[1] * config.hop / rate_hz:.4g} s, {p2p.shape[1]} windows of {p2p.shape[0]} "
        "channel"
        f"{'s' * (len(p2p) > 1)}; p2p {np.median(p2p):g} codes in the median, {p2p.max()} at most",
        f"law: {law.blocks} blocks of {law.block_s:.3g} s, shape {law.best[2]:.2f}; alarms within a block "
        "count "
        "as one",
        f"threshold {threshold} codes: {law.rate(threshold):.2g} false alarms an hour, {100 * CONFIDENCE:g} "
        "% "
        f"interval {low:.2g} to {high:.2g} (profile likelihood); promised: at most {arguments.per_hour:g}",
    ]
    if slips is not None:
        lines.append(_of_slips(slips, threshold, config, rate_hz))
    alarms = f"false alarm{'s' * (arguments.per_hour != 1)}"
    names = {"threshold": (threshold, f"at most {arguments.per_hour:g} {alarms} an hour")}
    names["gross_threshold"] = gross, why
    names["keep_threshold"] = keep, f"{100 * np.mean(p2p > keep):.2g} % of the quiet windows exceed it"
    unit, lsb = _unit(arguments, build)
    lines += ["", *_toml(names, unit, lsb, config.level)]
    scale = f"{lsb / 2 ** (config.level / 2):.4g} {unit.upper()} a code" if unit else ""
    draw(picture, law, threshold, arguments.per_hour, slips, scale)
    print(*lines, f"# picture: {plain(arguments.out)}", sep="\n")


def _of_slips(slips, threshold, config, rate_hz):
    """What the threshold does with a recording of slips."""
    over = (slips > threshold).any(axis=0)
    if not over.any():
        return (
            f"slips: no window of {slips.shape[1]} is over the threshold, their largest p2p is {slips.max()}"
        )
    at = (int(np.argmax(over)) * config.hop + config.window - 1) / rate_hz
    return (
        f"slips: {int(over.sum())} of {slips.shape[1]} windows over the threshold, the first at {at:.4f} s; "
        "p2p "
        f"{np.median(slips[slips > threshold]):g} codes in their median, {slips.max()} at most"
    )


def _unit(arguments, build):
    """(v or n, how many of them a code of a sample is); "" if it is not known."""
    if build is not None:
        return ("n", build.units.newtons_per_code) if build.array else ("v", build.units.volts_per_code)
    return ("", None) if arguments.volts_per_code is None else ("v", arguments.volts_per_code)


def _toml(names, unit, lsb, level):
    """The lines of [slip] in a unit, or in codes as registers."""
    if not unit:
        words = [f"# slip.{name} = {code}   {why}" for name, (code, why) in names.items()]
        return ["# registers, in codes; --config or --volts-per-code gives the lines of [slip]", *words]
    return [
        "[slip]",
        *(
            f"{name}_p2p_{unit} = {amount(code, lsb, level):.15g}  # {code} codes: {why}"
            for name, (code, why) in names.items()
        ),
    ]


def draw(path, law, threshold, per_hour, slips=None, scale=""):
    """A picture: the alarms an hour of each threshold, counted, by the law, and its interval."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8, 5), layout="constrained")
    axes = figure.subplots()
    last = max(threshold + 2, int(1.15 * threshold))
    codes = np.arange(int(law.values[0]) - 1, last + 1)
    counted = [law.per_hour((law.counts[law.values > code].sum()) / law.blocks) for code in codes]
    some = np.unique(np.linspace(codes[0], codes[-1], 9).round().astype(int))
    ends = np.array([law.interval(code, 0.05) for code in some])
    floor = per_hour / 100
    axes.fill_between(some, np.maximum(ends[:, 0], floor), ends[:, 1], alpha=0.25, label="95 % interval")
    axes.semilogy(codes, [law.rate(code) or np.nan for code in codes], label="extreme-value law")
    seen = np.array(counted)
    axes.semilogy(codes[seen > 0], seen[seen > 0], "k.", label=f"counted in {law.blocks} blocks")
    axes.axvline(threshold, color="C3", label=f"threshold {threshold}")
    axes.axhline(per_hour, color="C3", ls=":", label=f"{per_hour:g} an hour")
    title = f"quiet hold of {law.seconds:.4g} s, p2p at most {law.values[-1]} codes"
    if slips is not None and (slips > threshold).any():
        middle = np.median(slips[slips > threshold])
        title += f"; of slips {middle:g} in the median"
        if middle <= last:
            axes.axvline(middle, color="C2", ls="--", label="median of slips")
    axes.set(ylabel="false alarms an hour", ylim=(floor, None), title=title)
    axes.set_xlabel(f"threshold in codes, peak to peak{f' ({scale})' if scale else ''}")
    axes.legend()
    with written(path) as file:
        figure.savefig(file, format=path.suffix[1:].lower())
