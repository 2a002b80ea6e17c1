"""The netlist after synthesis, in each family's cells, against sources and twins: the slip path used by the
command, the smallest build of each family from its converter's pins to its packets, and named configurations
on the engine `gate`."""

import shutil

import numpy as np
import pytest

import gate
from meissner import engines
from meissner.builds import boards, config, netlist, toolchain, yowasp
from meissner.engines import gate as gates
from meissner.engines import rtl_core
from meissner.scenes.core_stimulus import codes_of
from meissner.twins import core
from meissner.twins.link import packet
from meissner.twins.link.decoder import Decoder
from meissner.twins.slip.config import SlipConfig


def test_the_gate_engine_is_the_integer_twin():
    rng = np.random.default_rng(1)
    samples = np.concatenate(
        [rng.integers(-40, 41, 640), rng.integers(-65536, 65536, 640), [65535, -65536] * 64]
    )
    config = SlipConfig(threshold=60)
    results = [engines.process_slip(samples, config, name) for name in ("fixed", "gate")]
    assert results[0]["slip"].any() and not results[0]["slip"].all()
    for name, values in results[0].items():
        assert np.array_equal(values, results[1][name]), name


@pytest.mark.long
@pytest.mark.parametrize("name", ["icebreaker", "ulx3s", "tangnano20k"])
def test_a_boards_netlist_sends_the_packets_of_its_sources(name):
    """The packets' payloads equal the twin's."""
    board = boards.BOARDS[name]
    codes = gate.codes(board, "slip1")
    line = rtl_core.line(board, "slip1", codes, gates=True)
    assert line == rtl_core.line(board, "slip1", codes)
    # msn_adc_single first converts at the end of a timer period, msn_adc_spi at its start.
    samples = codes[bool(board.parameters("slip1")["AdcPeriod"]) :]
    expected = [payload for _, payload in core.of_channels(samples, board.config("slip1").slip).slip]
    assert expected
    assert [found.payload for found in Decoder().next(line) if found.kind == packet.SLIP] == expected


@pytest.mark.long
@pytest.mark.parametrize("name", config.names())
def test_a_named_configurations_netlist_says_the_same(name):
    build = config.load(name)
    start, frames, every = gate.SCENES[name]
    codes = codes_of(build)[start::every][:frames]
    lines = []
    for engine_of in (rtl_core.CoreOnPins, gates.CoreOnPins):
        with engine_of(build, codes) as built:
            lines.append(built.run(frames * build.period_clocks))
    assert lines[0] == lines[1]
    assert len(Decoder().next(lines[0])) > 0


def test_every_named_configuration_has_a_scene():
    assert set(gate.SCENES) == set(config.names())


def test_a_netlist_is_read_from_what_its_top_needs():
    assert yowasp.rtl(top="msn_skid") == ["rtl/common/msn_skid.sv"]
    assert yowasp.rtl("ice40", "msn_multiply") == ["rtl/common/msn_multiply.sv"]
    assert yowasp.rtl("ecp5", "msn_multiply") == ["rtl/ecp5/msn_multiply.sv"]
    assert set(yowasp.rtl(top="msn_cop_slip")) < set(yowasp.rtl())


def test_a_netlist_is_made_again_when_a_familys_own_source_changes(monkeypatch, tmp_path):
    own, made = tmp_path / "msn_multiply.sv", []

    def yosys(script, log):
        made.append(toolchain.ROOT / script.split()[-1])
        made[-1].write_text("endmodule\n")

    monkeypatch.setitem(yowasp.INSTEAD["ecp5"], "rtl/common/msn_multiply.sv", str(own))
    monkeypatch.setattr(yowasp, "yosys", yosys)
    monkeypatch.setattr(yowasp, "warm_up", lambda: None)
    for text, times in (("one", 1), ("one", 1), ("two", 2)):
        own.write_text(text)
        netlist.verilog("msn_multiply", {}, "ecp5")
        assert len(made) == times
    for path in made:
        shutil.rmtree(path.parent)
