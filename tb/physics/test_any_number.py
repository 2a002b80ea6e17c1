"""Numbers that no sensor has: every public function of the physics, the solvers, the intervals and the public
interface refuses infinity, NaN and sizes beyond 1e12 in a sentence, or computes without a warning and
gives finite numbers. Each number of each argument in turn."""

import dataclasses
import warnings
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import meissner
from meissner import arrays, interval
from meissner.physics import (
    adc,
    capacitive,
    dielectric,
    disturbances,
    footprints,
    front,
    fsr,
    grip,
    mesh_loads,
    pins,
    plate,
    receptors,
    rubber,
)
from meissner.physics.mesh import Mesh
from meissner.physics.mesh.cut import CutMesh
from meissner.twins.slip.config import SlipConfig

BAD = (np.inf, -np.inf, np.nan, 1e300, -1e300, 1.1e12)
TIME_S, LOAD = np.arange(100) / 1e3, np.where(np.arange(12) == 6, 2.0, 0.0).reshape(1, 3, 4)
VELOSTAT, MESH = next(iter(fsr.MATERIALS.values())), Mesh(3, 4, 47.0)
PART = adc.PARTS["MCP3208"]
SHAPE = next(iter(footprints.SHAPES))


def rng():
    return np.random.default_rng(1)


PULL = plate.pull(TIME_S, 2.0, 1.0, "acrylic", 0.01, rng())
CALLS = {
    rubber.ring: (1.5, 3.0),
    rubber.conductance: (np.array([0.0, 2.0]),),
    rubber.divider_volts: (1e-3,),
    rubber.rest_volts: (2.0,),
    rubber.shear_gain: (2.0,),
    rubber.shear_step: (2.0, 1.0),
    rubber.shear_level: (TIME_S, np.ones(100), 0.5),
    rubber.slipped: (0.5,),
    rubber.event_ratios: (rng, 0.875, 1.0),
    rubber.event_shares: (3, 1.0, rng),
    rubber.fluctuation: (np.array([0.01]), np.array([0.02]), 100, 1e3),
    rubber.event_steps: (2.0, 0.01),
    rubber.volts: (2.0, 0.5, 0.01),
    adc.Adc: (12, 0.0, 5.0, 1e-3),
    PART.convert: (2.0,),
    PART.volts_of: (2.0,),
    front.LowPass: (15e3,),
    front.LowPass(15e3).gain: (1e3,),
    front.LowPass(15e3).left: (1e-6,),
    front.LowPass(15e3).most_left: (1e-6,),
    front.LowPass(15e3).settled_s: (0.01,),
    front.paths: ("MCP3208", 5.0, 1e-6, 100.0),
    capacitive.plate_f: (0.1,),
    capacitive.tab_height: (0.1, 1.0, 0.5),
    capacitive.capacitance_ratio: (0.1, 1.0, 0.5),
    capacitive.creep: (np.ones(10), 100.0),
    dielectric.strain_confined: (1e3, 0.4, 1e5),
    dielectric.rise: (5.0, 0.3),
    dielectric.force_for: (0.1, 0.3),
    disturbances.hum: (TIME_S, 0.1, rng),
    disturbances.flicker: (100, 1e3, 0.1, rng),
    disturbances.play: (np.ones(5), 0.1),
    disturbances.hysteresis: (np.ones(5), 0.1),
    disturbances.bursts: (np.array([0.1]), 2.0, 1.0, rng),
    footprints.bar: (0.0, 0.0, 1.0, 1.0, 10.0),
    footprints.ring: (0.0, 0.0, 1.0, 0.5),
    footprints.points: (SHAPE, 12.0),
    fsr.conductance: (2.0, VELOSTAT, 1.0),
    fsr.drift: (np.ones((10, 2, 2)), VELOSTAT, 100.0),
    grip.ramps: (TIME_S, [(0.0, 0.1, 1.0)]),
    grip.share: (np.ones(3), np.ones(3)),
    grip.mirrored: (30.0,),
    grip.gripped: (np.ones(3),),
    mesh_loads.true_centre: (LOAD,),
    mesh_loads.cop_one_point: (10.0,),
    mesh_loads.random_points: (3, 4, 2, np.array([1.0, 2.0]), 1),
    mesh_loads.cop_six_random: (10.0, 5.0, 2),
    mesh_loads.cover_kernel: (1.0, 1.0, 2.0),
    mesh_loads.press: (3, 4, 0.1, 0.2, 2.0, 1.0),
    mesh_loads.touches: (3, 4, "point", 1, 5.0),
    mesh_loads.hemisphere_depth: (0.1, 0.1, 1.0, 1.0),
    mesh_loads.stroke: (3, 3, 5.0, 0.5, 8, 1.5),
    pins.transfer: (230.0, True, 30.0),
    pins.moved: (np.array([30.0, 0.0, 30.0, 0.0]), 1e4, True),
    pins.period: (230.0, 30.0, True, 0.5),
    pins.peak_db: (230.0, 30.0, True),
    pins.in_db: (np.ones(3),),
    pins.by_laser: (np.ones(64), 230.0, rng),
    pins.peaks: (np.arange(100.0), 230.0),
    pins.measured_db: (np.ones(64), 230.0, rng),
    receptors.summation_db: (0.0007,),
    receptors.threshold_db: ("FA-II", 230.0, 0.0007),
    receptors.reached: ("FA-II", 230.0, 3.0, 0.0007),
    receptors.sensation: ("SA-I", np.ones(64), 1e4, 0.0007),
    plate.rise_s: (2.0, 1.0, "acrylic", 0.1, 1.0),
    plate.pull: (TIME_S, 2.0, 1.0, "acrylic", 0.01, rng),
    plate.press: (TIME_S, 2.0, [(0.01, 0.05)], rng),
    plate.followed: (TIME_S, 2.0, PULL, 0.1, rng),
    PULL.time_of: (0.5,),
    Mesh: (3, 4, 10.0, 1e3, 15.0, 4320.0),
    MESH.solve: (LOAD,),
    MESH.press: ([0, 1], [2, 3], np.array([2.0, 3.0])),
    CutMesh(MESH).solve: (LOAD,),
    interval.exact: (1, 5),
    interval.rate: (0, 5),
}


def changed(argument):
    """The argument with each bad number in place of one of its own."""
    if isinstance(argument, float | int):
        yield from BAD
    elif isinstance(argument, np.ndarray):
        for bad in BAD:
            new = argument.astype(float)
            new.flat[new.size // 2] = bad
            yield new
    elif isinstance(argument, list):
        for place, row in enumerate(argument):
            for at in range(len(row)) if isinstance(row, tuple) else ():
                for bad in BAD:
                    yield [*argument[:place], (*row[:at], bad, *row[at + 1 :]), *argument[place + 1 :]]


def whole(found):
    """Whether every number of a result is finite."""
    if isinstance(found, np.ndarray | float | np.number):
        return bool(np.isfinite(found).all()) if np.asarray(found).dtype.kind in "fc" else True
    if dataclasses.is_dataclass(found):
        found = [getattr(found, field.name) for field in dataclasses.fields(found)]
    if isinstance(found, dict):
        found = list(found.values())
    return all(map(whole, found)) if isinstance(found, tuple | list) else True


def called(function, given):
    """The result of ``function`` with fresh random numbers, without a warning."""
    with warnings.catch_warnings(action="error"):
        return function(*(each() if each is rng else each for each in given))


@pytest.mark.parametrize("function", CALLS, ids=lambda function: getattr(function, "__qualname__", "?"))
def test_a_number_is_refused_or_gives_numbers(function):
    given = CALLS[function]
    assert whole(called(function, given))
    for place, argument in enumerate(given):
        for bad in changed(argument):
            try:
                found = called(function, (*given[:place], bad, *given[place + 1 :]))
            except ValueError as problem:
                assert str(problem).strip() and "\n" not in str(problem)
            except TypeError:
                assert isinstance(argument, int), (place, bad)  # a count that is no whole number
            else:
                assert whole(found), (place, bad)


def test_the_least_beyond_the_largest_is_refused_and_the_largest_is_not():
    assert 0 <= rubber.rest_volts(1e12) < 1e-6 and rubber.rest_volts(0.0) == 5.0
    for force_n in (np.nextafter(1e12, 2e12), 1e300, np.inf, np.nan, -1e13):
        with pytest.raises(ValueError, match=r"force_n = .* must be a number of at most 1e"):
            rubber.rest_volts(force_n)
        with pytest.raises(ValueError, match="the largest of force_n = "):
            rubber.rest_volts(np.array([1.0, force_n, 2.0]))
        with pytest.raises(ValueError, match="force_n"):
            rubber.volts(force_n=force_n)


@pytest.mark.parametrize("bad", [np.inf, np.nan, 1e300, 2.5, -1e300])
def test_the_public_interface_refuses_it(bad):
    zeros = np.zeros((2, 3), dtype=int)
    array = meissner.Array(meissner.Calibration(zeros, zeros + 1, 4, zeros > 0, 1e-3))
    mesh = meissner.Cop4Config(MESH, adc.Adc(16, -5.0, 5.0), 0.3)
    four = meissner.Cop4(mesh)
    for one, shape in (
        (meissner.Slip(), (64,)),
        (meissner.Cop(), (1, 2, 3)),
        (array, (1, 2, 3)),
        (four, (5, 4)),
    ):
        x = np.zeros(shape)
        x.flat[3] = bad
        for call in (one.process, one.next):
            with pytest.raises(ValueError):
                call(x)
    for key in ("threshold", "hold", "window", "level"):
        with pytest.raises((ValueError, TypeError)):
            meissner.Slip(SlipConfig(**{key: bad})).process(np.zeros(64, dtype=int))
    for key in ("gain", "load_lsb_n", "min_load_n"):
        with pytest.raises(ValueError):
            dataclasses.replace(mesh, **{key: bad if bad != 2.5 else -1.0}).registers  # noqa: B018
    for key in ("offset", "gain", "force_lsb_n"):
        wrong = {key: np.full((2, 3), bad) if key != "force_lsb_n" else bad}
        if wrong != {"force_lsb_n": 2.5} and wrong != {"force_lsb_n": 1e300}:
            with pytest.raises(ValueError):
                dataclasses.replace(array.calibration, **wrong)


def test_numbers_are_checked_once_at_the_outermost_call(monkeypatch):
    """volts calls rest_volts, which calls conductance. After a refusal, after an error within a call, and in
    another thread, calls are checked again."""
    seen, check = [], arrays.check_finite
    monkeypatch.setattr(arrays, "check_finite", lambda name, value: seen.append(name) or check(name, value))
    fails = arrays.finite(lambda value: {}[value])
    for _ in range(2):
        with pytest.raises(KeyError):
            fails(3.0)
        rubber.volts(2.0, 0.5, 0.01)
        assert [seen.pop(0), *seen] == ["value", "force_n", "level", "share"]
        with pytest.raises(ValueError, match="force_n"):
            rubber.rest_volts(np.inf)
        assert seen[3:] == ["force_n"]
        seen.clear()
    monkeypatch.undo()

    @arrays.finite
    def elsewhere(value):
        with ThreadPoolExecutor(1) as pool:
            return pool.submit(rubber.rest_volts, np.inf).result()

    with pytest.raises(ValueError, match="force_n"):
        elsewhere(0.0)
