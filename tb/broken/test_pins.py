"""Each metric at the converter's pins changes when the RTL between the pins and the decision is broken on
purpose.

Space: periods a clock too long, periods and words that depend on the previous sample, words a clock late.
Each fault needs a build of its own, so the test is in ``make test-long``.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from meissner import scenes
from meissner.builds import toolchain
from meissner.engines import rtl_slip

FRAMES = 257
PERIOD = 400  # in clocks: 4 MHz, 10 kHz
PERIODS = ("msn_adc_spi", "tick ? cfg_period_i - 1'b1 :")
WORDS = ("msn_spi_shift", "(start_i || half_end) ? HalfBits'(Half - 1) :")
METRICS = ("frames", "clocks", "convert_jitter_clocks", "decision_clocks", "decision_jitter_clocks")
# The broken place and its new text, and the metrics that differ from the sound core's, by how much.
FAULTS = {
    "periods a clock too long": (PERIODS, "tick ? cfg_period_i :", {"clocks": FRAMES}),
    "periods by the sample": (
        PERIODS,
        "tick ? cfg_period_i - 1'b1 - PeriodBits'(out_data_o[0]) :",
        {"clocks": -(FRAMES // 2), "convert_jitter_clocks": 1},
    ),
    "words a clock late": (WORDS, f"start_i ? HalfBits'(Half) : {WORDS[1]}", {"decision_clocks": 1}),
    "words by the sample": (
        WORDS,
        f"start_i ? HalfBits'(Half - 1) + HalfBits'(shift_q[0]) : {WORDS[1]}",
        {"decision_clocks": 1, "decision_jitter_clocks": 1},
    ),
}


def facts():
    """Metrics at the pins of acrylic_slip's converter, with two even codes and two odd codes alternating."""
    scene = scenes.load("acrylic_slip")
    codes = np.arange(FRAMES) // 2 % 2 + 1000
    recording = SimpleNamespace(scene=scene, codes=codes, moving=np.zeros(FRAMES, dtype=bool))
    found = rtl_slip.watch_pins(recording, scene.slip_config()).facts
    assert found["decision_us"] == found["decision_clocks"] / 4
    return {key: found[key] for key in METRICS}


@pytest.mark.long
def test_as_it_is_every_period_is_the_same():
    found = facts()
    assert found["frames"] == FRAMES and found["clocks"] == FRAMES * PERIOD
    assert found["convert_jitter_clocks"] == found["decision_jitter_clocks"] == 0


@pytest.mark.long
@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_changes_its_own_metric_only(tmp_path, monkeypatch, fault):
    (module, text), broken, turned = FAULTS[fault]
    sound, sources_of = facts(), toolchain.sources_of
    [path] = [path for path in toolchain.sources() if path.stem == module]
    source = path.read_text("utf-8")
    assert source.count(text) == 1
    other = tmp_path / path.name
    other.write_text(source.replace(text, broken))
    monkeypatch.setattr(
        toolchain, "sources_of", lambda top: [other if each == path else each for each in sources_of(top)]
    )
    found = facts()
    assert {key: found[key] - sound[key] for key in METRICS if found[key] != sound[key]} == turned
