"""Fault injection in a short form: a few hundred faults in small blocks, none of them undetected; it finds
planted defects: a state machine that never recovers, a frame whose damage is not reported."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from meissner.builds import toolchain
from nightly import faults, initial
from nightly.limits import Limits


@pytest.mark.parametrize("block", ["frame_filter", "skid"])
def test_no_fault_is_undetected(block):
    results = faults.inject(block, 40, 3)
    kinds = {result.kind for result in results}
    assert {"bit", "reset"} <= kinds and len(results) > 40
    assert [result for result in results if result.outcome == "silent"] == []
    assert any(result.outcome == "recovered" for result in results)  # some faults have an effect


def planted(monkeypatch, tmp_path, block, good, bad):
    """The block with ``bad`` in place of ``good``."""
    paths = list(toolchain.sources_of(f"msn_{block}"))
    at = next(n for n, path in enumerate(paths) if path.stem == f"msn_{block}")
    text = paths[at].read_text()
    assert good in text
    paths[at] = Path(tmp_path) / paths[at].name
    paths[at].write_text(text.replace(good, bad))
    monkeypatch.setattr(faults, "program", _with(faults.program, paths))


def _with(program, paths):
    def made(*given):
        before, toolchain.sources_of = toolchain.sources_of, lambda _: paths
        try:
            return program(*given)
        finally:
            toolchain.sources_of = before

    return made


def test_finds_damage_that_nobody_reports(monkeypatch, tmp_path):
    told = "if (in_last_i) restart <= !keep;\n    end\n"
    told += "    damage    <= in_valid_i && in_ready_o && in_last_i && !keep;"
    planted(monkeypatch, tmp_path, "frame_filter", told, "restart <= 1'b0;\n    end\n    damage <= 1'b0;")
    assert any(result.outcome == "silent" for result in faults.inject("frame_filter", 200, 3))


def test_finds_bytes_that_stay_wrong(monkeypatch, tmp_path):
    byte = "code ? 8'(count) : (state == Body) ? in_data_i : '0;"
    key = "out_data_o = key ^ (" + byte.replace(";", ");")
    key += " logic [7:0] key; always_ff @(posedge clk_i) if (rst_i) key <= '0;"
    planted(monkeypatch, tmp_path, "cobs", "out_data_o  = " + byte, key)
    silent = [result.where for result in faults.inject("cobs", 120, 3) if result.outcome == "silent"]
    assert silent and all(where.startswith("key") for where in silent)


@pytest.mark.long
def test_finds_an_access_that_never_ends(monkeypatch, tmp_path):
    kept = "asked <= {2{!taken}} & (asked | {asked[0], bus_valid_o});"
    planted(monkeypatch, tmp_path, "axil", "asked <= {asked[0], bus_valid_o};", kept)
    results = faults.inject("axil", 60, 3)
    assert any("asked" in result.where for result in results if result.outcome == "silent")


@pytest.mark.long
def test_finds_a_block_that_waits_for_ever(monkeypatch, tmp_path):
    planted(monkeypatch, tmp_path, "tare", "ending && drain > 3'd1;", "ending && !done;")
    results = faults.inject("tare", 4000, 1)  # so many that some hit this one bit of 785
    assert any("ending" in result.where for result in results if result.outcome == "silent")


@pytest.mark.long
def test_finds_a_state_that_never_ends(monkeypatch, tmp_path):
    planted(monkeypatch, tmp_path, "hypot", "{phase[1:0], ~|phase[1:0]}", "{phase[1:0], phase[2]}")
    assert any(result.outcome == "silent" for result in faults.inject("hypot", 300, 1))


@pytest.mark.long
def test_finds_a_row_that_does_not_say_that_it_is_wrong(monkeypatch, tmp_path):
    planted(monkeypatch, tmp_path, "forest", "out_error_o <= errors[oldest];", "out_error_o <= '0;")
    assert any(result.outcome == "silent" for result in faults.inject("forest", 200, 1))


def test_a_run_in_which_nothing_comes_out_is_refused(monkeypatch):
    monkeypatch.setattr(faults, "stated", lambda block, key, other: {"rows": 2} if key == "driver" else other)
    with pytest.raises(RuntimeError, match="too few frames to compare"):
        faults.inject("skid", 20, 3)


def test_what_is_kept_may_be_of_one_instance_alone():
    assert faults.inside("u_tare", ["fresh", "zero_"]) == ["u_tare.&fresh", "u_tare.&zero_"]
    kept = faults.kept_of("core")
    assert {"written", "u_tare.&fresh", "u_calibrate.&memory", "u_health.&tick", "cfg"} <= {*kept}


def test_a_setting_is_put_at_its_bits_of_the_struct():
    """adc: bits 23:0 are the period, bit 24 is enable."""
    assert faults.placed("in_i:3 adc.period:1f adc.enable:1") == "in_i:3 cfg_i[23:0]:1f cfg_i[24:24]:1"


def test_an_undetected_fault_breaks_the_limit_unless_it_is_named(monkeypatch):
    """With another bit, register or block named, it does; a register of one bit has no number."""
    upset = faults.Result("bit", "level.3", 9, "silent", "")
    for where, block, register, bit, within in (
        ("level.3", "skid", "level", 3, True),
        ("level.3", "skid", "level", "any", True),
        ("level.3", "skid", "level", 2, False),
        ("level.3", "skid", "leve", 3, False),
        ("level.3", "fork", "level", 3, False),
        ("u_in.held", "skid", "u_in.held", 0, True),
    ):
        monkeypatch.setattr(faults, "inject", lambda *_, where=where: [replace(upset, where=where)])
        row = {"block": block, "register": register, "bit": bit, "reason": "none"}
        found = faults.run("skid", Limits({"faults": {"undetected": [row]}}))
        assert (found["broken"] == []) == within, row
    monkeypatch.setattr(faults, "inject", lambda *_: [])
    assert faults.run("skid", Limits({"faults": {"undetected": []}}))["broken"] == ["nothing was injected"]


def test_a_table_of_constants_is_no_state(monkeypatch):
    """Registers that only an initial block writes, in each instance; a flag that it only initialises is
    state."""
    found = {
        block: initial.only(toolchain.sources_of(f"msn_{block}"), f"msn_{block}", {})
        for block in ("exp2", "shear_speed", "adc_store", "fifo")
    }
    assert found == {
        "exp2": {"rom"},
        "shear_speed": {"u_log.rom", "u_exp.rom"},
        "adc_store": set(),
        "fifo": set(),
    }
    three = initial.only(toolchain.sources_of("msn_shear_speeds"), "msn_shear_speeds", {"Channels": 3})
    assert len(three) == 6 and "gen_shear_speed.gen_channel[2].u_shear_speed.u_log.rom" in three
    upset = [faults.Result("bit", where, 9, "silent", "") for where in ("rom[5].3", "entry.3", "rome[5].3")]
    monkeypatch.setattr(faults, "_run", lambda *_: upset)
    assert [result.where for result in faults.inject("exp2", 3, 1)] == ["entry.3", "rome[5].3"]


def test_wrapper_has_the_ports_and_parameters_of_its_block():
    source = next(path for path in toolchain.sources() if path.stem == "msn_fifo").read_text()
    text = faults.wrapper("fifo", source)
    assert "msn_fifo #(.Depth(Depth), .Width(Width)) u_block (.*);" in text
    assert re.search(r"module faults_top #\(\s*parameter int unsigned Depth = 16", text)
