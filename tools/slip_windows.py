"""Speed and accuracy of the kinds of window: onset-to-flag delay of the slip scenes, as Markdown.

Every condition and seed of the scenes with a slip, and of normal_force for false alarms, on the fixed
engine. ``make fmax`` measures the clocks, memory and Fmax of each kind.
"""

from dataclasses import replace

import numpy as np
from msgspec import structs

from meissner import scenes
from meissner.engines import fixed
from meissner.scenes.rubber.judge import judge


def main():
    print("| window | hop | level | missed | false alarms | delay: median | mean | 95 % | largest, ms |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    recordings = []
    for name in ("slip_forces", "slip_materials", "normal_force"):
        scene = scenes.load(name)
        for condition in scene.conditions:
            recordings += [scenes.simulate(scene, condition, seed) for seed in range(1, 1 + scene.seeds)]
    for window, hop, level in ((64, 64, 1), (64, 32, 1), (64, 2, 1), (32, 2, 1), (16, 2, 1), (64, 4, 2)):
        verdicts = []
        for recording in recordings:
            slip = structs.replace(recording.scene.slip, window=window, hop=hop, level=level)
            config = replace(recording.scene, slip=slip).slip_config()
            watched = fixed.watch(recording.codes[None], config)
            verdicts.append(judge(recording, watched.state[0], config))
        delays = np.array([v["delay_s"] for v in verdicts if v["delay_s"] is not None]) * 1e3
        missed, alarms = (sum(v[key] for v in verdicts) for key in ("missed", "false_alarms"))
        figures = (np.median(delays), delays.mean(), np.percentile(delays, 95), delays.max())
        print(
            f"| {window} | {hop} | {level} | {missed} | {alarms} | "
            + " | ".join(f"{figure:.1f}" for figure in figures)
            + " |"
        )
    print(f"\n{len(recordings)} runs, {sum(r.onset_s is not None for r in recordings)} of them with a slip.")


if __name__ == "__main__":
    main()
