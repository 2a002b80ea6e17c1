"""Disturbances of grip_slip and the sizes at which it fails: the table of docs/slip.md, as Markdown.

    python tools/published/slip_disturb.py [SEEDS]      seeds for each size, 30 by default

The plain condition with one disturbance of one size, on the fixed engine's twins. ``missed``: runs in which
the flag does not rise between the first event and the slip; ``false alarms``: rises before the first event;
``wrong``: runs with either. ``least lead``: from the flag to the slip.
"""

import sys
from dataclasses import replace

from msgspec import structs

from meissner import scenes
from meissner.engines import fixed
from meissner.scenes.rubber.judge import judge

SIZES = {
    "hum_v": (0.1, 0.2, 0.3, 0.4, 0.5),
    "flicker": (0.001, 0.002, 0.003, 0.004),
    "hysteresis": (0.1, 0.3, 0.5),
    "burst": (5.0, 20.0, 50.0),
}


def measure(key, size, seeds):
    """(wrong, missed, false alarms, least lead in ms or None) of runs 1 to ``seeds``."""
    scene = scenes.load("grip_slip")
    condition, verdicts = structs.replace(scene.conditions[0], **{key: size}), []
    scene = replace(scene, conditions=(condition,))
    config = scene.slip_config()
    for seed in range(1, 1 + seeds):
        recording = scenes.simulate(scene, condition, seed)
        state = fixed.watch(recording.codes[None], config).state[0]
        verdicts.append(judge(recording, state, config))
    leads = [one["lead_s"] for one in verdicts if one["lead_s"] is not None]
    wrong = sum(bool(one["missed"] or one["false_alarms"]) for one in verdicts)
    missed, alarms = (sum(one[name] for one in verdicts) for name in ("missed", "false_alarms"))
    return wrong, missed, alarms, 1e3 * min(leads) if leads else None


def main():
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else 30
    print("| key | size | wrong | missed | false alarms | least lead, ms |")
    print("|" + " --- |" * 6)
    for key, sizes in SIZES.items():
        for size in sizes:
            wrong, missed, alarms, lead_ms = measure(key, size, seeds)
            least = "–" if lead_ms is None else f"{lead_ms:.0f}"
            print(f"| `{key}` | {size:g} | {wrong} | {missed} | {alarms} | {least} |", flush=True)


if __name__ == "__main__":
    main()
