"""``meissner threshold``: the rate of false alarms it promises holds on fresh noise of known tails; what is
too short, moves or slips is refused; its TOML lines are what the core compares with."""

import tomllib
from fractions import Fraction

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import genextreme, poisson

from cli.test_cli import meissner
from meissner import threshold
from meissner.builds import config
from meissner.twins.slip.config import SlipConfig


def p2p(rng, count, tail):
    """Integer peak to peaks [count] of windows of independent noise with a known tail."""
    if tail == "normal":  # of 32 details each, as of a window of 64
        return np.ptp(np.rint(rng.normal(0, 4, (count, 32))), axis=1).astype(int)
    if tail == "coarse":  # noise of a third of a code: few values
        return np.ptp(np.rint(rng.normal(0.1, 0.34, (count, 32))), axis=1).astype(int)
    if tail == "exponential":
        return np.floor(20 + rng.exponential(5, count)).astype(int)
    if tail == "heavy":  # Pareto of shape 0.2
        return np.floor(10 + 8 * (rng.random(count) ** -0.2 - 1) / 0.2).astype(int)
    assert tail == "memory"  # an autoregressive loudness, over some forty windows
    loud, state = np.empty(count), 0.0
    for k, step in enumerate(rng.normal(0, 0.06, count)):
        state = 0.975 * state + step
        loud[k] = state
    return np.floor(20 * np.exp(loud) + rng.exponential(3, count)).astype(int)


WINDOW_S = 0.0064
TAILS = ("normal", "coarse", "exponential", "heavy", "memory")


def missed(tail, seeds):
    """Of quiet holds of 64 s at 60 alarms an hour, one per hold: how many promise less, and more, than 64
    minutes of fresh noise have. A count scatters, too: only one that no rate of the interval gives counts."""
    above = below = refused = 0
    for seed in seeds:
        rng = np.random.default_rng(seed)
        try:
            law = threshold.fit(p2p(rng, 10_000, tail), WINDOW_S)
        except ValueError:  # a loudness that happens to drift is no quiet hold
            refused += 1
            continue
        found = threshold.smallest(law, 60.0, 1 << 20)
        low, high = law.interval(found)
        assert low <= law.rate(found) <= high <= 60 * 1.002
        fresh = p2p(rng, 600_000, tail)
        size = round(law.block_s / WINDOW_S)
        blocks = fresh[: len(fresh) // size * size].reshape(-1, size).max(axis=1)
        count, hours = (blocks > found).sum(), len(blocks) * law.block_s / 3600
        above += poisson.sf(count - 1, high * hours) < 0.025
        below += poisson.cdf(count, low * hours) < 0.025
    return above, below, refused


@pytest.mark.parametrize("tail", TAILS)
def test_the_promise_holds_on_fresh_noise(tail):
    assert missed(tail, range(2)) == (0, 0, 0)


@pytest.mark.long
@pytest.mark.parametrize("tail", TAILS)
def test_the_promise_holds_as_often_as_it_says(tail):
    """95 % may leave out one of 40 at each end; five or more are as likely as 1 in 300."""
    above, below, refused = missed(tail, range(40))
    assert above <= 4 and below <= 4 and refused <= 4 * (tail == "memory")


def test_the_law_is_that_of_another_library():
    """Blocks drawn from SciPy's extreme-value distribution, fine against their spread: its parameters, the
    rate by its survival function, and an interval that holds the true one."""
    inside = 0
    for seed in range(5):
        rng = np.random.default_rng(seed)
        blocks = genextreme.rvs(-0.1, 3000, 400, size=400, random_state=rng)
        largest = np.zeros((400, threshold.LEAST_WINDOWS))
        largest[:, 3] = np.floor(blocks)
        law = threshold.fit(largest.ravel(), 0.01)
        assert (law.blocks, law.block_s) == (400, 0.2)
        location, log_scale, shape = law.best
        fitted = genextreme.fit(np.floor(blocks) + 0.5, -0.1, loc=3000, scale=400)
        assert (shape, location) == (
            pytest.approx(-fitted[0], abs=0.01),
            pytest.approx(fitted[1] - 0.5, rel=2e-3),
        )
        assert np.exp(log_scale) == pytest.approx(fitted[2], rel=0.01)
        assert law.rate(7000) == pytest.approx(
            18000 * genextreme.sf(7000.5, -shape, location, np.exp(log_scale))
        )
        low, high = law.interval(7000)
        inside += low <= 18000 * genextreme.sf(7001, -0.1, 3000, 400) <= high
    assert inside >= 4


def test_the_interval_is_that_of_the_likelihood():
    """Inside, at and beyond what was seen: where the greatest likelihood, by SciPy's distribution and search,
    is 3.841 / 2 below the best. An end may be 0.1 % outside, which is 0.03 of that."""
    law = threshold.fit(p2p(np.random.default_rng(4), 8000, "exponential"), WINDOW_S)

    def cost(free, at, chance):
        scale, shape = free
        location = at + 0.5 - genextreme.isf(chance, -shape, 0, scale)
        below = lambda x: genextreme.cdf(x, -shape, location, scale)
        with np.errstate(divide="ignore"):
            return -law.counts @ np.log(below(law.values + 0.5) - below(law.values - 0.5))

    for at in (37, 69, 90):
        for end in law.interval(at):
            given = (at, end * law.block_s / 3600)
            start = {"initial_simplex": [[4, -0.1], [5, 0.0], [5, 0.1]], "xatol": 1e-5, "fatol": 1e-5}
            least = minimize(cost, [4, 0], given, method="Nelder-Mead", options=start).fun
            assert 2 * (law.likelihood + least) == pytest.approx(3.841, abs=0.03), (at, end)


def test_noise_with_a_memory_gets_longer_blocks():
    rng = np.random.default_rng(3)
    law = threshold.fit(p2p(rng, 40_000, "memory"), WINDOW_S)
    plain = threshold.fit(p2p(rng, 40_000, "exponential"), WINDOW_S)
    assert plain.block_s == pytest.approx(100 * WINDOW_S) and law.block_s >= 2 * plain.block_s


REFUSED = {
    "short": (lambda rng: p2p(rng, 999, "exponential"), "too short to promise anything: 6.4 s or more"),
    "rate": (lambda rng: p2p(rng, 1200, "exponential"), "too short to promise 1 false alarms an hour: 36 s"),
    "drift": (lambda rng: p2p(rng, 8000, "exponential") + np.arange(8000) // 400, "no quiet hold"),
    "memory": (lambda rng: p2p(rng, 1500, "memory"), "correlated over"),
    "still": (lambda rng: np.zeros(9000, int), "never moves"),
    "one slip": (
        lambda rng: p2p(rng, 9000, "normal") + 700 * (np.arange(9000) == 4000),
        r"no quiet hold: p2p at 25\.600 s is 7\d\d codes",
    ),
    "two kinds": (
        lambda rng: np.where(np.arange(20_000) % 1000 < 500, 20, 90) + p2p(rng, 20_000, "normal"),
        "correlated over|no extreme-value law",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_recording_that_promises_nothing(name):
    make, words = REFUSED[name]
    with pytest.raises(ValueError, match=words):
        threshold.smallest(threshold.fit(make(np.random.default_rng(8)), WINDOW_S), 1.0, 1 << 20)


@pytest.mark.parametrize("lsb", [5 / 4096, 0.001, 10 / 65536, 3.3 / 1024])
@pytest.mark.parametrize("level", [1, 2, 3])
def test_an_amount_is_read_back_as_its_code(lsb, level):
    """floor(amount·sqrt(2)^level / lsb), by its square in exact fractions."""
    for code in (0, 1, 2, 23, 40, 185, 4095):
        text = f"{threshold.amount(code, lsb, level):.15g}"
        square = (Fraction(text) / Fraction(repr(lsb))) ** 2 * 2**level
        assert code**2 <= square < (code + 1) ** 2, (code, text)


BUILD = """about = "one rubber"
[clock]
mhz = 24.0
[sensor]
kind = "channels"
channels = 1
[adc]
part = "MCP3208"
volts = 5.0
rate_hz = 10000.0
[slip]
contact_level_v = 3.0
release_level_v = 3.2
"""


def test_the_command(tmp_path):
    """From two recordings to a configuration with which the quiet one raises no flag and the slip does."""
    rng = np.random.default_rng(2)
    quiet = np.rint(2000 + rng.normal(0, 3, 400_000)).astype(int)
    slips = np.rint(2000 + rng.normal(0, 3, 20_000)).astype(int)
    slips[12_000:] += rng.integers(-90, 91, 8000)
    np.save(tmp_path / "quiet.npy", quiet)
    (tmp_path / "slip.csv").write_text("adc\n" + "\n".join(map(str, slips)))
    (tmp_path / "mine.toml").write_text(BUILD + "threshold_p2p_v = 0.1\ngross_threshold_p2p_v = 0.2\n")
    arguments = ("quiet.npy", "slip.csv", "--config", "mine.toml", "--per-hour", 20, "--out", "t.png")
    done = meissner("threshold", *arguments, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    text = done.stdout
    assert (tmp_path / "t.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert "quiet: 40 s, 6250 windows of 1 channel;" in text and "promised: at most 20" in text
    (tmp_path / "new.toml").write_text(BUILD + text.partition("[slip]\n")[2])
    settings = config.load(tmp_path / "new.toml").slip
    codes = int(text.partition("threshold ")[2].split()[0])
    largest = threshold.windows_of(quiet[None], SlipConfig()).max()
    assert settings.threshold == codes and largest < codes < 2 * largest
    assert settings.keep_threshold < codes < settings.gross_threshold
    assert "the first at 1.20" in text
    for name, state in (("quiet.npy", {0, 1}), ("slip.csv", {0, 1, 2, 3})):
        done = meissner(
            *("process", "slip", name, "--config", "new.toml", "--out", "o.npz", "--overwrite"), cwd=tmp_path
        )
        assert done.returncode == 0, done.stderr
        assert {*np.unique(np.load(tmp_path / "o.npz")["state"])} <= state
    assert {2, 3} & {*np.unique(np.load(tmp_path / "o.npz")["state"])}
    plain = meissner("threshold", "quiet.npy", "--rate", 10000, "--per-hour", 20, "--overwrite", cwd=tmp_path)
    assert f"# slip.threshold = {codes} " in plain.stdout and (tmp_path / "threshold.png").is_file()
    assert tomllib.loads(plain.stdout.partition("#")[2].partition("\n")[2]) == {}
    for more, words in (
        (("--per-hour", 0.1), "too short"),
        (("--rate", 9000), "10000"),
    ):
        done = meissner("threshold", "quiet.npy", "--config", "mine.toml", "--overwrite", *more, cwd=tmp_path)
        assert (done.returncode, done.stdout) == (2, "") and words in done.stderr
