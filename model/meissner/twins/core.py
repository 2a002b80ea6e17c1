"""Twin of rtl/msn_core.sv: the packets for complete frames of samples; for a hand also its commands."""

from dataclasses import dataclass, replace

import numpy as np

from meissner.twins.actuate.actuate import Actuate
from meissner.twins.forest.classify import Classify
from meissner.twins.frontend.health import Limits
from meissner.twins.link.link import payloads
from meissner.twins.link.packet import SLIP, class_change
from meissner.twins.sensor.sensors import from_reset, sensor_array, sensor_cop4
from meissner.twins.slip.haar import Haar
from meissner.twins.slip.peak_to_peak import PeakToPeak
from meissner.twins.slip.shear_speeds import ShearSpeeds, report
from meissner.twins.slip.slip_chain import changes_of, slip_chain

OF_LOAD = 65535  # channel of a slip event found in the load of four electrodes


@dataclass(frozen=True)
class Expected:
    """In order ``changes`` [(frame, type, payload)], ``cop`` [(frame, payload)]; ``images`` [frames, taxels].

    ``classes`` [(frame, payload)]: of the forest. ``slip``: of ``changes`` the starts of a slip, [(frame,
    payload)].
    """

    changes: list
    cop: list
    images: np.ndarray | None
    classes: tuple = ()

    @property
    def slip(self):
        return [(frame, payload) for frame, kind, payload in self.changes if kind == SLIP]


class Hand:
    """A core with the reflex, one control cycle per call; ``actuate``: ActuateConfig, ``slip``: SlipConfig.

    ``start``: as in meissner.twins.actuate.grip.Grip; ``shear``: ShearConfig, for a core with ShearSpeed. A
    window's speed is taken to arrive before the next frame: frames are 70 clocks apart or more. ``classify``:
    of a core with a forest; a decision for a class of slip marks the next detail of every finger as over.
    """

    def __init__(self, fingers, slip, actuate, start=None, shear=None, classify=None):
        self.classify, self.marked = classify, False
        group = 1 << slip.level
        self.group, self.left = group, 0  # frames of the unfinished detail
        self.shear = None if shear is None else ShearSpeeds(shear, fingers)
        self.shear_frames = 0
        self.threshold, self.haar = slip.threshold, Haar(fingers, slip.level)
        self.extremes = PeakToPeak(fingers, slip.window // group, slip.hop // group)
        self.actuate = Actuate(actuate, fingers, start)

    def next(self, samples, lost=False, override=None):
        """Command of the cycle that processed ``samples`` [frames, fingers].

        ``lost``: the converter lost a frame in it; ``override``: a host's command.
        """
        x = np.asarray(samples).T
        p2p, ends = self.extremes.next(self.haar.next(x)[0])
        speeds = self._speeds(x) if self.shear else ()
        over = p2p > self.threshold
        if self.classify:
            over = over | self._marks(x, len(ends))
        self.left = (self.left + x.shape[1]) % self.group
        word = self.actuate.next(x, over, ends, lost, override, speeds)
        if self.shear:
            self.shear.commanded(word.increment if word.valid else None)
        return word

    def _marks(self, x, details):
        """Whether a decision of the forest marks each of ``details``; one after the last waits."""
        marks = [self.marked] + [False] * details
        for frame, of in self.classify.next(x):
            if of.slips:
                marks[(frame + 1 + self.left) // self.group] = True
        self.marked = marks.pop()
        return np.array(marks, bool)

    def _speeds(self, x):
        """(index of the next detail, finger, speed) of each window that ends in ``x``."""
        found, length = [], 1 << self.shear.estimators[0].size.window_log2
        first = length - 1 - self.shear_frames % length  # the frame that ends the first window
        for finger, windows in enumerate(self.shear.next(x)):
            for n, (speed, flags) in enumerate(zip(windows.speed, windows.flags)):
                detail = (first + n * length + 1 + self.left) // self.group
                found.append((detail, finger, report(speed, flags)))
        self.shear_frames += x.shape[1]
        return sorted(found, key=lambda one: one[0])


def of_channels(samples, config, moving=None, mask=None, change=None):
    """Changes of samples [frames, channels]; other arguments as in meissner.twins.slip.slip_path."""
    return Expected(*payloads(slip_chain(samples, config, moving, mask, change)), None)


def of_array(array, samples, slip=None, over=None):
    """All results of samples [frames, rows, columns]; ``slip``: SlipConfig.

    ``array``: meissner.twins.sensor.sensors.Array; it keeps its learned state between calls, as the core
    does.
    """
    sensed = sensor_array(array, samples, over)
    events = slip_chain(sensed.forces, slip, mask=sensed.mask) if slip is not None else ()
    return Expected(*payloads(events, sensed.cop), sensed.forces)


def of_electrodes(samples, registers, terms=None, lag=16, slip=None):
    """CoP frames and changes of samples [frames, 4]; ``slip``: CopSlipRegisters."""
    cops, decisions = sensor_cop4(samples, registers, terms, lag, slip)
    state, raised, octant = np.array(decisions, dtype=int).reshape(-1, 1, 3).T
    changes = [(frame, OF_LOAD, *of) for frame, _, *of in changes_of(state, raised != 0, octant)]
    return Expected(*payloads(changes, cops), None)


def samples_of(config, codes):
    """Signed samples of a converter's codes and their over-range flags, both of the codes' shape."""
    mask = (1 << config.part.data_bits) - 1
    return config.converter.samples(np.asarray(codes) & mask)


def limits_of(config):
    """The Limits of a configuration with health, as after reset."""
    given = {k.removeprefix("health."): v for k, v in config.settings.items() if k.startswith("health.")}
    return Limits(over_range_enable=bool(given.pop("use.user")), edges=bool(given.pop("use.edges")), **given)


def array_of(config):
    """meissner.twins.sensor.sensors.Array of a configuration, as after reset."""
    limits, tare = limits_of(config) if config.health else None, None
    if config.tare:
        tare = {"contact": config.tare.contact_codes, "step": config.tare.step}
    parameters, settings = config.parameters, config.settings
    kinds = {"row_column": bool(parameters["RowColumn"]), "gain_shift": parameters["GainShift"]}
    kinds |= {"min_load": settings["cop.min_load"]}
    return from_reset(config.scan, settings["calibrate.preset"], limits, tare, **kinds)


def hand_of(config, start=None):
    """Hand of a configuration with [grip] and, optionally, [shear_speed]; its forest: ``hand.classify``."""
    features = config.features
    classify = classify_of(config) if "forest" in features and features["forest"].frames else None
    return Hand(config.channels, config.slip, features["grip"], start, features.get("shear_speed"), classify)


def classify_of(config):
    """twins.forest.classify.Classify of a configuration with [forest], before anything is loaded."""
    forest, settings = config.features["forest"], config.settings
    rows, columns = config.shape
    return Classify(
        rows * columns if forest.frames else None,
        **vars(forest.size),
        engines=forest.engines,
        banks=forest.banks,
        slip=settings["forest.slip"],
        grip=bool(settings["forest.grip"]),
        outside=forest.sdram,
    )


def of_forest(classify, frames):
    """[(frame, payload)] of the classes that packets tell, for frames [frames, channels]."""
    found = classify.next(np.asarray(frames).T)
    return [(frame, class_change(*decision.change)) for frame, decision in found if decision.change]


def gripping(config, classify=None):
    """A function of the forces [frames, taxels] of each control cycle, which returns the Command: of an array
    whose forest's decisions are the windows of one finger."""
    classify, actuate = classify or classify_of(config), Actuate(config.features["grip"], 1)

    def cycle(forces):
        slips = [of.slips for _, of in classify.next(np.asarray(forces).T) if of.slips is not None]
        return actuate.next(np.zeros((1, 0), int), [slips], [True] * len(slips))

    return cycle


def expected(config, codes, classify=None):
    """Payloads of a core of ``config`` for complete frames of codes after reset: as in engines.rtl_core.

    ``classify``: of a core with [forest], loaded.
    """
    found = _expected(config, codes)
    if classify is None:
        return found
    frames = samples_of(config, codes)[0] if found.images is None else found.images
    return replace(found, classes=of_forest(classify, frames))


def _expected(config, codes):
    samples, over = samples_of(config, codes)
    if config.kind == "array":
        return of_array(array_of(config), samples, config.slip, over)
    if config.kind == "electrodes":
        lag, slip = config.cop_slip or (16, None)
        return of_electrodes(samples, config.cop4.registers, config.cop4.terms, lag, slip)
    return of_channels(samples, config.slip)
