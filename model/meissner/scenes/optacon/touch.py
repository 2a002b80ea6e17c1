"""Judging what two sensors feel and a display gives back: an object on the capacitive pad, and a slip on the
four-wire sensor."""

from itertools import pairwise

import numpy as np

from meissner.engines import COP_ONE
from meissner.engines.features.render.engines import Felt
from meissner.physics.capacitive import GRAM_N
from meissner.scenes.capacitive.judge import calibrations
from meissner.scenes.optacon import pictures
from meissner.scenes.optacon.felt import feel, frequency
from meissner.tables import naming
from meissner.twins.actuate.render import APART, OCTANTS, Render, RenderSettings, averages


def render_settings(scene, newtons_per_code):
    """RenderSettings of the pad's image and of the slip; codes of force."""
    world = scene.world
    codes = [max(1, round(world[key] * GRAM_N / newtons_per_code)) for key in ("floor_g", "step_g")]
    with naming("[world]: floor_g, step_g in codes of force"):
        return RenderSettings(*codes), RenderSettings(marker=1, cue=world["cue_frames"])


def felt_image(forces):
    """Felt of an image alone [frames, rows, columns]."""
    count = len(forces)
    none = np.zeros(count, dtype=np.int64)
    return Felt(forces.astype(np.int64), none > 0, none, none > 0, np.zeros((count, 2), np.int64))


def _pad(scene, core, recording):
    """(Felt of the pad's image, newtons a code, true forces [rows, columns])."""
    pad, found = recording.felt[0], {}
    for name in ("probe", "even", scene.world["shape"]):
        found[name] = core.demodulate(pad.parts[name].samples, pad.scene.carrier)
    lines = calibrations(pad, found)["even"].lines
    forces = core.calibrate(found[scene.world["shape"]], lines)
    return felt_image(forces), lines.force_lsb_n, pad.parts[scene.world["shape"]].force_n[0]


def _grip(scene, core, recording):
    """(Felt of the four-wire sensor, its decisions)."""
    held = recording.felt[1]
    one = held.scene
    found, decisions = core.cop_slip(held.codes, one.config, one.lag, one.registers)
    step = max(1, round(one.rate_hz * scene.world["frame_ms"] / 1000))
    at = slice(step - 1, None, step)
    cop = np.stack([found.x[at], found.y[at]], axis=1).astype(np.int64)
    parts = decisions.slip[at], decisions.octant[at].astype(np.int64), found.pressed[at]
    return Felt(None, *parts, cop), decisions


def _shown(scene, core, levels, shape):
    """(what the display shows of frames of levels that come every frame_ms, frame of each of its periods).

    ``shape``: of the images. A frame is complete at its end and takes the core's longest time to compute.
    """
    size, hz = scene.sizes[0], scene.world["hz"]
    start_s = np.arange(int(len(levels) * scene.world["frame_ms"] / 1000 * hz) + 1) / hz
    ready_s = Render(shape, scene.grids[0], size.amplitude_bits).clocks / (1000 * size.clk_khz)
    of = np.floor((start_s - ready_s) * 1000 / scene.world["frame_ms"] + 1e-9).astype(int) - 1
    frames = np.where((of >= 0)[:, None], levels.reshape(len(levels), -1)[np.maximum(of, 0)], 0)
    return core.pin_display(frames, size, scene.settings()), of


def _phase(pattern, octant):
    """The phase at which stripes across that octant give a pattern [rows, columns]; None if they do not."""
    right, up = OCTANTS[octant]
    row, column = np.indices(pattern.shape)
    own = np.unique((right * column - up * row)[pattern] % APART)
    return int(own[0]) if len(own) == 1 and pattern.sum() * APART > pattern.size - pattern.size // 2 else None


def moves(patterns):
    """The octant in which stripes [frames, rows, columns] move: across them, a pin at a time; None if none
    fits."""
    kept = [*patterns[:1], *(b for a, b in pairwise(patterns) if (a != b).any())]
    votes = np.zeros(len(OCTANTS), int)
    for before, after in pairwise(kept):
        for octant in range(len(OCTANTS)):
            ends = _phase(before, octant), _phase(after, octant)
            votes[octant] += None not in ends and (ends[0] + 1) % APART == ends[1]
    return int(votes.argmax()) if votes.any() else None


def judge(scene, core, recording):
    """An object on the pad and a slip on the four wires, both on the pins, and what a finger feels of
    them."""
    (size,), (grid,) = scene.sizes, scene.grids
    image, newtons, true_n = _pad(scene, core, recording)
    of_image, of_slip = render_settings(scene, newtons)
    shape = core.render(image, grid, size.amplitude_bits, of_image)
    shown, _ = _shown(scene, core, shape, true_n.shape)
    feels, _ = feel(scene, shown, size)
    truth = averages(np.rint(true_n / newtons), *grid) / true_n.size
    under, lit = truth >= of_image.floor, shown.levels[-1].reshape(grid) > 0
    felt = feels["SA-I"].any(axis=1).reshape(grid)

    wires, decisions = _grip(scene, core, recording)
    cue = core.render(wires, grid, size.amplitude_bits, of_slip)
    slid, of = _shown(scene, core, cue, None)
    slip_feels, _ = feel(scene, slid, size)
    held = recording.felt[1]
    flag = np.flatnonzero(decisions.raised)
    stripes = np.array([wires.slip[max(k, 0)] and k >= 0 for k in of]) & (slid.levels.any(axis=1))
    patterns = (slid.levels[stripes] > 0).reshape(-1, *grid)
    octant = moves(patterns) if len(patterns) else None
    way_deg = None if octant is None else 45 * octant if octant <= 4 else 45 * octant - 360
    true_deg = held.condition.direction_deg
    start = (slid.start[np.flatnonzero(stripes)[:1]] + size.lead) / (1000 * size.clk_khz)  # at the pins
    flag_s = flag[0] / held.scene.rate_hz if len(flag) else None
    late = 1e3 * float(start[0] - flag_s) if len(start) and flag_s is not None else None
    summary = {
        "shape": scene.world["shape"],
        "pins_on": int(lit.sum()),
        "pins_wrong": int((lit != under).sum()),
        "pins_felt": int((felt & lit).sum()),
        "image_correlation": float(np.corrcoef(shown.levels[-1], truth.ravel())[0, 1]),
        "slip_ms": None if flag_s is None else 1e3 * flag_s,
        "pin_delay_ms": late,
        "cue_deg": way_deg,
        "cue_error_deg": None if way_deg is None else abs((way_deg - true_deg + 180) % 360 - 180),
        "frequency_error_hz": max(abs(frequency(one, size) - scene.world["hz"]) for one in (shown, slid)),
    }
    rows = []
    for what, found, on in (
        (f"object: {scene.world['shape']}", feels, shown.levels[1:].T > 0),
        (f"slip: {scene.world['pull']}", slip_feels, (slid.levels[1:] * stripes[1:, None]).T > 0),
    ):
        pinned = on.any(axis=1)
        rows.append(
            {
                "condition": what,
                "pins_on": int(pinned.sum()),
                **{name: int(yes[pinned].any(axis=1).sum()) for name, yes in found.items()},
            }
        )
    arrays = {
        "levels": shown.levels,
        "force_g": true_n / GRAM_N,
        "cue": slid.levels,
        "cue_start": slid.start - slid.start[1],
    }
    arrays |= {"x": wires.cop[:, 0] / COP_ONE, "y": wires.cop[:, 1] / COP_ONE, "slip": wires.slip}
    drawn = {
        "force_g": true_n / GRAM_N,
        "levels": shown.levels[-1].reshape(grid),
        "felt": felt,
        "patterns": patterns,
        "true_deg": true_deg,
    }
    return summary, arrays, rows, [(pictures.draw_touch, drawn)]
