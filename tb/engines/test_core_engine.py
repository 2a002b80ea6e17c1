"""The named configurations on engine rtl, from codes at the pins to bytes of the line: every packet is the
model's; the host finds such a core, through a pty too, and shows slip and CoP."""

import numpy as np
import pytest

from meissner import cli, config, core, host
from meissner.engines.rtl_core import CoreOnPins, codes_of
from meissner.host.pty import Pty
from meissner.link import packet as p
from meissner.link.decoder import Decoder

SECONDS = {"slip1": 0.9, "fingertip": 0.1, "cop4": 0.45, "full": 0.05}


def images(packets):
    found = []
    for q in packets:
        if q.kind == p.IMAGE:
            if q.fields["first"] == 0:
                found.append((q.time, []))
            found[-1][1].extend(q.fields["taxels"])
    return found


@pytest.mark.parametrize("name", SECONDS)
def test_every_packet_is_the_models(name):
    build = config.load(name)
    codes = codes_of(build)
    if name == "slip1":
        codes = codes[30_000:]  # held since the second before, and soon to slip
    if build.kind == "array" and build.sensor["rows"] == 64:
        codes = codes[:: max(1, len(codes) // 25)]  # the press passes in a few frames
    with CoreOnPins(build, codes) as built:
        decoder = Decoder()
        got = decoder.next(built.run(round(SECONDS[name] * 1000 * build.clk_khz)))
        frames = built.frames
    assert (decoder.damaged, decoder.missed) == (0, 0)
    order = np.arange(frames) % len(codes)
    expected = core.expected(build, codes[order])
    events = [q.payload for q in got if q.kind == p.SLIP]
    assert events == [payload for _, payload in expected.slip][: len(events)]
    assert len(events) >= len(expected.slip) - (8 if build.kind == "array" else 1)
    assert len(events) > 0 or build.kind == "array"
    cops = [(q.time, q.payload) for q in got if q.kind == p.COP]
    if build.kind != "channels":
        # CoP frames that found the one before unsent replace it: never with events as sparse as here.
        assert [payload for _, payload in cops] == [payload for _, payload in expected.cop][: len(cops)]
        assert len(cops) >= frames - 3
        assert set(np.diff([time for time, _ in cops])) == {build.period_clocks}
    if build.link["images"]:
        sent = [tuple(taxels) for _, taxels in images(got)]
        whole = [taxels for taxels in sent if len(taxels) == codes[0].size]
        assert len(whole) >= 1
        assert set(whole) <= {tuple(image) for image in expected.images.tolist()}


def test_the_host_finds_a_core_behind_a_pty_and_hears_slip_and_cop():
    build = config.load("cop4")
    with (
        CoreOnPins(build, codes_of(build)) as built,
        Pty(built) as pty,
        host.connect(pty.url, build.units, timeout_s=5.0) as found,
    ):
        assert found["core.clk_khz"] == build.clk_khz
        assert found["cop4.kx"] == build.settings["cop4.kx"]
        seen = set()
        for packet in found.packets(60.0):
            seen.add(type(packet))
            if seen >= {host.SlipEvent, host.CopFrame}:
                break
    assert seen >= {host.SlipEvent, host.CopFrame}


def test_live_shows_a_core_on_verilator(capsys):
    cli.main(["live", "core:cop4", "--seconds", "1"])
    shown = capsys.readouterr().out.splitlines()
    assert "load" in shown[-1] and "slip" in shown[-1], shown
