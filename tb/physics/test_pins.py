"""A pin on its bimorph, by hand: stiffness, mass, displacement, the skin's dip; pulses as a sum of sines; the
laser's samples and peaks; and the published numbers that the constants are fitted to."""

from itertools import pairwise

import numpy as np
import pytest

from meissner.physics import pins
from meissner.scenes.optacon import judge, published


def test_the_bimorph_by_hand():
    """I = 1.05 * 0.55^3 / 12 mm4 = 1.455781e-14 m4; k = 3 * 60e9 * I / 0.037^3; 33/140 of 166.6665 mg and the
    pin's mass; 3 * 274e-12 * (37 / 0.55)^2 m/V."""
    assert pins.stiffness() == pytest.approx(2.620406e-3 / 5.0653e-5, rel=1e-6)
    assert pins.mass() - pins.PIN_MG * 1e-6 == pytest.approx(33 / 140 * 1.666665e-4, rel=1e-6)
    assert pins.per_volt() == pytest.approx(3.720060, rel=1e-6)


def test_the_pin_at_rest_and_at_its_resonance():
    """At 0 Hz free x0, under a finger x0 k / (k + 1 / (1 / kc + 1 / kg)); where k = m w2, x0 / (2 D)."""
    k, skin = pins.stiffness(), pins.SKIN
    static = 1 / (1 / skin.kc + 1 / skin.kg)
    assert pins.transfer(0.0, False) == pytest.approx(pins.per_volt())
    assert pins.transfer(0.0, True) == pytest.approx(pins.per_volt() * k / (k + static))
    hz = np.sqrt(k / pins.mass()) / 2 / np.pi
    assert abs(pins.transfer(hz, False)) == pytest.approx(pins.per_volt() / 2 / pins.DAMPING)


def test_the_skin_takes_the_motion_up_where_its_tissue_swings(monkeypatch):
    """Without dampers the pin rests at sqrt((kc + kg) / M)."""
    monkeypatch.setattr(pins, "SKIN", pins.Skin(kc=1800.0, cc=0.0, kg=20.0, cg=0.0, grams=2.0))
    hz = np.sqrt(1820 / 2e-3) / 2 / np.pi
    assert abs(pins.transfer(hz, True)) < 1e-9 < abs(pins.transfer(hz * 1.01, True))


@pytest.mark.parametrize("hz, volts, finger, width", [(7.0, 30.0, False, 0.5), (230.0, 50.0, True, 0.25)])
def test_a_period_is_the_sum_of_its_harmonics(hz, volts, finger, width):
    """In a plain loop: the mean, and 2 sin(pi n width) / (pi n) of each harmonic, at its own transfer."""
    wave = pins.period(hz, volts, finger, width, points=256)
    at = np.arange(256) / 256
    rest = pins.transfer(0.0, finger, volts).real
    loop = np.full(256, volts * width * rest)
    for n in range(1, 128):
        line = 2 * volts * np.sin(np.pi * n * width) / (np.pi * n) * pins.transfer(n * hz, finger, volts)
        loop += line.real * np.cos(2 * np.pi * n * at) - line.imag * np.sin(2 * np.pi * n * at)
    assert wave == pytest.approx(np.maximum(loop - pins.PRELOAD_V * rest, 0) if finger else loop, abs=1e-9)


def test_pulses_in_time_move_the_pin_as_their_harmonics_do():
    """Half a period of 64 instants; slow pulses of no more than the preload do nothing under a finger."""
    volts = np.tile(np.repeat([30.0, 0.0], 32), 50)
    x = pins.moved(volts, 230.0 * 64, True)
    steady = np.ptp(pins.period(230.0, 30.0, True))
    assert np.ptp(x[-64:]) == pytest.approx(steady, rel=0.02)
    assert x.mean() == pytest.approx((15 - pins.PRELOAD_V) * pins.transfer(0.0, True).real)
    slow = pins.moved(np.repeat([4.4, 0.0], 20_000), 1000.0, True)
    assert slow[15_000:] == pytest.approx(0, abs=1e-6)


def test_a_slow_drive_moves_the_pin_by_what_is_above_the_preload():
    """1 Hz: settled, from 0 to G (V - 4.5 V); 10 V less than a quarter of 30 V."""
    for volts in (10.0, 30.0, 50.0):
        wave = pins.period(1.0, volts, True)
        rest = pins.transfer(0.0, True, volts).real
        assert np.median(wave[wave > wave.mean()]) == pytest.approx((volts - 4.5) * rest, rel=1e-3)
        assert wave.min() == 0


def test_the_laser_reads_a_sine_of_230_hz_low():
    """8.7 samples a period: a peak up to 1 - cos(0.3613) low, in the mean 1 - sin(0.3613) / 0.3613."""
    wave = 1000 * np.sin(2 * np.pi * np.arange(4096) / 4096)
    samples = pins.by_laser(wave, 230.0, np.random.default_rng(3))
    assert len(samples) == 434 and np.allclose(samples, pins.LASER_UM * np.rint(samples / pins.LASER_UM))
    single = [samples[k : k + 9].max() / 1000 for k in range(420)]
    assert 20 * np.log10(min(single)) == pytest.approx(-0.58, abs=0.04) == -judge.single_low_db(230.0)
    found = 20 * np.log10(pins.peaks(samples, 230.0) / 1000)
    assert len(found) == 49 and found.mean() == pytest.approx(-0.19, abs=0.04)


def test_the_drift_is_removed_and_the_resolution_stays(monkeypatch):
    monkeypatch.setattr(pins, "DRIFT_UM", 500.0)
    wave = np.sin(2 * np.pi * np.arange(4096) / 4096)
    found = pins.peaks(pins.by_laser(wave, 20.0, np.random.default_rng(3)), 20.0)
    assert found == pytest.approx(1.0, abs=0.12) and len(found) == 50


def read_um(wave, hz):
    """The mean reading of a steady drive's peak, without the laser's resolution."""
    rng = np.random.default_rng(1)
    scaled = wave * 1000
    return np.mean([pins.peaks(pins.by_laser(scaled, hz, rng), hz).mean() for _ in range(40)]) / 1000


def test_the_published_numbers_come_out():
    """Free 22.2 dB at 230 Hz; bursts 33 um out, 0.8 um on top; the dip at 150 Hz at each voltage, and no rise
    before."""
    hz = published.FREE_HZ
    free = read_um(pins.period(hz, published.FREE_V, False), hz)
    assert pins.in_db(free) == pytest.approx(published.FREE_DB, abs=0.1)
    wave = pins.period(hz, published.FREE_V, True)
    assert wave.mean() == pytest.approx(published.OUT_UM, rel=0.01)
    assert read_um(wave, hz) == pytest.approx(published.RIPPLE_UM, rel=0.04)
    for volts in published.VOLTS:
        waves = {hz: pins.period(hz, volts, True) for hz in published.FREQUENCIES}
        um = [np.ptp(wave) / 2 if hz < 100 else read_um(wave, hz) for hz, wave in waves.items()]
        lowest = published.FREQUENCIES.index(published.LOWEST_HZ)
        assert int(np.argmin(um)) == lowest
        assert all(a > b for a, b in pairwise(um[: lowest + 1])), "it falls up to the dip"


def test_under_a_finger_less_than_free_and_not_in_proportion():
    hz = np.array(published.FREQUENCIES, float)
    by = {(v, f): np.array([pins.peak_db(h, v, f) for h in hz]) for v in (10.0, 30.0) for f in (False, True)}
    less = by[30.0, False] - by[30.0, True]
    assert less.min() > 0 and less[hz >= 100].min() > less[hz <= 20].max() + 5
    assert by[30.0, False] - by[10.0, False] == pytest.approx(20 * np.log10(3))
    gained = by[30.0, True] - by[10.0, True] - 20 * np.log10(3)
    assert (
        (gained[hz <= 20] > 3).all() and (gained[hz >= 100] < -0.2).all() and (gained[hz >= 100] > -2).all()
    )
