"""Judging pulls of a rope: each kind's summary, arrays and rows. ``KINDS``: the function of each kind."""

from itertools import pairwise

import numpy as np

from meissner import calibration, interval
from meissner.builds.units import Units
from meissner.engines import COP_ONE
from meissner.forest import process, sklearn
from meissner.physics import mesh_loads
from meissner.rope import train
from meissner.rope.process import votes
from meissner.scenes.errors import errors, summarise
from meissner.scenes.rope import pictures
from meissner.scenes.rope.scene import pressed, training

BELOW = -15  # table I: differences of s_1 below it are counted
REST_S, END_S = 0.25, 1.0  # before a pull, and at its end: for means


def _rounded(row, digits=4):
    return {key: round(value, digits) if isinstance(value, float) else value for key, value in row.items()}


def first_alarm(alarm, section, w):
    """The first frame in a section, with its whole window in it, at which ``alarm`` [frames] is up, or
    None."""
    start = section.start + w
    found = np.flatnonzero(alarm[start : section.stop])
    return start + int(found[0]) if len(found) else None


def decide(scene, core, model, recordings):
    """(share of the vote for slip, slip) of each frame of each recording; 0 before the first whole window."""
    w = scene.pattern.w
    rows = [core.forest_features(one.channels, w) for one in recordings]
    joined = np.concatenate(rows)
    whole = sklearn.of_model(model, True)
    share, slip = votes(process.decide(core.engine, whole, joined, own=lambda: sklearn.own(model, whole)))
    ends = np.cumsum([0, *map(len, rows)])
    padded = lambda found, one: np.concatenate([np.zeros(w, found.dtype), found[one]])
    return [(padded(share, slice(a, b)), padded(slip, slice(a, b))) for a, b in pairwise(ends)]


def real_time(scene, core, model, recordings):
    """(what ``decide`` found, summary, rows) of a forest over all ``recordings`` [condition][seed]."""
    flat = [one for of in recordings for one in of]
    decided, w, rows, apart_of_all, alarmed = decide(scene, core, model, flat), scene.pattern.w, [], [], []
    frame_ms = 1e3 / scene.rate_hz
    for name, one, begin in zip(scene.names, recordings, range(0, len(flat), scene.seeds)):
        apart, quiet, slipping = [], [], 0
        for recording, (_, slip) in zip(one, decided[begin:]):
            for section in recording.sections:
                at = first_alarm(slip, section, w)
                if section.slip is None:
                    quiet.append(at is not None)
                else:
                    slipping += 1
                    apart += [] if at is None else [at - section.slip]
        apart_of_all += apart
        alarmed += quiet
        steps = float(np.mean(apart)) if apart else None
        row = {"condition": name, "quiet_sections": len(quiet), "errors": sum(quiet) if quiet else None}
        row |= {"slipping_sections": slipping, "missed": slipping - len(apart), "apart_steps": steps}
        rows.append(_rounded(row | {"apart_ms": None if steps is None else frame_ms * steps}))
    missed, sections = sum(row["missed"] for row in rows), sum(row["slipping_sections"] for row in rows)
    summary = {
        "missed": missed,
        "missed_rate": interval.rate(missed, sections) if sections else None,
        "false_alarms": sum(alarmed),
        "false_alarm_rate": interval.rate(sum(alarmed), len(alarmed)) if alarmed else None,
        "false_alarms_masked": 0,
        "apart_ms": frame_ms * float(np.mean(apart_of_all)) if apart_of_all else None,
        "apart_ms_deviation": frame_ms * float(np.std(apart_of_all)) if apart_of_all else None,
    }
    return decided, summary, rows


def _shown(recording, slip, w):
    """Onset and flag in seconds of the first slipping section; None where there is none."""
    for section in recording.sections:
        if section.slip is not None:
            slid = np.flatnonzero(np.diff(recording.slid_mm[section.start - 1 : section.stop]) > 0)
            frames = section.start + int(slid[0]) if len(slid) else None, first_alarm(slip, section, w)
            return [None if at is None else float(recording.time_s[at]) for at in frames]
    return [None, None]


def _pull(scene, core, recordings, seed):
    """A forest in real time: alarms in sections without slip, and their distance from t_s where it slips."""
    data = train.Data(training(scene, seed), seed)
    model = train.fit(*data.split(scene.pattern)[0], seed, scene.world["trees"])
    decided, found, rows = real_time(scene, core, model, recordings)
    decided, shown = decided[:: scene.seeds], [one[0] for one in recordings]
    onset_s, flag_s = _shown(shown[0], decided[0][1], scene.pattern.w)
    summary = {
        "onset_s": onset_s,
        "flag_s": flag_s,
        "delay_s": None if None in (onset_s, flag_s) else flag_s - onset_s,
        **found,
        "trees": scene.world["trees"],
        "trained_on": len(data.rest),
    }
    arrays = {}
    for k, (recording, (share, slip)) in enumerate(zip(shown, decided)):
        arrays |= {f"c{k}_score": share, f"c{k}_slip": slip, f"c{k}_codes": recording.channels}
        arrays |= {f"c{k}_load_n": recording.load_n, f"c{k}_slid_mm": recording.slid_mm}
    return summary, arrays, rows, [(pictures.draw_pull, {"recordings": shown, "decided": decided})]


def _mean(values, stop, seconds, rate_hz):
    return float(values[max(0, stop - round(seconds * rate_hz)) : stop].mean())


def _cop(scene, core, recordings, seed):
    """The centre over the pulls: its move in each, what is left after all, and how far it follows the
    rope."""
    lines, _ = calibration.fit(*pressed(scene, seed))
    min_load = Units(newtons_per_code=lines.force_lsb_n).load_code(scene.min_load_n)
    rows, arrays, position, of_load, below = [], {}, [], [], 0
    for k, (name, one) in enumerate(zip(scene.names, recordings)):
        found_of = []
        for number, recording in enumerate(one):
            found = core.cop(core.calibrate(recording.codes, lines), min_load)
            x, y, valid = found["x"] / COP_ONE, found["y"] / COP_ONE, found["valid"]
            load_n, truth = found["sum"] * lines.force_lsb_n, mesh_loads.true_centre(recording.force_n)
            off, share = errors(x, y, load_n, valid, *truth)
            position.append(off)
            of_load.append(share[valid])
            below += int((~valid).sum())
            moves = np.array(
                [
                    [
                        _mean(axis, s.stop, END_S, scene.rate_hz)
                        - _mean(axis, s.start, REST_S, scene.rate_hz)
                        for axis in (x, y)
                    ]
                    for s in recording.sections
                ]
            )
            first, last = recording.sections[0].start, len(y)
            left = _mean(y, last, REST_S, scene.rate_hz) - _mean(y, first, REST_S, scene.rate_hz)
            follows = float(np.polyfit(recording.place, y, 1)[0])
            found_of.append((moves, left, follows))
            if number == 0:
                arrays |= {f"c{k}_x": x, f"c{k}_y": y, f"c{k}_load_n": load_n, f"c{k}_place": recording.place}
        moves = np.concatenate([of for of, *_ in found_of])
        row = {
            "condition": name,
            "pulls": len(moves),
            "x_moves": float(moves[:, 0].mean()),
            "x_falls": int((moves[:, 0] < 0).sum()),
            "y_moves": float(moves[:, 1].mean()),
            "y_rises": int((moves[:, 1] > 0).sum()),
            "y_left": float(np.mean([of[1] for of in found_of])),
            "y_follows": float(np.mean([of[2] for of in found_of])),
        }
        rows.append(_rounded(row))
    summary = {
        "position_error": summarise(np.concatenate(position)),
        "load_error": summarise(np.concatenate(of_load)),
        "below_min_load": below,
    }
    return summary, arrays, rows, [(pictures.draw_cop, {"names": scene.names, "arrays": arrays})]


def _hardness(scene, core, recordings, seed):
    """Differences of successive frames: s_1 below -15 as in table I, its oscillation, and s_8 and s_3."""
    rows, arrays = [], {}
    for k, (name, one) in enumerate(zip(scene.names, recordings)):
        counts, low, periods, oscillation, straight, risen = [], [], [], [], [], []
        for number, recording in enumerate(one):
            # Row n - 1 is of frame n, as the window is one frame.
            steps = core.forest_features(recording.channels, 1)
            for section in recording.sections:
                own = steps[section.start : section.stop - 1, 1]
                hits = np.flatnonzero(own < BELOW)
                counts.append(len(hits))
                low += own[hits].tolist()
                periods += np.diff(hits).tolist()
                begins = section.slip or min(section.start + scene.rate_hz, section.stop - 2)
                sliding = steps[begins : section.stop - 1]
                oscillation.append(float(sliding[:, 1].std()))
                straight.append(int(np.ptp(recording.channels[8, section.start : section.stop])))
                codes = recording.channels[3]
                risen.append(
                    _mean(codes, section.stop, END_S, scene.rate_hz)
                    - _mean(codes, recording.sections[0].start, REST_S, scene.rate_hz)
                )
            if number == 0:
                arrays |= {f"c{k}_codes": recording.channels, f"c{k}_steps": steps.T}
                arrays |= {f"c{k}_load_n": recording.load_n}
                arrays[f"c{k}_slips"] = np.array(
                    [-1 if s.slip is None else s.slip for s in recording.sections]
                )
        row = {
            "condition": name,
            "sections": len(counts),
            "slipping_sections": sum(s.slip is not None for r in one for s in r.sections),
            "below": float(np.mean(counts)),
            "below_least": min(counts),
            "below_most": max(counts),
            "below_mean": float(np.mean(low)) if low else None,
            "period_steps": float(np.median(periods)) if periods else None,
            "oscillation": float(np.mean(oscillation)),
            "s_8_range": float(np.mean(straight)),
            "s_3_rises": float(np.mean(risen)),
        }
        rows.append(_rounded(row))
    shown = {"scene_names": scene.names, "recordings": [one[0] for one in recordings]}
    return (
        {},
        arrays,
        rows,
        [(pictures.draw_sensors, shown), (pictures.draw_steps, shown | {"arrays": arrays})],
    )


KINDS = {"pull": _pull, "cop": _cop, "hardness": _hardness}
