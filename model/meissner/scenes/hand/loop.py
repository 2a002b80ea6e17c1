"""The closed loop: hand, converters, slip path and reflex, cycle by cycle, for all runs together.

    closing -> physics.hand -> converter -> Haar, peak to peak, over -> grip -> increment -> closing

The word of a cycle moves the hand in the next one. A window counts once, where it is first over the
threshold: msn_grip counts the stream of decisions. A finger is unhealthy after eight consecutive samples at
0 V or below: 5 V is the rubber at rest. On engine rtl a Verilated core does all of it, beside the twins.
"""

from dataclasses import dataclass, replace

import numpy as np

from meissner.builds.input_range import Sensed, rails
from meissner.physics import rubber
from meissner.physics.hand import GRIP_N_MM, Hand
from meissner.scenes.hand.host import Host, quiet_v
from meissner.scenes.hand.scene import grasp
from meissner.twins.actuate.actuate import FingerHealth
from meissner.twins.actuate.grip import Grip
from meissner.twins.slip.haar import Haar
from meissner.twins.slip.peak_to_peak import PeakToPeak

NOISE_S = 1.0  # of the converters' noise drawn together
AFTER_S = 1.0  # after a tug, for tug_ratio
WAIT_SAMPLES = 20  # for which an event's ringing may still reach the next window


class FixedSlip:
    """The integer twins for all fingers of all runs."""

    def __init__(self, channels, config):
        self.span, self.threshold = config.window >> config.level, config.threshold
        self.haar, self.extremes = Haar(channels, config.level), PeakToPeak(channels, self.span, self.span)

    def next(self, codes):
        """(detail, p2p, over) for each detail that ``codes`` [channels, n] complete."""
        detail, _ = self.haar.next(codes)
        p2p, self.ends = self.extremes.next(detail)
        return detail, p2p, p2p > self.threshold


class FloatSlip:
    """Floating-point reference: PyWavelets' cD, and its extremes so far in each window."""

    def __init__(self, channels, config):
        self.level, self.threshold, self.count = config.level, config.threshold, 0
        self.span, self.group = config.window >> config.level, 1 << config.level
        self.rest = np.zeros((channels, 0))
        self.high, self.low = np.full(channels, -np.inf), np.full(channels, np.inf)

    def next(self, codes):
        """As FixedSlip.next, in codes, but in floating point."""
        import pywt

        x = np.concatenate([self.rest, codes], axis=1)
        whole = x.shape[1] // self.group * self.group
        self.rest = x[:, whole:]
        if not whole:
            return (np.zeros((len(x), 0)),) * 2 + (np.zeros((len(x), 0), dtype=bool),)
        level = self.level
        detail = pywt.wavedec(x[:, :whole], "haar", mode="periodization", level=level)[1] * 2 ** (level / 2)
        p2p, start = np.empty_like(detail), 0
        while start < detail.shape[1]:
            if self.count % self.span == 0:
                self.high[:], self.low[:] = -np.inf, np.inf
            stop = min(detail.shape[1], start + self.span - self.count % self.span)
            part = detail[:, start:stop]
            high = np.maximum(np.maximum.accumulate(part, axis=1), self.high[:, None])
            low = np.minimum(np.minimum.accumulate(part, axis=1), self.low[:, None])
            p2p[:, start:stop] = high - low
            self.high, self.low = high[:, -1], low[:, -1]
            self.count, start = self.count + stop - start, stop
        return detail, p2p, p2p > self.threshold + 0.5  # half a code: docs/slip.md


class Windows:
    """A block's decisions summarised by window, as the reflex needs them: [channels, parts].

    A part is the section of a window inside the block: whether it is over, and whether the window ends in it.
    """

    def __init__(self, channels, span):
        self.span, self.count, self.counted = span, 0, np.zeros(channels, dtype=bool)

    def next(self, over):
        """(over [channels, parts], ends [parts], number of windows newly over [channels])."""
        last = self.count + over.shape[1]
        if last == self.count:
            nothing = np.zeros((len(over), 0), dtype=bool)
            return nothing, [], nothing.sum(axis=1)
        starts = np.arange(self.count // self.span * self.span, last, self.span)
        starts[0] = self.count
        parts = np.logical_or.reduceat(over, starts - self.count, axis=1)
        ends = [bool(stop % self.span == 0) for stop in (*starts[1:], last)]
        self.count, fresh = last, np.zeros(len(over), dtype=np.int64)
        for part, end in zip(parts.T, ends):
            fresh += part & ~self.counted
            self.counted = (self.counted | part) & (not end)
        return parts, ends, fresh


class Reflexes:
    """Slip path and reflex for both fingers of all runs: they answer the codes of each cycle.

    ``parts``: (slip path class, grip class); ``starts``: the initial command of each run.
    """

    mismatches = None  # cycles of each run in which a core differed from the twins

    def __init__(self, parts, config, settings, starts, adc):
        slip_of, grip_of = parts
        channels = 2 * len(starts)
        self.slip, self.windows = slip_of(channels, config), Windows(channels, config.window >> config.level)
        self.health = FingerHealth(channels, *rails(adc, Sensed(), "pulled_up"))
        self.reflexes = [grip_of(settings, 2, start=start) for start in starts]
        self.gross_threshold = config.gross_threshold

    def compare_with(self, threshold):
        """Set the threshold [runs], in codes."""
        self.slip.threshold = np.repeat(threshold, 2)[:, None]

    def answer_by(self, steps, decays):
        """Set step and decay; both [runs], in counts."""
        for reflex, step, decay in zip(self.reflexes, steps.tolist(), decays.tolist()):
            if (step, decay) != (reflex.config.step, reflex.config.decay):
                reflex.config = replace(reflex.config, step=step, decay=decay)

    def hold_above(self, floors):
        """Set the least command; [runs], in counts."""
        for reflex, floor in zip(self.reflexes, floors.tolist()):
            if floor != reflex.config.minimum:
                reflex.config = replace(reflex.config, minimum=floor)

    def next(self, codes):
        """(detail [channels, details], number of windows newly over [channels], Command of each run)."""
        detail, p2p, self.over = self.slip.next(codes)
        self.gross = (p2p > self.gross_threshold).any(axis=1)
        parts, ends, counts = self.windows.next(self.over)
        healthy = self.health.next(codes).reshape(-1, 2).tolist()
        parts = parts.reshape(len(self.reflexes), 2, -1).tolist()
        words = [
            answer(reflex, rows, ends, well) for reflex, rows, well in zip(self.reflexes, parts, healthy)
        ]
        return detail, counts, words


class Cores:
    """As Reflexes, with a Verilated core for each run; the twins run beside them and supply the detail."""

    @staticmethod
    def core(*arguments):
        from meissner.engines import rtl_hand  # here: a loop on the twins needs no builder

        return rtl_hand.Core(*arguments)

    def __init__(self, config, settings, starts, adc, block):
        from meissner.twins.actuate.actuate import ActuateConfig

        self.twin = Reflexes((FixedSlip, Grip), config, settings, starts, adc)
        actuate = ActuateConfig(settings, *rails(adc, Sensed(), "pulled_up"))
        self.cores = [self.core(2, config, actuate, block, start) for start in starts]
        self.windows = Windows(2 * len(starts), config.window >> config.level)
        self.mismatches = np.zeros(len(starts), dtype=np.int64)

    def compare_with(self, threshold):
        """As Reflexes.compare_with."""
        self.twin.compare_with(threshold)
        for core, value in zip(self.cores, threshold):
            core["slip.threshold"] = value

    def answer_by(self, steps, decays):
        """As Reflexes.answer_by."""
        self.twin.answer_by(steps, decays)
        for core, step, decay in zip(self.cores, steps, decays):
            core["grip.step"], core["grip.decay"] = step, decay

    def hold_above(self, floors):
        """As Reflexes.hold_above."""
        self.twin.hold_above(floors)
        for core, floor in zip(self.cores, floors):
            core["grip.minimum"] = floor

    @property
    def gross(self):
        """As Reflexes.gross: what the host reads in the packets."""
        return self.twin.gross

    def next(self, codes):
        """As Reflexes.next."""
        detail, _, expected = self.twin.next(codes)
        found = [core.next(pair) for core, pair in zip(self.cores, codes.reshape(len(self.cores), 2, -1))]
        overs, words = [over for over, _, _ in found], [word for _, _, word in found]
        wanted = self.twin.over.reshape(len(self.cores), 2, -1)
        for run, (over, ends, word) in enumerate(found):
            same = np.array_equal(over, wanted[run]) and np.array_equal(ends, self.twin.slip.ends)
            self.mismatches[run] += word != expected[run] or not same
        _, _, counts = self.windows.next(np.concatenate(overs))
        return detail, counts, words


class Netlists(Cores):
    """As Cores, with the core's netlist."""

    @staticmethod
    def core(*arguments):
        from meissner.engines import rtl_hand, verilated

        return verilated.of_gates(rtl_hand.Core)(*arguments)


def answer(reflex, parts, ends, healthy):
    """The Command of a cycle; ``parts`` [fingers, parts], ``healthy`` [fingers]."""
    for finger, row in enumerate(parts):
        for over, end in zip(row, ends):
            reflex.decision(finger, over, end)
    return reflex.cycle(healthy)


@dataclass(frozen=True)
class Trace:
    """The charts' data of the shown run, [cycles]; ``detail_low``, ``detail_high`` [cycles, 2] in codes."""

    time_s: np.ndarray
    normal_n: np.ndarray
    least_n: np.ndarray
    load_n: np.ndarray
    sag_mm: np.ndarray
    slip_mm: np.ndarray
    ring_mm: np.ndarray
    command: np.ndarray
    fault: np.ndarray
    over: np.ndarray
    threshold_v: np.ndarray
    detail_low: np.ndarray
    detail_high: np.ndarray


@dataclass(frozen=True)
class Held:
    """The results of each run: arrays [runs]; ``trace``: of the first.

    ``slip_mm``: at the end; ``sag_mm``, ``ring_mm``: largest less least; ``moved_mm``: largest less least
    displacement of the object; ``tightenings``: cycles with a window over the threshold;
    ``false_tightenings``: those in which a finger without an event was over; ``faults``: cycles with a
    fault; ``ratio``: grip over the least that friction allows, mean of the hold; ``tug_ratio``: grip in the
    second after each tug over the least that the tug's peak needed (nan without tugs); ``mismatches``:
    cycles in which the core of engine rtl or gate differed from the twins, None for other engines.
    """

    dropped: np.ndarray
    slip_mm: np.ndarray
    sag_mm: np.ndarray
    ring_mm: np.ndarray
    moved_mm: np.ndarray
    tightenings: np.ndarray
    false_tightenings: np.ndarray
    faults: np.ndarray
    ratio: np.ndarray
    tug_ratio: np.ndarray
    trace: Trace
    mismatches: np.ndarray | None = None


class _Noise:
    """The converters' noise, drawn for each run from its own seed."""

    def __init__(self, scene, seeds, number):
        self.rngs = [np.random.default_rng([seed, number, 1]) for seed in seeds]
        self.scale, self.length = scene.adc.noise_v, round(NOISE_S * scene.rate_hz)
        self.drawn, self.place = None, self.length

    def next(self, samples):
        if self.place >= self.length:
            shape = (2, self.length)
            self.drawn = self.scale * np.stack([rng.standard_normal(shape) for rng in self.rngs])
            self.place = 0
        part = self.drawn[:, :, self.place : self.place + samples]
        self.place += samples
        return part


def hold(scene, condition, seeds, parts):
    """Run a condition with all ``seeds`` together; ``parts``: (slip path class, grip class), or Cores."""
    grasps = [grasp(scene, condition, seed) for seed in seeds]
    runs, block = len(grasps), scene.rate_hz * condition.cycle_ms // 1000
    hand = Hand(grasps, scene.rate_hz, block)
    config, number = scene.slip_config(condition), scene.conditions.index(condition)
    settings = scene.grip_config(condition)
    starts = [scene.start(condition, one.closing_mm) for one in grasps]
    given = config, settings, starts, scene.adc
    reflexes = Reflexes(parts, *given) if isinstance(parts, tuple) else parts(*given, block)
    goal = np.array([one.closing_mm for one in grasps])
    noise, adc, front = _Noise(scene, seeds, number), scene.adc, scene.front()
    quiet = quiet_v(scene, condition, seeds)
    host = Host(scene, condition, reflexes, rubber.rest_volts(GRIP_N_MM * goal), quiet)
    cycles = round(scene.duration_s(condition) * 1000 / condition.cycle_ms)
    dead = np.inf if condition.dead_s is None else condition.dead_s
    since = scene.world["hold_from_s"]
    wait = config.window + WAIT_SAMPLES
    last_event = np.full(2 * runs, -(10**9))
    tight, false, faults = np.zeros((3, runs), dtype=np.int64)
    ratio, held, tug_ratio, tugged = np.zeros(runs), 0, np.zeros(runs), 0
    lowest, highest = (np.full((3, runs), np.inf), np.full((3, runs), -np.inf))  # of displacement, sag, rings
    rows = []
    for cycle in range(cycles):
        time_s = cycle * condition.cycle_ms / 1e3
        found = hand.next(goal)
        volts = front.next(found.volts) + noise.next(block)
        codes, _ = adc.convert(volts.reshape(2 * runs, block))
        if time_s >= dead:
            codes[:] = 0
        host.write(cycle)
        detail, counts, words = reflexes.next(codes)
        increment = np.array([word.increment for word in words])
        command = np.array([word.command for word in words])
        gross = reflexes.gross.reshape(runs, 2).any(axis=1)
        host.read(codes.reshape(runs, -1).mean(axis=1) * adc.lsb_v + adc.low_v, command, gross)
        contact, at, _ = found.events
        last_event[contact] = cycle * block + np.ceil(at).astype(np.int64)
        wrong = (counts > 0) & (last_event < cycle * block - wait)
        pairs = counts.reshape(-1, 2)
        goal = goal + increment * condition.count_mm
        alive = ~hand.dropped
        tight += alive & (pairs > 0).any(axis=1)
        false += alive & wrong.reshape(-1, 2).any(axis=1)
        faults += np.array([word.fault != 0 for word in words])
        least_n = found.load_n.mean(axis=1) / hand.mu_s.sum(axis=1)
        normal_n = found.normal_n.mean(axis=1)
        sag_mm = found.sag_mm[:, -1]
        places = np.array([sag_mm + found.slip_mm[:, -1] + found.ring_mm, sag_mm, found.ring_mm])
        lowest, highest = np.minimum(lowest, places), np.maximum(highest, places)
        for start_s, length_s, newtons in scene.world["tugs"]:
            if 0 <= time_s - start_s - length_s < AFTER_S:
                tug_ratio = tug_ratio + normal_n / (least_n + newtons / hand.mu_s.sum(axis=1))
                tugged += 1
        if time_s >= since:
            ratio, held = ratio + normal_n / least_n, held + 1
        rows.append(
            (
                *(time_s, normal_n[0], least_n[0], found.load_n[0, -1], found.sag_mm[0, -1]),
                *(found.slip_mm[0, -1], found.ring_mm[0], words[0].command, words[0].fault),
                *(int(pairs[0].sum()), host.threshold[0], *detail[:2].min(axis=1), *detail[:2].max(axis=1)),
            )
        )
    table = np.array(rows).T
    table[10] *= adc.lsb_v / 2 ** (1 + config.level / 2)
    trace = Trace(*table[:11], table[11:13].T, table[13:15].T)
    moved_mm, sag_mm, ring_mm = highest - lowest
    tug_ratio = tug_ratio / tugged if tugged else np.full(runs, np.nan)
    return Held(
        *(hand.dropped, hand.slid_mm.mean(axis=1), sag_mm, ring_mm, moved_mm),
        *(tight, false, faults, ratio / max(held, 1), tug_ratio, trace, reflexes.mismatches),
    )
