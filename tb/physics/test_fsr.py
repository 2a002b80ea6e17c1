"""The resistive matrix against the complete set of its nodal equations; ghosts and how to avoid them;
materials, drift and every fault."""

import numpy as np
import pytest

from meissner.physics import fsr
from meissner.physics.fsr import Fault, Readout

RNG = np.random.default_rng(5)
VELOSTAT, FSR400 = fsr.MATERIALS["Velostat"], fsr.MATERIALS["FSR400"]


def whole_network(siemens, readout, row, faults=()):
    """Column voltages while ``row`` is driven: the equations of all nodes in one dense solve."""
    rows, columns = siemens.shape
    matrix, right = np.zeros((rows + columns,) * 2), np.zeros(rows + columns)
    cut_rows = {f.row for f in faults if f.kind == "dead row"}
    cut_columns = {f.column for f in faults if f.kind == "open column"}
    for i in range(rows):
        for j in range(columns):
            g = siemens[i, j]
            matrix[i, i] += g
            matrix[rows + j, rows + j] += g
            matrix[i, rows + j] -= g
            matrix[rows + j, i] -= g
    for i in set(range(rows)) - cut_rows:
        if i == row or readout.unselected == "grounded":
            matrix[i, i] += 1 / readout.driver_ohm
        if i == row:
            right[i] = readout.supply_v / readout.driver_ohm
    for j in set(range(columns)) - cut_columns:
        end = readout.hold_ohm if readout.circuit == "zero potential" else readout.load_ohm
        matrix[rows + j, rows + j] += 1 / end
    volts = np.linalg.solve(matrix, right)[rows:]
    return np.where([j in cut_columns for j in range(columns)], 0, volts)


@pytest.mark.parametrize("circuit", fsr.CIRCUITS)
@pytest.mark.parametrize("unselected", fsr.UNSELECTED)
@pytest.mark.parametrize("faults", [(), (Fault("dead row", 2, -1), Fault("open column", -1, 1))])
def test_the_network_is_its_nodal_equations(circuit, unselected, faults):
    readout = Readout(circuit, unselected, 3.3, 30.0, 2e3)
    siemens = 10.0 ** RNG.uniform(-6, -2.5, (3, 6, 4))
    volts = fsr.column_volts(siemens, readout, faults)
    for frame, got in zip(siemens, volts):
        for row in range(6):
            assert got[row] == pytest.approx(whole_network(frame, readout, row, faults), rel=1e-9, abs=1e-15)


def test_lines_with_nothing_on_them_read_nothing():
    for unselected in fsr.UNSELECTED:
        readout = Readout("divider", unselected, 3.3, 30.0, 2e3)
        siemens = np.zeros((3, 3))
        siemens[1, 2] = 1e-3
        volts = fsr.column_volts(siemens, readout)
        assert volts[1, 2] == pytest.approx(3.3 * 2000 / (30 + 1000 + 2000))
        volts[1, 2] = 0
        assert not volts.any()


def test_ghosts_come_from_floating_rows_and_go_with_zero_potential():
    """Three pressed corners of a square: the fourth is the classical ghost."""
    siemens = np.full((8, 8), 1e-8)
    siemens[1, 1] = siemens[1, 6] = siemens[5, 1] = 1e-3

    def ghost(circuit, unselected):
        volts = fsr.output_volts(siemens, Readout(circuit, unselected, 3.3, 5.0, 1e3))
        return volts[5, 6] / volts[5, 1]

    assert ghost("divider", "floating") > 0.2
    assert ghost("divider", "grounded") < 0.01
    assert ghost("zero potential", "floating") < 1e-3 and ghost("zero potential", "grounded") < 1e-3


def test_zero_potential_reads_each_cell_alone():
    siemens = 10.0 ** RNG.uniform(-5, -3, (16, 16))
    readout = Readout("zero potential", "grounded", 3.3, 1e-3, 1e3, hold_ohm=1e-3)
    assert fsr.output_volts(siemens, readout) == pytest.approx(3.3 * siemens * 1e3, rel=1e-4)


def test_materials():
    assert fsr.conductance(0.0, FSR400) == pytest.approx(1e-7)  # published: more than 10 megohms
    assert fsr.conductance(0.19, FSR400) == fsr.conductance(0.0, FSR400)  # published: from 0.2 N
    force_n = np.linspace(0.25, 10, 50)
    assert (np.diff(fsr.conductance(force_n, FSR400)) > 0).all()
    assert fsr.conductance(1.0, VELOSTAT) == pytest.approx(1 / 20e3 + 1e-6)
    strength = fsr.strengths(100, 100, FSR400, np.random.default_rng(1))
    assert strength.std() == pytest.approx(0.06, abs=0.002) and strength.mean() == pytest.approx(1, abs=0.002)


def test_drift_is_per_decade_of_time_under_load_and_ends_with_it():
    force_n = np.repeat([0.0, 1.0, 0.0, 1.0], [10, 1001, 5, 20])[:, None]
    gain = fsr.drift(force_n, FSR400, 10.0)[:, 0]
    assert (gain[:11] == 1).all() and (gain[1011:1015] <= gain[1011]).all()
    assert gain[1010] - gain[110] == pytest.approx(0.03 * np.log10(100.1 / 10.1), rel=1e-3)
    assert gain[1016] == 1 and gain[1017] == gain[11]


def test_faults():
    siemens = np.full((4000, 4, 4), 1e-4)
    faults = [Fault("dead", 0, 1), Fault("saturated", 1, 1), Fault("blinking", 2, 2), Fault("stuck", 3, 3)]
    broken = fsr.break_cells(siemens, faults, 1000, np.random.default_rng(2))
    assert (siemens == 1e-4).all()
    assert not broken[:, 0, 1].any() and (broken[:, 1, 1] == fsr.SHORT_SIEMENS).all()
    blinking = broken[:, 2, 2] > 0
    assert 0.25 < blinking.mean() < 0.75
    assert 0.5 < np.count_nonzero(np.diff(blinking)) / (4000 / 1000 / fsr.BLINK_S) < 1.5
    broken[:, 2, 2], broken[:, 1, 1], broken[:, 0, 1] = 1e-4, 1e-4, 1e-4
    assert (broken == 1e-4).all()
    codes = fsr.stick(np.zeros((5, 4, 4), np.int32), faults, 4095)
    assert (codes[:, 3, 3] == 1638).all() and np.count_nonzero(codes) == 5
