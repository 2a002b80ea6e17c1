"""The units of a core's ticks, codes and taxels, which the core itself does not know.

A detail of level l is sqrt(2)^l times the Haar coefficient (meissner.twins.slip.haar); a level's sum is
that of 2^l samples:

    code of a peak-to-peak = floor(volts·sqrt(2)^l / volts_per_code)       compared with >, so exact
    code of a level        = round(2^l·(min_code + (volts - low_v)/volts_per_code))
    code of a minimum load = ceil(newtons / newtons_per_code)             compared with >=, so exact
    clocks of a settling   = ceil(seconds·clk_hz), at least 1

Exact: a number means exactly its written decimal, 0.57 is 57/100. In floating point 0.57/0.001 is below 570.
"""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, isqrt
from typing import Any

import numpy as np

from meissner.tables import exact, naming

FRACTION_BITS = 14  # of x and y in a CoP packet
_METHODS = (  # quantity, method of Units that converts an amount to a code, registers
    ("volts", "detail_code", "slip.threshold slip.gross_threshold slip.keep_threshold"),
    ("newtons", "detail_code_of_newtons", "slip.threshold slip.gross_threshold slip.keep_threshold"),
    ("volts", "level_code", "slip.contact_level slip.release_level"),
    ("newtons", "level_code_of_newtons", "slip.contact_level slip.release_level"),
    ("seconds", "details", "slip.hold slip.refractory slip.blank"),
    ("newtons", "load_code", "cop.min_load cop4.min_load cop_slip.min_load"),
    ("seconds", "clocks", "adc.period scan.period grip.period"),
    ("seconds", "settle_clocks", "scan.settle"),
)
CODES = {(name, unit): method for unit, method, names in _METHODS for name in names.split()}


def floor_root(value: Fraction, level: int) -> int:
    """floor(value·sqrt(2)^level) in exact arithmetic."""
    square = value * value * (1 << level)
    return isqrt(square.__floor__()) if value >= 0 else -1 - isqrt(max(0, ceil(square) - 1))


@dataclass(frozen=True)
class Units:
    """None: not known. ``clk_khz``, ``rows`` and ``columns`` are read from the core when it is found.

    ``volts_per_code``, ``low_v``, ``min_code``, ``codes`` (least, most): of a sample; ``level``: of the slip
    path; ``rate_hz``: samples per second of each channel; ``volts_of``: newtons to the sensor's volts;
    ``newtons_per_code``: of a taxel and of a load; ``most_load``: its largest code; ``pitch_mm``: between
    taxels; ``min_load``: ``cop.min_load`` after reset.
    """

    clk_khz: int | None = None
    rows: int | None = None
    columns: int | None = None
    volts_per_code: float | None = None
    low_v: float = 0.0
    min_code: int = 0
    level: int = 1
    rate_hz: float | None = None
    volts_of: Callable[[float], Any] | None = None
    newtons_per_code: float | None = None
    pitch_mm: float | None = None
    codes: tuple[int, int] | None = None
    most_load: int | None = None
    min_load: int | None = None
    check_settle: Callable[[int], None] | None = None  # ValueError for too few clocks

    def code(self, name: str, quantity: str, value: float) -> int:
        """The code of a register for an amount; ValueError for a quantity that the register does not take.

        Parameters
        ----------
        name : str
            "group.register", such as "slip.threshold".
        quantity : str
            "volts", "newtons" or "seconds".
        value : float
            The amount; of a threshold, the peak to peak of the normalised Haar coefficient.

        Returns
        -------
        int
            Thresholds rounded down, least loads and settling times up, the rest to the nearest.
        """
        if (name, quantity) not in CODES:
            takes = [other for register, other in CODES if register == name]
            raise ValueError(f"{name} is not set in {quantity}, but in {' or '.join(takes) or 'codes only'}")
        if not np.isfinite(value):
            raise ValueError(f"{name} = {value} {quantity} must be a finite number")
        with naming(name):
            found: int = getattr(self, CODES[name, quantity])(value)
        if name in ("adc.period", "scan.period") and not found:
            raise ValueError(
                f"{name} = {value:g} {quantity} is less than one clock, and a register value of 0 selects "
                "another mode"
            )
        return found

    def _need(self, name: str, what: str) -> Any:
        value = getattr(self, name)
        if value is None:
            raise ValueError(f"{what} cannot be set: {name} is not known")
        return value

    def seconds(self, ticks: int) -> float | None:
        return ticks / (1000 * self.clk_khz) if self.clk_khz else None

    def detail_volts(self, code: int) -> float | None:
        """Volts of a Haar coefficient's peak-to-peak."""
        return None if self.volts_per_code is None else code * self.volts_per_code / 2 ** (self.level / 2)

    def _threshold(self, amount: float | Fraction, lsb: float, unit: str) -> int:
        """The code of a threshold; ValueError if no detail of the samples exceeds it."""
        found = floor_root(exact(amount) / exact(lsb), self.level)
        largest = (self.codes[1] - self.codes[0]) << self.level if self.codes else None
        if largest is not None and found >= largest:
            raise ValueError(
                f"{float(amount):g} {unit} are {found} codes and must be fewer than {largest}, the largest "
                "peak to peak of this build"
            )
        return found

    def _level(self, amount: float | Fraction, code: Fraction, lsb: Fraction, unit: str) -> int:
        """The code of a level, ``code`` of a sample; ValueError if no sum of the samples is there."""
        found = round((1 << self.level) * code)
        if self.codes and not self.codes[0] << self.level <= found <= self.codes[1] << self.level:
            least, most = (float(exact(amount) + (end - code) * lsb) for end in self.codes)
            raise ValueError(
                f"{float(amount):g} {unit} must lie in {least:g} .. {most:g}, the range of a sample"
            )
        return found

    def detail_code(self, volts: float | Fraction) -> int:
        return self._threshold(volts, self._need("volts_per_code", "a threshold in volts"), "V")

    def level_code(self, volts: float | Fraction) -> int:
        lsb = exact(self._need("volts_per_code", "a level in volts"))
        return self._level(volts, self.min_code + (exact(volts) - exact(self.low_v)) / lsb, lsb, "V")

    @property
    def of_forces(self) -> bool:
        """Whether the slip path's samples are forces of newtons_per_code, as after an array's calibration."""
        return self.volts_per_code is None and self.newtons_per_code is not None

    def detail_newtons(self, code: int) -> float | None:
        """Newtons of a Haar coefficient's peak-to-peak if samples are forces, else None."""
        if self.newtons_per_code is None or not self.of_forces:
            return None
        return code * self.newtons_per_code / 2 ** (self.level / 2)

    def detail_code_of_newtons(self, newtons: float | Fraction) -> int:
        if not self.of_forces:
            raise ValueError("a threshold in newtons cannot be set: the samples are not known to be forces")
        return self._threshold(newtons, self._need("newtons_per_code", "a threshold in newtons"), "N")

    def level_code_of_newtons(self, newtons: float | Fraction) -> int:
        if self.of_forces:
            lsb = exact(self._need("newtons_per_code", "a level in newtons"))
            return self._level(newtons, exact(newtons) / lsb, lsb, "N")
        return self.level_code(float(self._need("volts_of", "a level in newtons")(newtons)))

    def details(self, seconds: float | Fraction) -> int:
        return round(exact(seconds) * exact(self._need("rate_hz", "a time in seconds")) / (1 << self.level))

    def clocks(self, seconds: float | Fraction) -> int:
        return round(exact(seconds) * 1000 * self._need("clk_khz", "a time in seconds"))

    def settle_clocks(self, seconds: float | Fraction) -> int:
        """The fewest clocks, at least 1, that last at least ``seconds`` and pass ``check_settle``."""
        found = max(1, ceil(exact(seconds) * 1000 * self._need("clk_khz", "a time in seconds")))
        if self.check_settle is not None:
            self.check_settle(found)
        return found

    def load_code(self, newtons: float | Fraction) -> int:
        """Code of the smallest load of at least ``newtons``."""
        lsb = exact(self._need("newtons_per_code", "a load in newtons"))
        found = ceil(exact(newtons) / lsb)
        if self.most_load is not None and found > self.most_load:
            most = float(self.most_load * lsb)
            raise ValueError(
                f"{float(newtons):g} N must be at most {most:g} N, the largest load of this build"
            )
        return found

    def load_newtons(self, load: int) -> float | None:
        return None if self.newtons_per_code is None else load * self.newtons_per_code

    def place(self, x: int, y: int) -> tuple[float, float, float | None, float | None]:
        """Where a centre of pressure is.

        Parameters
        ----------
        x, y : int
            Of a CoP packet, 14 bits of fraction: -16384 .. 16384, y upwards.

        Returns
        -------
        tuple of float
            x and y in -1 .. 1, then in mm from the array's middle, or None, None if the pitch is not known.
        """
        across, up = x / (1 << FRACTION_BITS), y / (1 << FRACTION_BITS)
        if self.pitch_mm is None or self.rows is None or self.columns is None:
            return across, up, None, None
        half_mm = self.pitch_mm / 2
        return across, up, across * half_mm * (self.columns - 1), up * half_mm * (self.rows - 1)


def of_scene(scene: Any) -> Units:
    """Units of a slip scene (meissner.scenes.rubber.scene.Scene): its converter, rate, level and rubber."""
    from meissner.physics import rubber

    adc = scene.adc
    return Units(
        volts_per_code=adc.lsb_v,
        low_v=adc.low_v,
        min_code=adc.min_code,
        codes=(adc.min_code, adc.max_code),
        level=scene.slip.level,
        rate_hz=scene.rate_hz,
        volts_of=rubber.rest_volts,
    )
