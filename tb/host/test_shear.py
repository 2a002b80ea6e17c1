"""meissner.host.shear on a simulated core: a rubber's constants are written by its registers, words and
levels are read back."""

import pytest

from meissner import host
from meissner.host import line, shear
from meissner.host.simulated import SimulatedCore


def connected(**status):
    pipe = SimulatedCore([], features=["adc", "slip", "shear_speed"], size=(1, 2), clk_khz=1000)
    for name, value in status.items():
        pipe.status["shear_speed", *name.split("__")] = value
    return pipe, host.Core(line.Pipe(pipe))


def test_words():
    """1.5 mm/s is 1572864 in units of 2^-20 mm/s."""
    assert shear.of_word(1_572_864) == shear.Speed(1.5, ())
    assert shear.of_word(0x6100_0000) == shear.Speed(None, ("unsettled", "rising", "fast"))
    assert shear.of_word(0x9E00_0000).flags == ("range", "small", "denominator", "clipped", "saturated")


def test_speeds_cover_the_existing_channels():
    _, core = connected(channel0__speed=262_144, channel1__flags=4)
    assert core.features == ["adc", "slip", "shear_speed"]
    assert shear.speeds(core) == [shear.Speed(0.25, ()), shear.Speed(None, ("small",))]


def test_levels_are_of_one_window():
    """A level is 512 times a code; 819.2 codes per volt: 838861 is 2.0 V. A rise below 0 keeps its sign."""
    pipe, core = connected(vi__value=838_861, rise__value=(1 << 27) - 41_943, windows__value=7)
    found = shear.levels(core, 1, 4096 / 5)
    assert (round(found.vi_v, 5), round(found.rise_v, 5), found.windows) == (2.0, -0.1, 7)
    assert core["shear_speed.select"] == 1
    count = iter(range(100))
    real = pipe.registers.access

    def busy(*arguments, **named):
        pipe.status["shear_speed", "windows", "value"] = next(count)
        return real(*arguments, **named)

    pipe.registers.access = busy
    with pytest.raises(OSError, match="window"):
        shear.levels(core, 0, 4096 / 5)


def test_a_lot_is_written_while_it_rests():
    _, core = connected()
    shear.write_lot(core.__setitem__, shear.Rubber(k0_v=1.6, k1=-0.25, n=0.125), 4096 / 5)
    expected = {"enable": 1, "k0": 671_089, "k1": -16_384, "exponent": 16_384}  # 1.6 · 419430.4 = 671088.64
    assert {name: core[f"shear_speed.{name}"] for name in expected} == expected
    assert core["shear_speed.noise"] == 41_943
    with pytest.raises(ValueError, match="k1 = "):
        shear.write_lot(core.__setitem__, shear.Rubber(k1=3.0), 4096 / 5)
