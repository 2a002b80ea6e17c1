"""The VCD of ``run --waves``, read back: it has an array's frames and results clock by clock as the twin has
them, and stays small at every array size and recording length; that of a slip run covers 20 ms. A traced core
that differs is counted; engines without signals refuse (tb/cli)."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from meissner import engines, run, scenes
from meissner.engines import rtl_cop, rtl_cop4
from meissner.scenes.grip import run as cop_slip

pytestmark = pytest.mark.usefixtures("undrawn")
CLOCK_PS = 10**9 // rtl_cop.TRACE_CLK_KHZ


def read_vcd(path, wanted):
    """Time in ps of each rising edge [n], and the values of the ``wanted`` ports just before it, [n] each."""
    codes, scope, values, rows, now = {}, [], dict.fromkeys(wanted, 0), [], 0
    with open(path) as file:
        for line in file:
            word = line.split()
            if line.startswith("$enddefinitions"):
                break
            if word[:1] == ["$scope"]:
                scope.append(word[2])
            elif word[:1] == ["$upscope"]:
                scope.pop()
            elif word[:1] == ["$var"] and scope == ["TOP"] and word[4] in wanted:
                codes[word[3]] = word[4]
        for line in file:
            if line[0] == "#":
                now = int(line[1:])
            elif line[0] in "01" and (name := codes.get(line[1:-1])):
                value = int(line[0])
                if name == "clk_i" and value > values["clk_i"]:
                    rows.append((now, *values.values()))
                values[name] = value
            elif line[0] == "b":
                value, code = line.split()
                if code in codes:
                    values[codes[code]] = int(value[1:], 2)
    times, *columns = zip(*rows)
    return np.array(times), dict(zip(wanted, map(np.array, columns)))


def run_with_waves(tmp_path, name, **changes):
    scene = dataclasses.replace(scenes.load(name), **changes)
    return scene, run.run(scene, "rtl", tmp_path, seed=2, waves=True)


@pytest.mark.parametrize("name", ["walk_25x5", "plantar_step"])
def test_an_arrays_frames_are_in_it(tmp_path, name):
    scene, summary = run_with_waves(tmp_path, name)
    assert summary["twin_mismatches"] == 0
    path = tmp_path / "waves.vcd"
    assert 100_000 < path.stat().st_size < 8_000_000
    ports = ("clk_i", "in_valid_i", "in_ready_o", "in_last_i", "in_data_i")
    ports += ("out_valid_o", "out_load_o", "out_x_o", "out_y_o")
    times, seen = read_vcd(path, ports)
    assert set(np.diff(times)) == {CLOCK_PS}
    result = np.load(tmp_path / "result.npz")
    taken = (seen["in_valid_i"] & seen["in_ready_o"]).astype(bool)
    row_beats = -(-scene.columns // rtl_cop.lanes(scene.columns))
    beats = scene.rows * row_beats
    count = rtl_cop.TRACE_BEATS // beats
    last = int(np.argmax(result["sum"]))
    # The file ends at the last rising edge, which shows the last result.
    assert taken.sum() == count * beats
    assert seen["in_last_i"][taken].sum() == count
    if scene.columns < rtl_cop.WIDE:  # one force a beat
        forces = seen["in_data_i"][taken][-beats:]
        assert np.array_equal(forces, result["codes"][last].ravel())
    out = seen["out_valid_o"].astype(bool)
    loads = result["sum"][last + 1 - count : last]
    assert np.array_equal(seen["out_load_o"][out][-len(loads) :], loads)
    x = seen["out_x_o"][out][-len(loads) :].astype(np.uint16).view(np.int16)
    assert np.array_equal(x, result["x"][last + 1 - count : last])


def test_the_largest_array_stays_small(tmp_path):
    forces = np.random.default_rng(1).integers(0, 65536, (1, 1024, 1024), dtype=np.uint16)
    assert rtl_cop.shown(np.array([3, 9, 4]), (1024, 1024)) == slice(1, 2)
    assert rtl_cop.shown(np.array([3, 9, 4]), (3, 3)) == slice(0, 2)
    seen = rtl_cop.cop(forces, 1, tmp_path / "waves.vcd")
    plain = engines.process_cop(forces, "fixed")
    assert all(np.array_equal(seen[name], plain[name]) for name in plain)
    assert (tmp_path / "waves.vcd").stat().st_size < 8_000_000


def test_a_traced_core_that_differs_is_reported(tmp_path, monkeypatch):
    cop = rtl_cop.cop

    def spoil(forces, min_load=1, waves=None):
        result = cop(forces, min_load, waves)
        if waves is not None:
            result["x"][-1] += 1
        return result

    monkeypatch.setattr(rtl_cop, "cop", spoil)
    assert run_with_waves(tmp_path, "walk_25x5")[1]["twin_mismatches"] == 1


def test_a_slip_runs_twenty_milliseconds(tmp_path):
    _, summary = run_with_waves(tmp_path, "acrylic_slip", seeds=1)
    assert summary["twin_mismatches"] == 0
    times, seen = read_vcd(tmp_path / "waves.vcd", ("clk_i", "slip_o", "verdict_o", "decision_o"))
    assert np.ptp(times) / 1e12 == pytest.approx(0.02, rel=0.01)
    raised = seen["verdict_o"] >> 18 & seen["decision_o"] >> 44 & 1  # verdict_t.valid and decision_t.raised
    assert raised.sum() >= 1
    # The flag rises in the clock after the decision that raises it.
    first = int(np.argmax(raised))
    assert not seen["slip_o"][: first + 1].any() and seen["slip_o"][first + 1]


def test_four_electrodes_are_in_it(tmp_path):
    """The samples up to the greatest load, 200 at most, and every result except that of the last clock."""
    for name, count in (("cop_load", 21), ("cop_circle", None)):
        _, summary = run_with_waves(tmp_path, name)
        assert summary["twin_mismatches"] == 0
        names = ("in_valid_i", "in_ready_o", "in_e1_i", "in_e4_i", "out_valid_o", "out_load_o", "out_x_o")
        times, seen = read_vcd(tmp_path / "waves.vcd", ("clk_i", *names))
        assert set(np.diff(times)) == {CLOCK_PS}
        result = np.load(tmp_path / "result.npz")
        last = int(np.argmax(result["load"])) + 1
        first = max(0, last - rtl_cop4.TRACE_SAMPLES)
        assert count in (None, last - first)
        taken = (seen["in_valid_i"] & seen["in_ready_o"]).astype(bool)
        codes = result["codes"][first:last] & 0xFFFFFF
        assert taken.sum() == len(codes)
        for port, column in (("in_e1_i", 0), ("in_e4_i", 3)):
            assert np.array_equal(seen[port][taken], codes[:, column])
        out = seen["out_valid_o"].astype(bool)
        loads = np.rint(result["load"][first : last - 1] * 1e3)
        assert np.array_equal(seen["out_load_o"][out][-len(loads) :], loads)


def test_a_slips_flag_is_in_it(tmp_path):
    scene, summary = run_with_waves(tmp_path, "cop_slip", seeds=1)
    assert summary["twin_mismatches"] == 0
    names = ("clk_i", "in_valid_i", "in_ready_o", "in_load_i", "out_valid_o", "out_raised_o", "out_octant_o")
    _, seen = read_vcd(tmp_path / "waves.vcd", names)
    taken = (seen["in_valid_i"] & seen["in_ready_o"]).astype(bool)
    end = round((summary["flag_s"] + cop_slip.AFTER_S) * scene.rate_hz)
    loads = np.load(tmp_path / "result.npz")["c0_load"][end - rtl_cop4.TRACE_SAMPLES : end]
    assert np.array_equal(seen["in_load_i"][taken], loads)
    raised = (seen["out_valid_o"] & seen["out_raised_o"]).astype(bool)
    assert raised.sum() == 1 and seen["out_octant_o"][raised].tolist() == [0]


@pytest.mark.parametrize(
    "name, part, seeds", [("cop_load", "cop4", {}), ("cop_slip", "cop_slip", {"seeds": 1})]
)
def test_a_traced_four_wire_core_that_differs_is_reported(tmp_path, monkeypatch, name, part, seeds):
    module = engines.load("rtl")
    right = getattr(module, part)

    def spoil(*arguments):
        result = right(*arguments)
        found = result if part == "cop4" else result[0]
        if isinstance(arguments[-1], Path):
            found.load[-1] += 1
        return result

    monkeypatch.setattr(module, part, spoil)
    assert run_with_waves(tmp_path, name, **seeds)[1]["twin_mismatches"] == 1
