"""How keep threshold and hold affect the slip flag while an object slides: docs/slip.md's table, as Markdown.

    python tools/published/slip_keep.py [SEEDS]      seeds for each condition, 20 by default

Every condition and seed of the scenes with a slip, on the fixed engine's twins, by the keep threshold (as a
share of the threshold) and the hold. ``contact while sliding``: the share of the time from the slip of the
whole contact to the end of the run in which the state is neither incipient nor gross, over all runs and for
the worst condition. ``release``: the sliding stops at the end of the run and the rubber stays as it then is,
with the converter's noise; the time from the stop to the fall of the flag, over the runs that end with the
flag up. False alarms include those of normal_force.
"""

import sys
from dataclasses import replace

import numpy as np

from meissner import scenes
from meissner.scenes.rubber.judge import judge, slipping
from meissner.twins.slip.haar import haar
from meissner.twins.slip.peak_to_peak import PeakToPeak
from meissner.twins.slip.slip import Slip

SCENES = ("acrylic_slip", "slip_forces", "slip_materials", "normal_force")
SHARES = (1.0, 0.75, 0.5, 0.25)
HOLDS_S = (0.05, 0.1, 0.15, 0.2, 0.5, 1.0)
REST_S = 1.2
END_S = 0.02  # last part of the run; the rubber then rests at its median voltage


class Run:
    """One recording followed by a rest, processed up to the peak-to-peak values."""

    def __init__(self, recording):
        self.recording, self.config = recording, recording.scene.slip_config()
        rate_hz, adc = recording.scene.rate_hz, recording.scene.adc
        at_rest = np.full(round(REST_S * rate_hz), np.median(recording.volts[-round(END_S * rate_hz) :]))
        rest, _ = adc.convert(at_rest, np.random.default_rng([recording.seed, 1]))
        group = 1 << self.config.level
        self.details = len(recording.codes) // group  # of the recording, before the rest
        self.detail_s = group / rate_hz
        codes = np.concatenate([recording.codes[: self.details * group], rest])[None]
        detail, self.total = haar(codes, self.config.level)
        span, hop = self.config.window // group, self.config.hop // group
        self.p2p, _ = PeakToPeak(1, span, hop).process(detail)

    def measure(self, share, hold_s):
        """(verdict, seconds from the stop to the fall of the flag, or None if it is not up)."""
        config = replace(
            self.config,
            keep_threshold=int(self.config.threshold * share),
            hold=round(hold_s / self.detail_s),
        )
        state = Slip(1, config).process(self.p2p, self.total)[0]
        verdict = judge(self.recording, state[: self.details], config)
        if not slipping(state[self.details - 1]):
            return verdict, None
        rest = slipping(state[self.details :])
        return verdict, (len(rest) if rest.all() else int(np.argmin(rest))) * self.detail_s


def runs(seeds):
    """{(scene, condition): [Run, ...]}."""
    found = {}
    for name in SCENES:
        scene = scenes.load(name)
        for condition in scene.conditions:
            numbers = range(1, 1 + seeds)
            recordings = [scenes.simulate(scene, condition, seed) for seed in numbers]
            found[name, condition.name] = [Run(recording) for recording in recordings]
    return found


def row(found, share, hold_s):
    """One line of the table."""
    shares, releases, missed, alarms = {}, [], 0, 0
    slid = contact = 0.0
    for key, of in found.items():
        measured = [run.measure(share, hold_s) for run in of]
        missed += sum(verdict["missed"] for verdict, _ in measured)
        alarms += sum(verdict["false_alarms"] for verdict, _ in measured)
        sliding = [verdict for verdict, _ in measured if verdict["gross_s"] is not None]
        if sliding:
            whole = sum(verdict["sliding_s"] for verdict in sliding)
            without = sum(verdict["sliding_s"] * verdict["contact_share_of_sliding"] for verdict in sliding)
            shares[key], slid, contact = without / whole, slid + whole, contact + without
            releases += [release * 1e3 for _, release in measured if release is not None]
    figures = (100 * contact / slid, 100 * max(shares.values()), np.median(releases), max(releases))
    return (
        f"| {share:g} | {hold_s * 1e3:g} | {figures[0]:.2f} % | {figures[1]:.1f} % | {figures[2]:.0f} | "
        f"{figures[3]:.0f} | {missed} | {alarms} |"
    )


def main():
    found = runs(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
    print(
        "| keep / threshold | hold, ms | contact while sliding | worst condition | release: median "
        "| largest, ms | missed | false alarms |"
    )
    print("|" + " --- |" * 8)
    for share in SHARES:
        for hold_s in HOLDS_S:
            print(row(found, share, hold_s), flush=True)


if __name__ == "__main__":
    main()
