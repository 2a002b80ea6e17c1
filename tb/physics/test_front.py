"""The converters' analogue front against SciPy's Butterworth filters, closed forms and plain integration:
what remains after a step, how long is enough, channels and scans through it; and what remains of a row in
each part, as literals."""

import numpy as np
import pytest
from scipy import integrate, signal

from meissner.builds.settling import Settling
from meissner.physics import front, rubber
from meissner.physics.front import LowPass
from meissner.twins.frontend.adc_spi import PARTS
from meissner.twins.frontend.scan_adc import ScanAdc

US = 1e-6


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("corner_hz", [15e3, 220e3])
def test_a_filter_is_scipys(order, corner_hz):
    one, made = LowPass(corner_hz, order), signal.butter(order, 2 * np.pi * corner_hz, analog=True)
    time_s, step = signal.step(made, T=np.linspace(0, 3 / corner_hz, 301))
    assert [one.left(t) for t in time_s] == pytest.approx(1 - step, abs=1e-6)
    hertz = np.array([0.0, corner_hz / 15, corner_hz, 40 * corner_hz])
    assert [one.gain(f) for f in hertz] == pytest.approx(abs(signal.freqs(*made, 2 * np.pi * hertz)[1]))
    # From any time on: the largest of a fine grid.
    later = np.maximum.accumulate(abs(1 - step)[::-1])[::-1]
    assert [one.most_left(t) for t in time_s[:-100]] == pytest.approx(later[:-100], abs=2e-5)
    for share in (0.9, 0.3, 0.043, 0.01, 2**-17):
        at_s = one.settled_s(share)
        assert one.most_left(at_s) <= share * (1 + 1e-9)
        assert np.exp(-2 * np.pi * corner_hz * at_s / order**0.5) * order**0.5 == pytest.approx(share)
    assert one.settled_s(1.0) == 0.0


# exp(-v)(cos v + sin v), v = sqrt(2) pi f t, by hand: 15 kHz after 5 us v = 0.33322, after 10.4 us 0.69309;
# 23 kHz 0.51094 and 1.06274; 220 kHz after 5 us 4.88720. ln(100 sqrt(2)) = 4.95174 gives 1 %.
@pytest.mark.parametrize(
    "part, volts, us, left",
    [
        ("AD7606", 5.0, 5.0, 0.9116),
        ("AD7606", 5.0, 10.4, 0.7041),
        ("AD7606", 10.0, 5.0, 0.8167),
        ("AD7606", 10.0, 10.4, 0.4700),
        ("AD7606", 10.0, 40.0, 0.0234),
        ("AD7606C-16", 10.0, 5.0, 0.0061),
        ("AD7606C-16", 2.5, 5.0, 0.0061),
    ],
)
def test_what_remains_of_a_row(part, volts, us, left):
    (path,) = front.paths(part, volts)
    assert path.left(us * US) == pytest.approx(left, abs=6e-5) and path.keep == 0


def test_how_long_is_enough():
    """ln(sqrt(2)/share) / (sqrt(2) pi f): 1 % and half a code of 16 bits, 2^-17."""
    needed = {
        (part, volts): [1e6 * front.paths(part, volts)[0].needed_s(share) for share in (0.01, 0.005, 2**-17)]
        for part, volts in (("AD7606", 5.0), ("AD7606", 10.0), ("AD7606C-16", 5.0))
    }
    assert needed["AD7606", 5.0] == pytest.approx([74.30, 84.70, 182.02], abs=0.01)
    assert needed["AD7606", 10.0] == pytest.approx([48.46, 55.24, 118.71], abs=0.01)
    assert needed["AD7606C-16", 5.0] == pytest.approx([5.066, 5.775, 12.41], abs=0.005)


def test_ranges_and_names():
    of = lambda volts: [path.pin.corner_hz for path in front.paths("ad7606", volts)]
    found = {volts: of(volts) for volts in (1.0, 5.0, 5.01, 10.0, 12.0, None)}
    assert found == {1.0: [15e3], 5.0: [15e3], 5.01: [23e3], 10.0: [23e3], 12.0: [23e3], None: [15e3, 23e3]}
    assert [path.about for path in front.paths("AD7606")] == ["±5 V, 15 kHz", "±10 V, 23 kHz"]
    assert len(front.paths("AD7606C-16")) == 1  # all its ranges have one corner
    for part in PARTS.values():
        assert front.front(part.name)


def test_a_capacitor_keeps_its_last_input():
    """MCP3208, 20 pF behind 1 kohm: half a period of 250 ns, three of which at 9 kohm more are 750 ns of 200
    ns: exp(-3.75) remain, in any settle time. The pin follows with 50 pF: 9 kohm are 450 ns."""
    (path,) = front.paths("MCP3208", 5.0, 250e-9, 9e3)
    assert path.keep == pytest.approx(np.exp(-3.75)) and path.left(1.0) == pytest.approx(0.023518, abs=1e-6)
    assert path.left(900e-9) == pytest.approx(np.exp(-3.75) + np.exp(-2))
    assert path.needed_s(np.exp(-3.75) + np.exp(-2)) == pytest.approx(900e-9)
    assert path.needed_s(0.0235) == np.inf
    (path,) = front.paths("MAX11125", 3.3, 40e-9, 200.0)  # 120 ns of 500 ohm and 15 pF
    assert path.keep == pytest.approx(np.exp(-16))


def test_the_wait_of_a_scan():
    """Half a code of 16 bits at 100 MHz; from the least share that 500 clocks leave on, they are enough."""
    scan = ScanAdc(16, 16, 1, adc_lanes=2, clk_khz=100_000)
    assert Settling(scan).clocks(None) == Settling(scan, 5.0).clocks(None) == 18_202
    assert Settling(scan, 10.0).clocks(None) == 11_871 and Settling(scan, 10.0, 0.01).clocks(None) == 4846
    assert Settling(scan, 10.0).clocks(3.301) == 331
    left = Settling(scan, 5.0).left(500)[0]
    Settling(scan, 5.0, left).check(500)
    for short, clocks in ((Settling(scan, 5.0, left * (1 - 1e-9)), 500), (Settling(scan, 5.0, left), 499)):
        with pytest.raises(ValueError, match=r"91\.2 % .±5 V, 15 kHz. of the old row remain at the AD7606"):
            short.check(clocks)
    fast = ScanAdc(4, 8, 1, PARTS[1], clk_khz=12_000, sclk_khz=2000)
    assert Settling(fast).clocks(None) == 12  # 1 us: the converter needs 45 ns
    # 2.5 kohm: 750 ns of 70 ns keep 2.2e-5, and 125 ns · -ln(1/8192 - 2.2e-5) are 1.1514 us, 13.8 clocks.
    assert Settling(fast, source_ohm=2.5e3).clocks(None) == 14
    with pytest.raises(ValueError, match="source_ohm = 4000 is too large"):
        Settling(fast, source_ohm=4e3).clocks(None)
    for bad in ({"share": 0.0}, {"share": 1.01}, {"source_ohm": -1.0}, {"share": float("nan")}):
        with pytest.raises(ValueError, match="must"):
            Settling(scan, **bad)


def integrated(corner_hz, knots_s, levels, at_s, first):
    """The filter's output at ``at_s``, by SciPy's solver: levels (or functions of time) from each knot on."""
    rate, state, now, out = 2 * np.pi * corner_hz, [first, 0.0], knots_s[0], []
    for stop in np.unique(np.concatenate([knots_s[1:], at_s])):
        level = levels[np.searchsorted(knots_s, now, "right") - 1]
        u = level if callable(level) else lambda t, level=level: level
        slope = lambda t, y, u=u: [y[1], rate**2 * (u(t) - y[0]) - 2**0.5 * rate * y[1]]
        state = integrate.solve_ivp(slope, (now, stop), state, rtol=1e-10, atol=1e-12).y[:, -1]
        now = stop
        out += [state[0]] if stop in at_s else []
    return np.array(out)


@pytest.mark.parametrize("low_pass", [LowPass(15e3), LowPass(9e3, 1)])
def test_events_through_the_filter_keep_their_instants(low_pass):
    """Two events that ring, at no sample's time, against the equation; and one pole by its own equation."""
    times_s, shares = [2.3e-4, 5.71e-4], [0.8, -0.5]
    ring = lambda t, at, size: size * np.exp(-(t - at) / rubber.RING_S) * np.cos(
        2 * np.pi * rubber.RING_HZ * (t - at)
    ) * (t >= at)  # fmt: skip
    both = lambda t: sum(ring(t, at, size) for at, size in zip(times_s, shares))
    found = rubber.fluctuation(times_s, shares, 14, 10e3, low_pass)
    knots_s, at_s = np.array([0.0, *times_s, 2e-3]), np.arange(1, 14) / 10e3
    if low_pass.order == 2:
        expected = integrated(15e3, knots_s, [both] * 4, at_s, 0.0)
    else:
        rate, state, now, expected = 2 * np.pi * 9e3, [0.0], 0.0, []
        for stop in np.unique([*times_s, *at_s]):
            slope = lambda t, y: [rate * (both(t) - y[0])]
            state = integrate.solve_ivp(slope, (now, stop), state, rtol=1e-10, atol=1e-12).y[:, -1]
            now = stop
            expected += [state[0]] if stop in at_s else []
    assert found[0] == 0 and found[1:] == pytest.approx(expected, abs=1e-6)
    bare = rubber.fluctuation(times_s, shares, 14, 10e3)
    assert np.abs(bare - found).max() > 0.1


def test_channels_through_the_filter():
    """Voltages held since the sample before, against the equation; blocks give the same as the whole."""
    volts = np.random.default_rng(3).uniform(-1, 1, (2, 12))
    for part_v, corner_hz in ((5.0, 15e3), (10.0, 23e3)):
        whole = front.Stream("AD7606", part_v, 10e3).next(volts)
        knots_s = np.arange(13) / 10e3
        for row in range(2):
            expected = integrated(corner_hz, knots_s[:-1], volts[row, 1:], knots_s[1:12], volts[row, 0])
            assert whole[row, 1:] == pytest.approx(expected, abs=1e-7) and whole[row, 0] == volts[row, 0]
        stream = front.Stream("AD7606", part_v, 10e3)
        parts = [stream.next(volts[:, a:b]) for a, b in ((0, 1), (1, 7), (7, 12))]
        assert np.concatenate(parts, axis=1) == pytest.approx(whole, abs=1e-12)
    assert front.Stream("MCP3208", 5.0, 10e3).next(volts) is volts


def test_a_scan_through_the_filter():
    """Three frames of four places, an idle time between, against the equation with held levels."""
    volts = np.random.default_rng(4).uniform(0, 1, (3, 4, 2))
    settle_s, slot_s, idle_s, rest = 7e-6, 11e-6, 23e-6, -0.25
    one = front.held(LowPass(15e3), settle_s, slot_s, idle_s, rest)
    found = np.concatenate([one.next(volts[:1]), one.next(volts[1:])])
    for pin in range(2):
        knots, levels, at = [-1e-6], [rest], []
        now = 0.0
        for frame in range(3):
            for place in range(4):
                knots, levels, at = [*knots, now], [*levels, volts[frame, place, pin]], [*at, now + settle_s]
                now += slot_s
            knots, levels = [*knots, now], [*levels, rest]
            now += idle_s
        expected = integrated(15e3, np.array(knots), levels, np.array(at), rest)
        assert found[:, :, pin].ravel() == pytest.approx(expected, abs=1e-7)
    settled = front.held(LowPass(15e3), 1e-3, 1e-3).next(volts)
    assert settled == pytest.approx(volts, abs=1e-9)
    # A step between two places leaves what a step leaves; from place to place the memory fades.
    step = np.zeros((1, 3, 1))
    step[0, 1] = 1.0
    out = front.held(LowPass(23e3), 5e-6, 50e-6).next(step)[0, :, 0]
    assert out[0] == 0 and 1 - out[1] == pytest.approx(0.8167, abs=6e-5)
