"""msn_cop4 against its model, the model against Python's fractions, the published formula and the mesh: all
zero, full scale of every sign, one LSB of current, D and N zero and negative, saturation of every result,
random codes; each fault at and just below its threshold; registers of real meshes and at their limits; wide
and narrow samples; gaps, stalls short and long, a reset in mid-flight, exact clocks."""

import random
from dataclasses import asdict, replace
from fractions import Fraction
from itertools import product

import cocotb
import numpy as np
import pytest

import bench
from meissner.physics.adc import Adc
from meissner.physics.cop4_registers import cop4_registers, correct_registers, scaled
from meissner.physics.mesh import Mesh, correction
from meissner.physics.mesh_loads import true_centre
from meissner.twins.common.divide import steps
from meissner.twins.cop.cop4 import Cop4Registers, cop4
from meissner.twins.cop.cop4_correct import CorrectionRegisters
from reference import exact

FIELDS = ["x~", "y~", "load", "pressed", "over", "saturated", "imbalance", "open"]
ADC = Adc(bits=16, low_v=-10.0, high_v=10.0)
GAIN = 0.6  # +-15 V into +-10 V, with margin


def register_sets(bits):
    """Registers: one set that opens every gate, those of a mesh, one with every register at its upper
    limit."""
    half = 1 << bits - 1
    wide = Cop4Registers(
        half + half // 2, 131071, 7, 70000, 15, 100000, 12, half - 1, half - 1, -half, 4 * half - 1, 1
    )
    narrow = replace(wide, kx=3, shift_x=0, shift_y=3, kf=131071, shift_load=0, imbalance=half // 8)
    narrow = replace(narrow, idle=-half // 2)
    sensor = replace(
        wide, idle=half // 2 + half // 4 - 8, busy=half // 2, imbalance=4, top=half - 2, min_load=90
    )
    zero = Cop4Registers(*[0] * 12)
    ends = Cop4Registers(
        2 * half - 1, 131071, 15, 131071, 15, 131071, 15, half - 1, half - 1, half - 1, 0, 65535
    )
    return [wide, narrow, sensor, zero, ends]


def around(rng, registers, bits, count):
    """Samples [n, 4]: every corner, rest, hardly any current, faults of each kind, loads, random codes."""
    low, high = bench.width(bits)
    rows = [*product((low, high), repeat=4), (0, 0, 0, 0)]
    v = registers.rail // 2
    rest = np.array([v, -v, v, -v])
    steps_away = [s * np.eye(4, dtype=int)[i] for i in range(4) for s in (-3, -2, -1, 0, 1, 2, 3)]
    rows += [rest + away for away in steps_away]
    rows += [rest - np.array([a, 0, 0, 0]) for a in range(20)] + [(0, 0, a, a) for a in range(-2, 3)]
    level = registers.top
    rows += [
        np.insert(np.array([5, -5, 5]), i, e)
        for i in range(4)
        for e in (level - 1, level, -level, -level - 1)
    ]
    for e, i in product((-2, -1, 0, 1, 2), range(4)):
        for own, partner in (
            (registers.idle + e, registers.busy - 1),
            (registers.idle + 1, registers.busy + e),
        ):
            row = np.array([1, -1, 1, -1]) * (registers.busy - 4)
            row[i], row[(i + 2) % 4] = own, partner
            if i % 2:
                row[[i, (i + 2) % 4]] = -1 - row[[i, (i + 2) % 4]]
            rows.append(row)
    half = registers.imbalance // 2
    rows += [rest // 2 + np.array([half + a, half, b, 0]) for a in (-2, -1, 0, 1, 2) for b in (0, 1)]
    rows += [rest // 2 - np.array([half + a, half, b, 0]) for a in (-2, -1, 0, 1, 2) for b in (0, 1)]
    for _ in range(count):
        drop = int(rng.integers(1, max(registers.rail // 2, 2) + 1)) >> int(rng.integers(0, bits - 2))
        rows.append(rest + drop * np.array([-1, 1, -1, 1]) + rng.integers(-2, 3, 4))
        rows.append(rng.integers(low, high + 1, 4))
    return np.clip(np.array(rows), low, high)


def beats_of(samples):
    return [dict(zip(("e1", "e2", "e3", "e4"), map(int, sample))) for sample in samples]


def expected_of(samples, registers, bits, fix=None):
    columns = [values.astype(int).tolist() for values in cop4(samples, registers, bits, fix)]
    return [dict(zip((f.rstrip("~") for f in FIELDS), row)) for row in zip(*columns)]


def correction_of(dut, registers, which=0):
    """Correction terms for a core built with Correct, else None: zero, a mesh's, terms so large that the
    denominator becomes negative, terms with every other bit set, and their complement."""
    if not dut.Correct.value:
        return None
    p = [(0,) * 6, (6213, 4021, 5093, 1178, 3489, -1112), (80000, -9000, 9000, 7000, -3, 11)]
    p += [(21845, -21846, 21845, -21846, 9, 9), (-21846, 21845, -21846, 21845, -10, -10)]
    return CorrectionRegisters(p[which], 8 + registers.shift_load)


def ports(registers, fix=None):
    p = (0,) * 6 if fix is None else fix.p
    packed = sum((value & 0x3FFFF) << 18 * index for index, value in enumerate(p))
    return {f"cfg_{name}_i": value for name, value in asdict(registers).items()} | {"cfg_p_i": packed}


def parameters(dut):
    return dut.SampleBits.value.to_unsigned(), dut.BitsPerClock.value.to_unsigned()


# By bits a clock and Correct: the clocks of the first and of the hundredth result if samples are always
# offered and queue up inside.
BACK_TO_BACK = {(2, 0): (17, 62), (1, 0): (25, 110), (2, 1): (37, 141), (1, 1): (52, 271)}


def latency(dut):
    per_clock = dut.BitsPerClock.value.to_unsigned()
    return steps(16, per_clock) + (20 + steps(14, per_clock) if dut.Correct.value else 8)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.5], which=[0, 1, 2, 3, 4])
async def matches_model(dut, stall_rate, which):
    bits, _ = parameters(dut)
    registers = register_sets(bits)[which]
    fix = correction_of(dut, registers, which)
    samples = around(np.random.default_rng(bench.SEED + which), registers, bits, 60)
    await bench.start(dut, **ports(registers, fix))
    pauses = bench.gaps_and_stalls(stall_rate)
    expected = expected_of(samples, registers, bits, fix)
    assert await bench.stream(dut, beats_of(samples), FIELDS, *pauses, drain=80) == expected


def spells(longest):
    """A stall pattern: stalls of up to ``longest`` clocks, and pauses of up to as many between them."""
    draw, left, stalled = random.Random(bench.SEED), 0, True

    def stall():
        nonlocal left, stalled
        if not left:
            left, stalled = draw.randint(1, longest), not stalled
        left -= 1
        return stalled

    return stall


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def loses_nothing_in_long_stalls(dut):
    """Results are further apart than the stalls of the other tests; these stalls are so long that all stages
    fill."""
    bits, _ = parameters(dut)
    registers = register_sets(bits)[0]
    fix = correction_of(dut, registers, 1)
    samples = around(np.random.default_rng(bench.SEED), registers, bits, 30)[-60:]
    await bench.start(dut, **ports(registers, fix))
    got = await bench.stream(dut, beats_of(samples), FIELDS, None, spells(150), drain=80)
    assert got == expected_of(samples, registers, bits, fix)


@bench.applies(lambda dut: parameters(dut)[0] >= 17)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def matches_model_on_a_mesh(dut):
    bits, _ = parameters(dut)
    adc = Adc(bits=bits - 1, low_v=-10.0, high_v=10.0)
    for mesh in (Mesh(5, 5, 47.0), Mesh(41, 41, 10.0)):
        registers = cop4_registers(mesh, adc, GAIN)
        samples = pressed_samples(mesh, adc, 30)[0]
        fix = None
        if dut.Correct.value:
            registers, fix = correct_registers(fitted(mesh), registers)
        await bench.start(dut, **ports(registers, fix))
        expected = expected_of(samples, registers, bits, fix)
        assert sum(beat["pressed"] for beat in expected) == 30
        assert await bench.stream(dut, beats_of(samples), FIELDS, drain=80) == expected


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def clocks_are_as_stated_whatever_the_numbers(dut):
    bits, per_clock = parameters(dut)
    registers = register_sets(bits)[0]
    beats = beats_of(around(np.random.default_rng(bench.SEED), registers, bits, 20)[:100])
    await bench.start(dut, **ports(registers), out_ready_i=1)
    accepted, seen = [], []
    for clock in range(120 * (steps(16, per_clock) + 1)):
        dut.in_valid_i.value = int(len(accepted) < len(beats))
        for name, value in beats[min(len(accepted), len(beats) - 1)].items():
            getattr(dut, f"in_{name}_i").value = value
        await bench.ReadOnly()
        if dut.in_valid_i.value == 1 and dut.in_ready_o.value == 1:
            accepted.append(clock)
        if dut.out_valid_o.value == 1:
            seen.append(clock)
        await bench.RisingEdge(dut.clk_i)
    assert seen[0] - accepted[0] == latency(dut)
    assert len(seen) == len(beats) and set(np.diff(seen)) == {steps(16, per_clock) + 1}
    waits = [out - taken for taken, out in zip(accepted, seen)]
    assert (waits[0], waits[-1]) == BACK_TO_BACK[per_clock, int(dut.Correct.value)]


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    bits, _ = parameters(dut)
    registers = register_sets(bits)[0]
    fix = correction_of(dut, registers, 1)
    samples = around(np.random.default_rng(bench.SEED), registers, bits, 2)[-4:]
    await bench.start(dut, **ports(registers, fix), in_e1_i=1, in_e2_i=-2, in_e3_i=3, in_e4_i=-4)
    for delay in range(latency(dut) + 2):
        dut.in_valid_i.value = 1
        await bench.clocks(dut, 1)
        dut.in_valid_i.value = 0
        await bench.clocks(dut, delay)
        dut.in_valid_i.value = delay % 2  # a word offered during the reset is discarded too
        await bench.reset(dut)
        expected = expected_of(samples, registers, bits, fix)
        assert await bench.stream(dut, beats_of(samples), FIELDS, drain=80) == expected


@bench.applies(lambda dut: hasattr(dut, "u_load") and hasattr(dut.u_load, "u_divide"))
@cocotb.test(timeout_time=10, timeout_unit="ms")
async def goes_on_after_an_upset_of_a_divider(dut):
    """A quotient lost, one too many or one too early, samples back to back: the last results are right."""
    bits, _ = parameters(dut)
    registers = register_sets(bits)[0]
    fix = correction_of(dut, registers, 1)
    samples = around(np.random.default_rng(bench.SEED), registers, bits, 20)[-45:]
    expected = expected_of(samples, registers, bits, fix)
    await bench.start(dut, **ports(registers, fix))

    async def upset(divider, name, clocks):
        await bench.clocks(dut, clocks)
        register = getattr(divider, name)
        register.value = 1 - bench.read(register)

    dividers = [ratio.u_divide for ratio in (dut.u_x, dut.u_y, dut.u_load)]
    for divider, name, late in product(dividers, ("turn", "out_valid_o"), range(0, 20, 3)):
        await bench.reset(dut)
        cocotb.start_soon(upset(divider, name, 150 + late))
        got = await bench.stream(dut, beats_of(samples), FIELDS, drain=150)
        assert got[-20:] == expected[-20:], (divider._path, name, late)


# The block holds several samples.
EVIDENCE = {
    "equivalence": {"boxes": True},
    "faults": {"settle": 14, "more": [{"Correct": 1}]},
}


@pytest.mark.parametrize("bits, per_clock, correct", [(17, 2, 0), (9, 1, 0), (17, 2, 1), (12, 1, 1)])
def test_cop4(bits, per_clock, correct):
    bench.run("cop", "cop4", {"SampleBits": bits, "BitsPerClock": per_clock, "Correct": correct})


@pytest.mark.parametrize("correct", [0, 1])
def test_goes_on_after_an_upset(correct):
    size = {"SampleBits": 12, "BitsPerClock": 2 - correct, "Correct": correct}
    bench.run("cop", "cop4", size, "goes_on", inside=("msn_divide", "msn_divide.turn"))


@pytest.mark.parametrize("bits", [4, 9, 17, 24])
@pytest.mark.parametrize("which", range(5))
def test_model_against_fractions(bits, which):
    r = register_sets(bits)[which]
    samples = around(np.random.default_rng(3), r, bits, 300)
    raised = set()
    for (e1, e2, e3, e4), got in zip(samples.tolist(), expected_of(samples, r, bits)):
        n, m, d = r.rail - e1 - e3, r.rail + e2 + e4, e1 + e3 - e2 - e4
        x = exact.held(Fraction(r.kx * (e1 - e3), n << r.shift_x), -1, 1) if n > 0 else Fraction(0)
        y = exact.held(Fraction(r.ky * (e2 - e4), m << r.shift_y), -1, 1) if m > 0 else Fraction(0)
        load = Fraction(r.kf * min(n, r.rail), d << 8 + r.shift_load) if d > 0 else Fraction(int(r.kf > 0))
        load = exact.away(exact.held(load, -1, 1) * 65536) if n > 0 else 0
        pairs = [(e1, e3), (-1 - e2, -1 - e4), (e3, e1), (-1 - e4, -1 - e2)]
        wanted = {
            "load": min(load, 65535),
            "over": int(load > 65535),
            "saturated": int(any(e >= r.top or e < -r.top for e in (e1, e2, e3, e4))),
            "imbalance": int(abs(n - m) > r.imbalance),
            "open": sum(1 << i for i, (e, p) in enumerate(pairs) if e >= r.idle and p <= r.busy),
        }
        raised |= {(name, wanted[name]) for name in ("over", "saturated", "imbalance")}
        fault = wanted["saturated"] or wanted["imbalance"] or wanted["open"]
        pressed = int(load >= max(1, r.min_load) and not fault)
        wanted |= {
            "x": exact.away(x * 16384) * pressed,
            "y": exact.away(y * 16384) * pressed,
            "pressed": pressed,
        }
        assert got == wanted, (e1, e2, e3, e4)
    if which == 2:
        assert len(raised) == 6, "a flag was never, or always, raised"


def pressed_samples(mesh, adc, count, seed=5):
    """Codes [count, 4] of one to three contacts on ``mesh``, 0.2 to 15 N together, and the mesh's
    solution."""
    rng = np.random.default_rng(seed)
    load = np.zeros((count, mesh.m, mesh.n))
    for scene, total in zip(load, rng.uniform(0.2, 15, count)):
        for _ in range(int(rng.integers(1, 4))):
            scene[rng.integers(mesh.m), rng.integers(mesh.n)] += total / 3
    answer = mesh.solve(load)
    volts = np.stack([answer.E1, answer.E2, answer.E3, answer.E4], axis=1)
    return adc.convert(GAIN * volts)[0], answer


@pytest.mark.parametrize("bits", [12, 16, 20, 23])
@pytest.mark.parametrize("mesh", [Mesh(5, 5, 47.0), Mesh(41, 41, 10.0), Mesh(3, 7, 150.0, R0=4.7e3)])
def test_model_against_the_published_formula(mesh, bits):
    """On the same codes within the stated bounds; against the mesh itself within the converter's steps."""
    adc = Adc(bits=bits, low_v=-10.0, high_v=10.0)
    registers = cop4_registers(mesh, adc, GAIN, sample_bits=24)
    codes, answer = pressed_samples(mesh, adc, 400)
    got = cop4(codes, registers, 24)
    assert got.pressed.all()
    e1, e2, e3, e4 = (codes * adc.lsb_v / GAIN).T
    n, m = 2 * mesh.V0 - e1 - e3, 2 * mesh.V0 + e2 + e4
    x = np.clip(mesh.Cx * (e1 - e3) / n, -1, 1)
    y = np.clip(mesh.Cy * (e2 - e4) / m, -1, 1)
    load = mesh.Kf * n / (e1 + e3 - e2 - e4) / 1e-3
    n_codes, m_codes = n * GAIN / adc.lsb_v, m * GAIN / adc.lsb_v
    assert (abs(got.x - 16384 * x) <= 0.5 + abs(x) * (1 / 8 + 8192 / (n_codes - 1)) + 1e-6).all()
    assert (abs(got.y - 16384 * y) <= 0.5 + abs(y) * (1 / 8 + 8192 / (m_codes - 1)) + 1e-6).all()
    assert (abs(got.load - load) <= 0.5 + load * (0.5 / registers.kf + 0.5 / (n_codes - 1)) + 1e-6).all()
    # One code is Cx / N of position: the converter's bits and the gain decide the resolution.
    grain = 1.1 * mesh.Cx / n_codes + 2 / n_codes + 1e-3
    assert (abs(got.x / 16384 - answer.x) <= grain).all()
    d_codes = (e1 + e3 - e2 - e4) * GAIN / adc.lsb_v
    assert (abs(got.load * 1e-3 - answer.load) <= answer.load * (2 / n_codes + 3 / d_codes) + 2e-3).all()


@pytest.mark.parametrize("mesh", [Mesh(5, 5, 47.0), Mesh(41, 41, 10.0), Mesh(1, 6, 10.0)])
def test_registers_of_a_mesh_tell_faults_from_loads(mesh):
    """No load raises a fault; a broken wire, a sagging rail and a clipped code each raise their own."""
    registers = cop4_registers(mesh, ADC, GAIN)
    codes, _ = pressed_samples(mesh, ADC, 300)
    sound = cop4(codes, registers)
    assert sound.pressed.all() and not sound.open.any()
    assert not cop4(np.array([[1, -1, 1, -1]]) * (registers.rail // 2), registers).pressed.any()
    for electrode in range(4):
        torn = codes.copy()  # this wire carries no current, its partner carries all of it
        sign = 1 if electrode % 2 == 0 else -1
        partner = (electrode + 2) % 4
        torn[:, partner] += torn[:, electrode] - sign * (registers.rail // 2)
        torn[:, electrode] = sign * (registers.rail // 2)
        torn = torn[(np.abs(torn) < registers.top).all(axis=1)]
        got = cop4(torn, registers)
        assert len(torn) > 100 and (got.open == 1 << electrode).all() and not got.pressed.any()
        clipped = codes.copy()
        clipped[:, electrode] = sign * registers.top - (sign < 0)
        assert cop4(clipped, registers).saturated.all()
    sagging = codes + np.array([registers.imbalance + 4, 0, 0, 0])
    assert cop4(sagging, registers).imbalance.all()
    assert not cop4(codes + np.array([registers.imbalance - 4, 0, 0, 0]), registers).imbalance.any()


def single_presses(mesh, count, seed):
    """One contact each, 1 to 20 N, anywhere: loads [count, m, n]."""
    rng = np.random.default_rng(seed)
    load = np.zeros((count, mesh.m, mesh.n))
    load[np.arange(count), rng.integers(mesh.m, size=count), rng.integers(mesh.n, size=count)] = rng.uniform(
        1, 20, count
    )
    return load


def fitted(mesh):
    return correction.fit(mesh, single_presses(mesh, 500, 8))


@pytest.mark.parametrize("r", [10.0, 47.0, 150.0])
def test_correction_on_a_mesh(r):
    """The corrected load is within 0.1 % of the float correction's and much closer to the true load."""
    mesh = Mesh(41, 41, r)
    adc = Adc(bits=23, low_v=-10.0, high_v=10.0)  # so fine that only errors of the arithmetic show
    fix = fitted(mesh)
    registers, terms = correct_registers(fix, cop4_registers(mesh, adc, GAIN, sample_bits=24))
    load = single_presses(mesh, 300, 9)
    answer = mesh.solve(load)
    volts = np.stack([answer.E1, answer.E2, answer.E3, answer.E4], axis=1)
    codes = adc.convert(GAIN * volts)[0]
    plain, fixed = cop4(codes, registers, 24), cop4(codes, registers, 24, terms)
    wanted = fix.apply(answer.x, answer.y, answer.load)[2]
    assert fixed.pressed.all()
    assert np.abs(fixed.load * 1e-3 / wanted - 1).max() < 1.5e-3
    before, after = (np.abs(f.load * 1e-3 / true_centre(load)[0] - 1).mean() for f in (plain, fixed))
    assert after < 0.05 * before


def test_refuses_a_correction_at_another_shift():
    registers = register_sets(17)[0]
    with pytest.raises(ValueError, match="shift, 19"):
        cop4(np.zeros((1, 4)), registers, 17, CorrectionRegisters((0,) * 6, 19))


def test_registers_at_known_values():
    found = cop4_registers(Mesh(41, 41, 10.0), ADC, GAIN)
    assert found.kx == round(found.kx / 2**found.shift_x * 2**found.shift_x) and found.kx >= 1 << 16
    assert found.kx / 2**found.shift_x == pytest.approx(2051.05, rel=2**-17)
    assert found.kf / 2 ** (8 + found.shift_load) * 65.536 == pytest.approx(0.864, rel=2**-16)
    assert found.rail == round(30 * 0.6 / ADC.lsb_v)
    assert cop4_registers(Mesh(4, 1, 10.0), ADC, GAIN).kx == 0


def test_refuses_illegal_parameters():
    assert "SampleBits = 3" in bench.refuses("cop4", {"SampleBits": 3})
    assert "SampleBits = 25" in bench.refuses("cop4", {"SampleBits": 25})
    registers = register_sets(17)[0]
    for bits in (3, 25):
        with pytest.raises(ValueError, match=f"sample_bits = {bits}"):
            cop4(np.zeros((1, 4)), registers, bits)
    for bits, code in ((17, 1 << 16), (17, -(1 << 16) - 1), (9, 256)):
        with pytest.raises(ValueError, match=f"code {code} lies outside"):
            cop4(np.array([[0, 0, 0, 0], [0, code, 0, 0]]), register_sets(bits)[0], bits)
    with pytest.raises(ValueError, match=r"shape \[samples, 4\], not \(4,\)"):
        cop4(np.zeros(4, dtype=int), registers)
    for name, value in (
        ("kx", 1 << 17),
        ("shift_load", 16),
        ("rail", 1 << 17),
        ("top", -1),
        ("min_load", 65536),
    ):
        with pytest.raises(ValueError, match=f"{name} = {value}"):
            cop4(np.zeros((1, 4)), replace(registers, **{name: value}))


def test_refuses_registers_that_do_not_exist():
    mesh = Mesh(5, 5, 47.0)
    for message, change in (
        ("leaves no room", {"gain": 0.7}),
        ("too large", {"load_lsb": 1e-9}),
        ("too small", {"load_lsb": 1e6}),
        ("imbalance = ", {"imbalance": 10}),
    ):
        with pytest.raises(ValueError, match=message):
            cop4_registers(mesh, ADC, **({"gain": GAIN} | change))
    with pytest.raises(ValueError, match="symmetric"):
        cop4_registers(mesh, Adc(bits=12, low_v=0.0, high_v=5.0), 0.1)
    with pytest.raises(ValueError, match=r"Cx = .* too large"):
        cop4_registers(Mesh(1024, 2, 0.1), ADC, GAIN)
    assert scaled(0.0, 0, "") == (0, 15)
