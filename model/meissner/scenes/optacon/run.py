"""Running a scene of pins under a finger: the display on an engine, the pins by physics, judged by kind."""

from functools import partial

import numpy as np

from meissner import scenes
from meissner.report.words import fact
from meissner.scenes.optacon.judge import KINDS
from meissner.scenes.optacon.scene import QUIET_S, step_s
from meissner.scenes.results import Result, head, numbered, table
from meissner.scenes.timed import TimedEngine

TABLES = {"Results": "conditions"}
WAVES = False
SHOWN = {
    "draw_free": "peak of the free pin at 30 V over the frequency, from above and from below (figure 6)",
    "draw_channels": "pins under a finger at each voltage, with each channel's threshold (figures 8 to 11)",
    "draw_thresholds": "thresholds for the large contactor, and FA-II's for the smallest (figure 1)",
    "draw_burst": "a pin under a finger, on and off in turn (figure 14)",
    "animate": "the letter crosses the displays: pins driven, and those at which each channel responds",
    "draw_steps": "the letter on the pins, step by step (figure 13)",
    "draw_touch": "the object on the pad and on the pins, where SA-I responds, and the stripes of a slip",
}
MOVING = ("animate",)


def _seconds(scene, recording):
    if scene.kind == "touch":
        held = recording.felt[1]
        return scene.world["press_s"] + len(held.codes) / held.scene.rate_hz
    if scene.kind == "letter":
        return sum(len(images) * step_s(scene) + QUIET_S for images in recording.steps)
    hz = scene.world["hz"]
    hz = hz if isinstance(hz, (tuple, list)) else [hz] * len(recording.drives)
    return sum(len(frames) / f for (_, _, frames), f in zip(recording.drives, hz))


def _touch(scene, core, recording, rng):
    from meissner.scenes.optacon import touch  # here: the other kinds need no sensor

    return touch.judge(scene, core, recording)


def run(scene, engine, seed, waves=None, spread=None):
    """The Result of the scene, which runs once."""
    recording, core = scenes.simulate(scene, seed), TimedEngine(engine, scene.features)
    judge = _touch if scene.kind == "touch" else KINDS[scene.kind]
    found, arrays, rows, drawings = judge(scene, core, recording, np.random.default_rng([seed, 42]))
    summary = {
        **head(scene, core, seed, _seconds(scene, recording), recording.modelled),
        **found,
        "runs": 1,
        "seeds": [seed, seed],
        "conditions": rows,
    }
    drawn = []
    for draw, what in drawings:
        name = draw.__name__
        drawn.append(
            (partial(draw, scene, **what), scene.title, SHOWN[name], "gif" if name in MOVING else "png")
        )
    return Result(summary, arrays, numbered(drawn))


def _conclusions(summary):
    return {k: summary[f"conclusion_{k}"] for k in (1, 2, 3, 4)}


def tell(summary):
    lines = [f"1 run, seed {summary['seed']}"]
    if "correlation" in summary:
        lines += [
            f"at 230 Hz {summary['above_db']:.1f} dB from above (published: 22.2), fit's error "
            f"{summary['fit_error_db']:+.2f} dB; from below {summary['apart_db']:.2f} dB less; correlation "
            f"{summary['correlation']:.4f} (0.996); a single peak can read {summary['single_low_db']:.2f} dB "
            "low",
        ]
    if "conclusion_1" in summary:
        words = ", ".join(
            f"({k}) {'holds' if yes else 'does not hold'}" for k, yes in _conclusions(summary).items()
        )
        lines += [
            f"the four conclusions: {words}",
            f"with 0.008 cm2 FA-II responds at: {summary['smallest_reached']} Hz at the highest voltage",
        ]
    if "out_um" in summary:
        lines.append(f"felt at {summary['felt_hz']:g} Hz by {', '.join(summary['felt_by']) or 'no channel'}")
    if "summed_pins" in summary:
        lines.append(
            f"{summary['characters_min']:.0f} characters a minute; pin of row 3, column 5 on in steps "
            f"{' and '.join(map(str, summary['pin_on_in_steps']))}; if FA-II summed the tips' areas, "
            f"{summary['summed_pins']} pins at once would reach it"
        )
    if "cue_deg" in summary:
        lines.append(
            f"{summary['shape']}: {summary['pins_on']} pins, {summary['pins_felt']} felt by SA-I, "
            f"{summary['pins_wrong']} not as the forces; slip on the pins "
            f"{fact('pin_delay_ms', summary['pin_delay_ms'])} after the flag, its direction "
            f"{fact('cue_error_deg', summary['cue_error_deg'])} off"
        )
    if summary["frequency_error_hz"] is not None:
        lines.append(f"drive frequency within {summary['frequency_error_hz']:.2g} Hz of the setting")
    return [*lines, "", *table(summary["conditions"])]


def answer(summary):
    """The sentence about a run."""
    if "correlation" in summary:
        return (
            f"The free pin moves by {fact('above_db', summary['above_db'])} at 230 Hz, "
            f"{fact('fit_error_db', summary['fit_error_db'])} from the published value; its views from above "
            f"and below correlate by {summary['correlation']:.4f}."
        )
    if "conclusion_1" in summary:
        wrong = [str(k) for k, yes in _conclusions(summary).items() if not yes]
        if wrong:
            return f"Of the paper's four conclusions, these do not hold here: {', '.join(wrong)}."
        return "All 4 conclusions hold: SA-I and FA-I are reached at low frequencies, SA-II and FA-II not."
    if "out_um" in summary:
        return (
            f"Each burst moves the pin out by {fact('out_um', summary['out_um'])} with "
            f"{fact('ripple_um', summary['ripple_um'])} on top; of {fact('felt_hz', summary['felt_hz'])} "
            f"respond: {', '.join(summary['felt_by']) or 'none'}."
        )
    if "summed_pins" in summary:
        felt = {row["condition"]: row for row in summary["conditions"]}
        best = [f"{name} {100 * row['on_felt']:.0f} %" for name, row in felt.items()]
        return f"Of the pins that are on, each channel responds at: {'; '.join(best)}."
    return (
        f"Of {summary['pins_on']} pins that show the {summary['shape']}, SA-I responds at "
        f"{summary['pins_felt']}; the slip is on the pins "
        f"{fact('pin_delay_ms', summary['pin_delay_ms'])} after its flag."
    )
