"""The limits of the part models from both sides: exactly at a limit passes, a picosecond short is reported.

By the figures of docs/adc.md, repeated here as numbers. A part's own delays are checked at its output to the
picosecond. Rules that are not times are each broken once.
"""

from dataclasses import fields

import pytest

from parts import ad7606, ad7606c, max1112x, mcp3208
from parts.edges import Edges, Pin

PS = 0.001


def quiet(model, noise):
    """In high impedance a model's output reads as ``noise`` (None: as either level)."""
    if noise is not None:
        model.noise.getrandbits = lambda bits: noise


def mcp3208_run(
    monkeypatch, hi=300, lo=300, sucs=200, csh=700, su=120, hd=None, pulses=19, noise=None, single=1
):
    """Two conversions of channel 5; DIN moves ``su`` before rising CLK, or ``hd`` after it."""
    edges = Edges(monkeypatch, mcp3208)
    cs_n, sclk, mosi, miso = Pin(edges, 1), Pin(edges), Pin(edges), Pin(edges)
    model = mcp3208.Mcp3208(cs_n, sclk, mosi, miso, lambda channel, ns: 0xA53, report=edges.reports.append)
    quiet(model, noise)
    start = 1000
    for _ in range(2):
        edges.at(start, cs_n, 0)
        for pulse in range(pulses):
            rise = start + sucs + pulse * (hi + lo)
            edges.at(rise, sclk, 1)
            edges.at(rise + hi, sclk, 0)
            bits = [1, single, 1, 0, 1]
            bit = bits[pulse] if pulse < 5 else 0
            after = bits[pulse + 1] if pulse < 4 else 0
            if hd is None or pulse == 0:
                edges.at(rise - su, mosi, bit)
            if hd is not None:
                edges.at(rise + hd, mosi, after)
        start += sucs + pulses * (hi + lo)
        edges.at(start, cs_n, 1)
        start += csh
    edges.at(start, cs_n, 0)
    edges.run()
    return edges, model, miso


MCP3208 = {
    "t_hi": ({"hi": 250}, {"hi": 250 - PS}, {"t_hi"}),
    "t_lo": ({"lo": 250}, {"lo": 250 - PS}, {"t_lo"}),
    "t_clk": ({"hi": 250, "lo": 250}, {"hi": 250, "lo": 250 - PS}, {"t_clk", "t_lo"}),
    "t_sucs": ({"sucs": 100, "su": 60}, {"sucs": 100 - PS, "su": 60}, {"t_sucs"}),
    "t_csh": ({"csh": 500}, {"csh": 500 - PS}, {"t_csh"}),
    "t_su": ({"su": 50}, {"su": 50 - PS}, {"t_su"}),
    "t_hd": ({"hd": 50}, {"hd": 50 - PS}, {"t_hd"}),
    # Twelve periods from the sixth falling CLK to the eighteenth.
    "t_droop_max": ({"hi": 50_000, "lo": 50_000}, {"hi": 50_000, "lo": 50_000 + PS}, {"t_droop_max"}),
}


def limits_of(module):
    return {field.name for field in fields(module.Limits)}


@pytest.mark.parametrize("name", MCP3208)
def test_mcp3208(monkeypatch, name):
    at, short, reported = MCP3208[name]
    edges, model, _ = mcp3208_run(monkeypatch, **at)
    assert edges.names() == set() and [row[:2] for row in model.conversions] == [(5, 0xA53)] * 2
    assert mcp3208_run(monkeypatch, **short)[0].names() == reported


def test_mcp3208_answers_after_its_delays(monkeypatch):
    """0 and the bits of 0xA53, each 200 ns after falling CLK and not before; the sixth falls first."""
    edges, _, miso = mcp3208_run(monkeypatch)
    for number, bit in enumerate([0, 1, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1, 1]):
        fall = 1000 + 200 + (5 + number) * 600 + 300
        assert (miso.was(fall + 200 - PS), miso.was(fall + 200)) == (1 - bit, bit)
    assert limits_of(mcp3208) == {*MCP3208, "t_do", "t_dis"}
    assert edges.names() == set()


def test_outputs_are_let_go_after_their_delays(monkeypatch):
    """100, 22 and 15 ns after CS rises; the last bits sent are 1, 1 on both lanes, and 1."""
    miso = mcp3208_run(monkeypatch, noise=0)[2]
    rise = 1000 + 200 + 19 * 600
    assert (miso.was(rise + 100 - PS), miso.was(rise + 100)) == (1, 0)
    _, _, miso, _, end = ad7606_run(monkeypatch, bits=15, noise=0)
    assert (miso.was(end + 22 - PS), miso.was(end + 22)) == (1, 0)  # bit 0: 1 of 0xA5C3, 0 of 0x5A3C
    _, _, miso, begins = max1112x_run(monkeypatch, noise=0)
    rise = begins[-1] + 20 + 15 * 80 + 40 + 60
    assert (miso.was(rise + 15 - PS), miso.was(rise + 15)) == (1, 0)


def test_mcp3208_rules(monkeypatch):
    assert mcp3208_run(monkeypatch, single=0)[0].names() == {"command"}
    edges = Edges(monkeypatch, mcp3208)
    pins = [Pin(edges, 1), Pin(edges), Pin(edges), Pin(edges)]
    mcp3208.Mcp3208(*pins, lambda channel, ns: 0, report=edges.reports.append)
    edges.at(1000, pins[1], 1)
    edges.at(2000, pins[0], 0)
    edges.run()
    assert [str(report) for report in edges.reports] == [
        "mode: CLK runs while CS is high",
        "mode: CLK is high as CS falls",
    ]


def ad7606_run(
    monkeypatch,
    reset=100,
    recover=100,
    high=100,
    cycle=6000,
    read=100,
    period=100,
    sclk_low=50,
    bits=16,
    conversion=3450,
    convert_before=False,
    sclk_rest=1,
    noise=None,
):
    """RESET, a conversion, a read of ``bits`` bits ``read`` ns after BUSY fell, and a second conversion."""
    edges = Edges(monkeypatch, ad7606)
    cs_n, sclk, convst, busy, rst = Pin(edges, 1), Pin(edges, 1), Pin(edges), Pin(edges), Pin(edges)
    miso = Pin(edges, 0, 2)
    codes = [0xA5C3, 1, 2, 3, 0x5A3C, 5, 6, 7]
    args = cs_n, sclk, miso, convst, busy, rst, lambda channel, ns: codes[channel]
    model = ad7606.Ad7606(*args, report=edges.reports.append, conversion_ns=conversion)
    quiet(model, noise)
    if not convert_before:
        edges.at(1000, rst, 1)
        edges.at(1000 + reset, rst, 0)
    first = 1000 + reset + recover
    for rise in (first, first + cycle):
        edges.at(rise, convst, 1)
        edges.at(rise + high, convst, 0)
    begin = first + conversion + read
    edges.at(begin - 10, sclk, sclk_rest)
    edges.at(begin, cs_n, 0)
    for bit in range(bits):
        fall = begin + 50 + bit * period
        edges.at(fall, sclk, 0)
        edges.at(fall + sclk_low, sclk, 1)
    end = begin + 50 + bits * period
    edges.at(end, cs_n, 1)
    edges.run()
    return edges, model, miso, begin, end


AD7606 = {
    "t_reset": ({"reset": 50}, {"reset": 50 - PS}),
    "t_reset_convst": ({"recover": 25}, {"recover": 25 - PS}),
    "t_convst_high": ({"high": 25}, {"high": 25 - PS}),
    "t_convst_low": ({"high": 5975}, {"high": 5975 + PS}),  # of the 6000 from one CONVST to the next
    "t_cycle": ({"cycle": 5000, "bits": 4}, {"cycle": 5000 - PS, "bits": 4}),
    # A read of 50 + 16 * 100 ns that spans CONVST and ends 6000 - 1650 - read before BUSY falls again.
    "t_cs_busy": ({"read": 4325}, {"read": 4325 + PS}),
    "t_sclk": ({"period": 68.966, "sclk_low": 34}, {"period": 68.965, "sclk_low": 34}),
    "t_sclk_low": ({"sclk_low": 40}, {"sclk_low": 40 - PS}),
    "t_sclk_high": ({"sclk_low": 60}, {"sclk_low": 60 + PS}),
}


@pytest.mark.parametrize("name", AD7606)
def test_ad7606(monkeypatch, name):
    at, short = AD7606[name]
    assert ad7606_run(monkeypatch, **at)[0].names() == set()
    assert ad7606_run(monkeypatch, **short)[0].names() == {name}


def test_ad7606_reads_from_busy_falling_on(monkeypatch):
    assert ad7606_run(monkeypatch, read=0)[0].names() == set()
    edges = ad7606_run(monkeypatch, read=-PS)[0]
    assert [str(report) for report in edges.reports] == ["rule: BUSY falls during a read"]


@pytest.mark.parametrize("read", [100, 3000])
def test_ad7606_answers_after_its_delays(monkeypatch, read):
    """0xA5C3 on DOUTA, 0x5A3C on DOUTB: 30 ns after CS, and wrong from 7 to 27 ns after SCLK; the same
    during the next conversion, which runs from 2550 to 6000 ns after the end of the first."""
    _, model, miso, begin, _ = ad7606_run(monkeypatch, read=read)
    assert model.frames[0][0] == 0xA5C3
    before = None
    for number, bits in enumerate(zip(f"{0xA5C3:016b}", f"{0x5A3C:016b}")):
        level = int(bits[0]) | int(bits[1]) << 1
        if number == 0:
            assert (miso.was(begin + 30 - PS), miso.was(begin + 30)) == (3 - level, level)
        else:
            rise = begin + 50 + (number - 1) * 100 + 50
            assert (miso.was(rise + 7 - PS), miso.was(rise + 7)) == (before, 3 - level)
            assert (miso.was(rise + 27 - PS), miso.was(rise + 27)) == (3 - level, level)
        before = level
    own = {"t_conv_min", "t_conv_most", "t_busy", "t_busy_cs", "t_cs_dout", "t_sclk_dout", "t_hold"}
    assert limits_of(ad7606) == {*AD7606, *own, "t_dis"}


def test_ad7606_converts_within_its_times(monkeypatch):
    """BUSY rises at most 45 ns after CONVST and falls 3450 to 4150 ns after it."""
    for seed in range(50):
        edges = Edges(monkeypatch, ad7606)
        cs_n, sclk, convst, busy, rst = Pin(edges, 1), Pin(edges, 1), Pin(edges), Pin(edges), Pin(edges)
        model = ad7606.Ad7606(
            cs_n, sclk, Pin(edges), convst, busy, rst, lambda c, ns: c, report=edges.reports.append
        )
        model.draw.seed(seed)
        edges.at(1000, rst, 1)
        edges.at(2000, rst, 0)
        edges.at(3000, convst, 1)
        edges.run()
        (rose, _), (fell, _) = busy.history
        assert 3000 < rose <= 3045 and 6450 <= fell <= 7150


def test_ad7606_rules(monkeypatch):
    said = lambda **given: set(map(str, ad7606_run(monkeypatch, **given)[0].reports))
    assert "rule: CONVST rises before a RESET" in said(convert_before=True)
    assert "rule: CONVST rises during a conversion" in said(cycle=3000)
    assert said(cycle=5500, read=1900) == set()  # a read spans CONVST
    assert said(read=4351) == {"rule: BUSY falls during a read"}
    assert "mode: SCLK is low as CS falls" in said(sclk_rest=0)


SETUP_C = [0x4200, 0x0210, 0x0311, 0x0411, 0x0511, 0x0611, 0x07FF, 0]
CODES_C = [0xA5C3, 0x1234, 0x5A3C, 0x8001, 0x7FFE, 0x0F0F, 0x3333, 0xC96A]


def ad7606c_run(
    monkeypatch,
    reset=3300,
    recover=275_000,
    high=100,
    cycle=6000,
    read=100,
    period=50,
    sclk_low=25,
    css=20,
    ds=12,
    dh=None,
    csh=60,
    bits=16,
    reads=(0, 0),
    convert_before=False,
    setup=SETUP_C,
    conversion=650,
    lanes=4,
):
    """RESET, the setup for four lanes, a conversion, its words ``read`` ns after BUSY fell, and a second
    conversion."""
    edges = Edges(monkeypatch, ad7606, ad7606c)
    cs_n, sclk, convst, busy, rst, mosi = (Pin(edges, level) for level in (1, 1, 0, 0, 0, 0))
    miso = Pin(edges, 0, lanes)
    args = cs_n, sclk, mosi, miso, convst, busy, rst, lambda channel, ns: CODES_C[channel]
    model = ad7606c.Ad7606c(*args, report=edges.reports.append, conversion_ns=conversion)
    model.noise.getrandbits = lambda bits: 0
    edges.at(1000, rst, 1)
    edges.at(1000 + reset, rst, 0)
    begins = []

    def send(start, word, bits):
        edges.at(start, cs_n, 0)
        begins.append(start)
        levels = [word << bit >> 15 & 1 for bit in range(bits)]
        for number, bit in enumerate(levels):
            fall = start + css + number * period
            if dh is None or number == 0:
                edges.at(fall - ds, mosi, bit)
            if dh is not None and number < bits - 1:
                edges.at(fall + dh, mosi, levels[number + 1])
            edges.at(fall, sclk, 0)
            edges.at(fall + sclk_low, sclk, 1)
        end = start + css + bits * period
        edges.at(end, cs_n, 1)
        return end + csh

    start = 1000 + reset + recover
    for word in setup:
        start = send(start, word, 16)
    first = 1000 + reset + recover if convert_before else start
    for rise in (first, first + cycle):
        edges.at(rise, convst, 1)
        edges.at(rise + high, convst, 0)
    start = first + conversion + read
    for word in reads:
        start = send(start, word, bits)
    edges.run()
    return edges, model, miso, begins


AD7606C = {
    "t_reset": ({"reset": 3200}, {"reset": 3200 - PS}),
    "t_reset_convst": ({"recover": 274_000}, {"recover": 274_000 - PS}),
    "t_convst_high": ({"high": 10}, {"high": 10 - PS}),
    "t_convst_low": ({"high": 5990}, {"high": 5990 + PS}),
    "t_cycle": ({"cycle": 1000, "reads": ()}, {"cycle": 1000 - PS, "reads": ()}),
    "t_sclk": ({"period": 16.667, "sclk_low": 8}, {"period": 16.666, "sclk_low": 8}),
    "t_sclk_low": ({"sclk_low": 20}, {"sclk_low": 20 - PS}),
    "t_sclk_high": ({"sclk_low": 30}, {"sclk_low": 30 + PS}),
    # Two words of 820 ns and 60 between them end 6000 - 1700 - read before BUSY falls again.
    "t_cs_busy": ({"read": 4275}, {"read": 4275 + PS}),
    "t_css": ({"css": 2}, {"css": 2 - PS}),
    "t_csh": ({"csh": 22}, {"csh": 22 - PS}),
    "t_ds": ({"ds": 8}, {"ds": 8 - PS}),
    "t_dh": ({"dh": 3}, {"dh": 3 - PS}),
}


@pytest.mark.parametrize("name", AD7606C)
def test_ad7606c(monkeypatch, name):
    at, short = AD7606C[name]
    edges, model, *_ = ad7606c_run(monkeypatch, **at)
    assert edges.names() == set() and model.frames == [CODES_C] * 2
    assert ad7606c_run(monkeypatch, **short)[0].names() == {name}


def test_ad7606c_answers_after_its_delays(monkeypatch):
    """Four lanes: V1, V3, V5, V7, then V2, V4, V6, V8; 20 ns after CS, and wrong from 5 to 20 ns after SCLK;
    let go 22 ns after CS rises: bit 0 of the first four is 1, 0, 0, 1."""
    _, _, miso, begins = ad7606c_run(monkeypatch, period=100, sclk_low=50)
    for word, begin in enumerate(begins[-2:]):
        before = None
        for bit in range(16):
            level = sum((CODES_C[word + 2 * lane] >> (15 - bit) & 1) << lane for lane in range(4))
            if bit == 0:
                assert (miso.was(begin + 20 - PS), miso.was(begin + 20)) == (15 - level, level)
            else:
                rise = begin + 20 + (bit - 1) * 100 + 50
                assert (miso.was(rise + 5 - PS), miso.was(rise + 5)) == (before, 15 - level)
                assert (miso.was(rise + 20 - PS), miso.was(rise + 20)) == (15 - level, level)
            before = level
    _, _, miso, begins = ad7606c_run(monkeypatch, period=100, sclk_low=50, bits=15, reads=[0])
    end = begins[-1] + 20 + 15 * 100
    assert (miso.was(end + 22 - PS), miso.was(end + 22)) == (0b1001, 0)
    own = {"t_conv_min", "t_conv_most", "t_busy", "t_busy_cs", "t_cs_dout", "t_sclk_dout", "t_hold"}
    assert limits_of(ad7606c) == {*AD7606C, *own, "t_dis"}


@pytest.mark.parametrize("lanes, field", [(1, 0), (2, 1), (4, 2), (8, 3)])
def test_ad7606c_sends_as_many_lanes_as_it_was_told(monkeypatch, lanes, field):
    """Lane l of n sends V(8l/n + 1) and those after it, then zeros, until BUSY falls again."""
    setup, words = [0x4200, 0x0200 | field << 3, *SETUP_C[2:]], 8 // lanes
    given = {"setup": setup, "lanes": lanes, "reads": [0] * (words + 1), "cycle": 20_000}
    edges, _, miso, begins = ad7606c_run(monkeypatch, **given)
    assert edges.names() == set()
    for word, begin in enumerate(begins[-words - 1 :]):
        codes = [CODES_C[word + words * lane] if word < words else 0 for lane in range(lanes)]
        for bit in range(16):
            level = sum((code >> (15 - bit) & 1) << lane for lane, code in enumerate(codes))
            assert miso.was(begin + 20 + bit * 50 + 20) == level


@pytest.mark.parametrize("missing", range(8))
def test_ad7606c_wants_its_setup(monkeypatch, missing):
    setup = [word for number, word in enumerate(SETUP_C) if number != missing]
    assert "setup" in ad7606c_run(monkeypatch, setup=setup, reads=())[0].names()


@pytest.mark.parametrize("word", [0x0310, 0x07FE, 0x0800, 0x4300, 0x8210, 0x0218])
def test_ad7606c_refuses_other_words(monkeypatch, word):
    edges = ad7606c_run(monkeypatch, setup=[*SETUP_C[:-1], word, 0])[0]
    assert [str(report) for report in edges.reports] == [
        f"setup: 0x{word:04x} is no setting that is known to be right"
    ]


def test_ad7606c_rules(monkeypatch):
    said = lambda **given: {str(report) for report in ad7606c_run(monkeypatch, **given)[0].reports}
    assert said(bits=15) == {"mode: a word of 15 SCLK periods"}
    assert said(bits=17) == {"mode: a word of 17 SCLK periods"}
    assert said(reads=[0x8000]) == {"setup: 0x8000 is no read of a register"}
    assert "rule: BUSY falls during a read" in said(read=-PS)
    assert any("registers True" in one for one in said(reads=[0x4200]))
    assert any("setup: CONVST rises with" in one for one in said(convert_before=True, reads=()))


SETUP = [0x0040, 0x8000, 0x8800, 0x9000, 0x9800]


def max1112x_run(
    monkeypatch,
    low=40,
    high=40,
    css=20,
    rest=60,
    csw=60,
    ds=15,
    dh=None,
    words=(),
    setup=SETUP,
    noise=None,
    limits=None,
    channels=8,
):
    """Setup, then three commands for channel 5; DIN moves ``ds`` before rising SCLK or ``dh`` after it."""
    edges = Edges(monkeypatch, max1112x)
    cs_n, sclk, mosi, miso = Pin(edges, 1), Pin(edges, 1), Pin(edges), Pin(edges)
    args = cs_n, sclk, mosi, miso, 12, lambda channel, ns: 0x5A3
    model = max1112x.Max1112x(*args, limits, edges.reports.append, channels)
    quiet(model, noise)
    start, begins = 1000, []
    period = low + high
    for word in words or [*setup, 0x0804 | 5 << 7, 0x0804 | 5 << 7, 0x0804 | 5 << 7]:
        edges.at(start, cs_n, 0)
        begins.append(start)
        bits = [word >> (15 - bit) & 1 for bit in range(16)]
        for number, bit in enumerate(bits):
            fall = start + css + number * period
            edges.at(fall, sclk, 0)
            edges.at(fall + low, sclk, 1)
            if dh is None or number == 0:
                edges.at(fall + low - ds, mosi, bit)
            if dh is not None:
                edges.at(fall + low + dh, mosi, bits[number + 1] if number < 15 else 0)
        start += css + 15 * period + low + rest
        edges.at(start, cs_n, 1)
        start += csw
    edges.run()
    return edges, model, miso, begins


MAX1112X = {
    "t_cp": ({"low": 31, "high": 31.5}, {"low": 31, "high": 31.5 - PS}),
    "t_cp_max": ({"low": 3000, "high": 3250}, {"low": 3000, "high": 3250 + PS}),
    "t_ch": ({"low": 40, "high": 25}, {"low": 40, "high": 25 - PS}),
    "t_cl": ({"low": 25}, {"low": 25 - PS}),
    "t_css": ({"css": 4}, {"css": 4 - PS}),
    "t_csw": ({"csw": 5}, {"csw": 5 - PS}),
    "t_acq": ({"rest": 20, "csw": 32}, {"rest": 20, "csw": 32 - PS}),
    "t_ds": ({"ds": 4}, {"ds": 4 - PS}),
    "t_dh": ({"dh": 1}, {"dh": 1 - PS}),
}


@pytest.mark.parametrize("name", MAX1112X)
def test_max1112x(monkeypatch, name):
    at, short = MAX1112X[name]
    edges, model, _, _ = max1112x_run(monkeypatch, **at)
    assert edges.names() == set() and [row[:2] for row in model.conversions[-2:]] == [(5, 0x5A3)] * 2
    assert max1112x_run(monkeypatch, **short)[0].names() == {name}


MAX11131 = {
    "t_cp": ({"low": 10, "high": 10.834}, {"low": 10, "high": 10.833}),
    "t_cp_max": ({"low": 1000, "high": 1083.333}, {"low": 1000, "high": 1083.334}),
    "t_ch": ({"low": 20, "high": 8.3}, {"low": 20, "high": 8.3 - PS}),
    "t_cl": ({"low": 8.3, "ds": 5}, {"low": 8.3 - PS, "ds": 5}),
    "t_acq": ({"rest": 20, "csw": 32, "low": 20, "high": 20}, {"rest": 20, "csw": 32 - PS}),
}


@pytest.mark.parametrize("name", MAX11131)
def test_a_max11131_is_faster(monkeypatch, name):
    at, short = ({"limits": max1112x.FAST, "ds": 8} | given for given in MAX11131[name])
    assert max1112x_run(monkeypatch, **at)[0].names() == set()
    assert max1112x_run(monkeypatch, **short)[0].names() == {name}


@pytest.mark.parametrize("channel, names", [(15, set()), (8, set()), (0, set())])
def test_a_max11131_has_16_channels(monkeypatch, channel, names):
    words = [*SETUP, 0x0804 | channel << 7, 0x0804]
    edges, model, *_ = max1112x_run(monkeypatch, words=words, channels=16)
    assert edges.names() == names and model.conversions[-1][0] == channel


def test_max1112x_answers_after_its_delays(monkeypatch):
    """Channel 5 and the code 0x5A3: each bit is wrong from 4 ns and right from 16.5 ns after falling SCLK."""
    _, _, miso, begins = max1112x_run(monkeypatch)
    before = None
    for number, bit in enumerate(map(int, f"{0x55A3:016b}")):
        fall = begins[-1] + 20 + number * 80
        assert before is None or miso.was(fall + 4 - PS) == before
        assert (miso.was(fall + 4), miso.was(fall + 16.5 - PS), miso.was(fall + 16.5)) == (
            1 - bit,
            1 - bit,
            bit,
        )
        before = bit
    assert limits_of(max1112x) == {*MAX1112X, "t_dot", "t_hold", "t_dod"}


@pytest.mark.parametrize("missing", SETUP)
def test_max1112x_wants_its_setup(monkeypatch, missing):
    edges = max1112x_run(monkeypatch, setup=[word for word in SETUP if word != missing])[0]
    assert edges.names() == {"setup"} and f"0x{missing:04x}" in str(edges.reports[0])


@pytest.mark.parametrize("word", [0x0804 | 8 << 7, 0x0844, 0x0805, 0x1004, 0x8001])
def test_max1112x_refuses_other_words(monkeypatch, word):
    assert max1112x_run(monkeypatch, words=[*SETUP, word])[0].names() == {"setup"}


def test_max1112x_rules(monkeypatch):
    edges = Edges(monkeypatch, max1112x)
    pins = [Pin(edges, 1), Pin(edges, 1), Pin(edges), Pin(edges)]
    max1112x.Max1112x(*pins, 12, lambda channel, ns: 0, report=edges.reports.append)
    edges.at(1000, pins[1], 0)
    edges.at(2000, pins[0], 0)
    for number in range(17):
        edges.at(3000 + 100 * number, pins[1], 1)
        edges.at(3050 + 100 * number, pins[1], 0)
    edges.run()
    said = [str(report) for report in edges.reports]
    assert said == [
        "mode: SCLK runs while CS is high",
        "mode: SCLK is low as CS falls",
        "mode: more than 16 SCLK periods",
    ]
