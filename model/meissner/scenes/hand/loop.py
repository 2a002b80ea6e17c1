"""The closed loop: hand, converters, slip path and reflex, cycle by cycle, for all runs together.

    closing -> physics.hand -> converter -> Haar, peak to peak, over -> grip -> increment -> closing

The word of a cycle moves the hand in the next one. A window counts once, where it is first over the
threshold: msn_grip counts the stream of decisions. A finger is unhealthy after eight consecutive samples at
0 V or below: 5 V is the rubber at rest. On engine rtl a Verilated core does all of it, beside the twins.
"""

from copy import copy, deepcopy
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
AHEAD = 64  # cycles
WAIT_SAMPLES = 20  # for which an event's ringing may still reach the next window


class FixedSlip:
    """The integer twins for all fingers of all runs."""

    def __init__(self, channels, config):
        self.span, self.threshold = config.window >> config.level, config.threshold
        self.haar, self.extremes = Haar(channels, config.level), PeakToPeak(channels, self.span, self.span)

    def next(self, codes):
        """(detail, p2p, over) for each detail that ``codes`` [channels, n] complete."""
        detail, _ = self.haar.next(codes)
        self.before = copy(self.extremes)
        p2p, self.ends = self.extremes.next(detail)
        return detail, p2p, p2p > self.threshold

    def keep(self, detail):
        """Go on after these of the details of the last ``next``."""
        self.extremes = self.before
        self.extremes.next(detail)


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

    def skip(self, details):
        """Whether a window ends in so many details, none of them over and none in a window that was."""
        before, self.count = self.count, self.count + details
        return before // self.span < self.count // self.span

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
        self.group = 1 << config.level if isinstance(self.slip, FixedSlip) else None
        self.skips = grip_of is Grip  # of which the answers to quiet cycles are known

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

    def expected(self, cycles, block):
        """The increments [cycles, runs] if no further window of samples is over the threshold: those of the
        present windows are 0 where these were over, then the grip decays. A single cycle where the slip path
        cannot go back, or a group of samples spans two cycles.
        """
        if self.group is None or block % self.group:
            cycles = 1
        counted = self.windows.counted.reshape(-1, 2).any(axis=1).tolist()
        left = -(-(-self.windows.count % self.windows.span) * (self.group or 1) // block)
        rows = []
        for reflex, held in zip(self.reflexes, counted):
            row = [0] * min(cycles, held * left)
            rows.append(row + reflex.rest(cycles - len(row)))
        return np.array(rows).T

    def next(self, codes, expected, breaks=True):
        """The first cycles of ``codes`` [channels, samples]: until an increment is not that of ``expected``
        [cycles, runs], or a slip is gross, since the samples after it are then not what the hand gives; or
        all, if it ``breaks`` not.

        (detail [channels, details], number of windows newly over [cycles, channels], increment, command,
        fault and faulty fingers, one bit each [4, cycles, runs], gross [runs]).
        """
        cycles, channels = len(expected), len(codes)
        detail, p2p, self.over = self.slip.next(codes)
        gross = p2p > self.gross_threshold
        block, step = codes.shape[1] // cycles, detail.shape[1] // cycles
        unusual = (self.over | gross).any(axis=0).reshape(cycles, step).any(axis=1)
        low, high = self.health.low, self.health.high
        well = codes.min() > low and codes.max() < high and not self.health.run.any()
        counts, answers, cycle = np.zeros((cycles, channels), dtype=np.int64), [], 0
        while cycle < cycles:
            if self.skips and step and well and not unusual[cycle] and not self.windows.counted.any():
                quiet = int(unusual[cycle:].argmax()) or cycles - cycle
                ended = self.windows.skip(quiet * step)
                part = expected[cycle : cycle + quiet]
                answers += zip(*(one.take(row, ended) for one, row in zip(self.reflexes, part.T.tolist())))
                cycle += quiet
                continue
            here, samples = (slice(cycle * n, (cycle + 1) * n) for n in (step, block))
            parts, ends, counts[cycle] = self.windows.next(self.over[:, here])
            parts = parts.reshape(len(self.reflexes), 2, -1).tolist()
            healthy = self.health.next(codes[:, samples]).reshape(-1, 2).tolist()
            words = [answer(*one) for one in zip(self.reflexes, parts, [ends] * len(parts), healthy)]
            answers.append([(word.increment, word.command, word.fault, bits(word.faulty)) for word in words])
            cycle += 1
            differs = [word.increment for word in words] != expected[cycle - 1].tolist()
            if breaks and (differs or gross[:, here].any()):
                break
        if cycle < cycles:
            detail = detail[:, : cycle * step]
            self.slip.keep(detail)
        gross = gross[:, : cycle * step].reshape(len(self.reflexes), -1).any(axis=1)
        return detail, counts[:cycle], np.array(answers).transpose(2, 0, 1), gross


class Cores(Reflexes):
    """As Reflexes, with a Verilated core for each run, whose answers count; the twins run beside them."""

    @staticmethod
    def core(*arguments):
        from meissner.engines import rtl_hand  # here: a loop on the twins needs no builder

        return rtl_hand.Core(*arguments)

    def __init__(self, config, settings, starts, adc, block):
        from meissner.twins.actuate.actuate import ActuateConfig

        super().__init__((FixedSlip, Grip), config, settings, starts, adc)
        actuate = ActuateConfig(settings, *rails(adc, Sensed(), "pulled_up"))
        self.cores = [self.core(2, config, actuate, block, start) for start in starts]
        self.own = Windows(2 * len(starts), config.window >> config.level)
        self.block, self.mismatches = block, np.zeros(len(starts), dtype=np.int64)

    def compare_with(self, threshold):
        """As Reflexes.compare_with."""
        super().compare_with(threshold)
        for core, value in zip(self.cores, threshold):
            core["slip.threshold"] = value

    def answer_by(self, steps, decays):
        """As Reflexes.answer_by."""
        super().answer_by(steps, decays)
        for core, step, decay in zip(self.cores, steps, decays):
            core["grip.step"], core["grip.decay"] = step, decay

    def hold_above(self, floors):
        """As Reflexes.hold_above."""
        super().hold_above(floors)
        for core, floor in zip(self.cores, floors):
            core["grip.minimum"] = floor

    def expected(self, cycles, block):
        """As Reflexes.expected; several cores go cycle by cycle, since none can go back."""
        return super().expected(cycles if len(self.cores) == 1 else 1, block)

    def next(self, codes, expected, breaks=True):
        """As Reflexes.next, but the answers of the cores, which end with the same cycle."""
        _, p2p, _ = deepcopy(self.slip).next(codes)  # which then goes on from here
        gross = (p2p > self.gross_threshold).any(axis=0).reshape(len(expected), -1).any(axis=1)
        if gross.any():
            expected = expected[: gross.argmax() + 1]
            codes = codes[:, : len(expected) * self.block]
        pairs = codes.reshape(len(self.cores), 2, -1)
        found = [core.next(*one) for core, *one in zip(self.cores, pairs, expected.T)]
        cycles = found[0][2].shape[1]
        codes, expected = codes[:, : cycles * self.block], expected[:cycles]
        detail, counts, wanted, gross = super().next(codes, expected, breaks=False)
        over, ends = np.concatenate([over for over, _, _ in found]), [ends for _, ends, _ in found]
        answers = np.stack([answers for _, _, answers in found], axis=2)
        shape = len(self.cores), 2, cycles, -1
        same = (answers[0] == answers[1]) & (answers[1:] == wanted).all(axis=0)
        same &= (over.reshape(shape) == self.over.reshape(shape)).all(axis=(1, 3)).T
        same &= (np.array(ends) == self.slip.ends).reshape(len(ends), cycles, -1).all(axis=2).T
        self.mismatches += (~same).sum(axis=0)
        step = over.shape[1] // cycles
        for cycle in range(cycles):
            here = over[:, cycle * step : (cycle + 1) * step]
            if here.any() or self.own.counted.any():
                _, _, counts[cycle] = self.own.next(here)
            else:
                self.own.skip(step)
        return detail, counts, answers[1:], gross


class Netlists(Cores):
    """As Cores, with the core's netlist."""

    @staticmethod
    def core(*arguments):
        from meissner.engines import rtl_hand, verilated

        return verilated.of_gates(rtl_hand.Core)(*arguments)


def bits(flags):
    """Flags as bits, the first as bit 0."""
    return sum(bool(flag) << place for place, flag in enumerate(flags))


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

    def ahead(self, samples):
        """The next samples [runs, 2, samples], of which ``keep`` then takes some; within NOISE_S."""
        if self.place >= self.length:
            shape = (2, self.length)
            self.drawn = self.scale * np.stack([rng.standard_normal(shape) for rng in self.rngs])
            self.place = 0
        return self.drawn[:, :, self.place : self.place + samples]

    def keep(self, samples):
        self.place += samples


def _added(total, parts):
    """``total`` [runs] and each of ``parts`` [runs, n], added one after the other."""
    return np.add.accumulate(np.concatenate([total[:, None], parts], axis=1), axis=1)[:, -1]


def hold(*arguments, **more):
    """The Held of ``steps``."""
    going = steps(*arguments, **more)
    while True:
        try:
            next(going)
        except StopIteration as end:
            return end.value


def steps(scene, condition, seeds, parts, most=AHEAD):
    """Run a condition with all ``seeds`` together; ``parts``: (slip path class, grip class), or Cores.

    Yields (codes [2, samples], command, fault, faulty [cycles], all of the first run, the reflexes) of some
    cycles at a time; returns the Held.
    Up to ``most`` cycles are computed at a time, with the increments that follow if no window is over; those
    after another increment are dropped. So the results do not depend on ``most``.
    """
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
    rows, cycle, tried, usual = [], 0, 1, 1.0
    while cycle < cycles:
        host.write(cycle)
        tried = min(tried, most, cycles - cycle, host.free(cycle))
        expected = reflexes.expected(tried, block)
        goals = np.add.accumulate(np.concatenate([goal[None], expected[:-1] * condition.count_mm]), axis=0)
        found = hand.ahead(goals)
        expected = expected[: found.blocks]
        samples = len(expected) * block
        times_s = (cycle + np.arange(len(expected))) * condition.cycle_ms / 1e3
        before, volts = copy(front), found.volts[:, :, :samples]
        codes, _ = adc.convert((front.next(volts) + noise.ahead(samples)).reshape(2 * runs, -1))
        codes[:, np.repeat(times_s >= dead, block)] = 0
        detail, counts, (increments, commands, fault, faulty), gross = reflexes.next(codes, expected)
        done = len(counts)
        hand.keep(done)
        noise.keep(done * block)
        if done < len(expected):
            front = before
            front.next(volts[:, :, : done * block])
        last = codes[:, (done - 1) * block : done * block]
        host.read(last.reshape(runs, -1).mean(axis=1) * adc.lsb_v + adc.low_v, commands[-1], gross)
        goal = goals[done - 1] + increments[-1] * condition.count_mm
        times_s = times_s[:done]

        contact, block_of, at, _ = found.events
        order = np.argsort(block_of, kind="stable")
        contact, block_of = contact[order], block_of[order]
        instants = (cycle + block_of) * block + np.ceil(at[order]).astype(np.int64)
        alive = ~hand.dropped
        for k in np.flatnonzero(counts.any(axis=1)):
            known = block_of <= k
            last_event[contact[known]] = instants[known]
            pairs = (counts[k] > 0).reshape(-1, 2)
            wrong = last_event < (cycle + k) * block - wait
            tight += alive & pairs.any(axis=1)
            false += alive & (pairs & wrong.reshape(-1, 2)).any(axis=1)
        known = block_of < done
        last_event[contact[known]] = instants[known]
        faults += (fault != 0).sum(axis=0)

        load_n, normal_n, sag_mm, slip_mm = (
            values[:, : done * block].reshape(runs, done, block)
            for values in (found.load_n, found.normal_n, found.sag_mm, found.slip_mm)
        )
        least_n = load_n.sum(axis=2) / block / hand.mu_s.sum(axis=1)[:, None]
        normal_n = normal_n.sum(axis=2) / block
        load_n, sag_mm, slip_mm = load_n[:, :, -1], sag_mm[:, :, -1], slip_mm[:, :, -1]
        ring_mm = found.ring_mm[:, :done]
        places = np.array([sag_mm + slip_mm + ring_mm, sag_mm, ring_mm])
        lowest, highest = np.minimum(lowest, places.min(axis=2)), np.maximum(highest, places.max(axis=2))
        for k, time_s in enumerate(times_s if scene.world["tugs"] else ()):
            for start_s, length_s, newtons in scene.world["tugs"]:
                if 0 <= time_s - start_s - length_s < AFTER_S:
                    peak_n = least_n[:, k] + newtons / hand.mu_s.sum(axis=1)
                    tug_ratio = tug_ratio + normal_n[:, k] / peak_n
                    tugged += 1
        holding = times_s >= since
        ratio, held = _added(ratio, (normal_n / least_n)[:, holding]), held + int(holding.sum())
        shown = detail[:2].reshape(2, done, -1)
        rows.append(
            [
                *(times_s, normal_n[0], least_n[0], load_n[0], sag_mm[0], slip_mm[0], ring_mm[0]),
                *(commands[:, 0], fault[:, 0], counts[:, :2].sum(axis=1)),
                *(np.full(done, host.threshold[0]), *shown.min(axis=2), *shown.max(axis=2)),
            ]
        )
        cycle += done
        usual = 0.9 * usual + 0.1 * done
        tried = round(1.5 * usual) + 1
        yield codes[:2, : done * block], commands[:, 0], fault[:, 0], faulty[:, 0], reflexes
    table = np.concatenate(rows, axis=1)
    table[10] *= adc.lsb_v / 2 ** (1 + config.level / 2)
    trace = Trace(*table[:11], table[11:13].T, table[13:15].T)
    moved_mm, sag_mm, ring_mm = highest - lowest
    tug_ratio = tug_ratio / tugged if tugged else np.full(runs, np.nan)
    return Held(
        *(hand.dropped, hand.slid_mm.mean(axis=1), sag_mm, ring_mm, moved_mm),
        *(tight, false, faults, ratio / max(held, 1), tug_ratio, trace, reflexes.mismatches),
    )
