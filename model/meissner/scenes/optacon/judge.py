"""Judging pins under a finger: each kind's summary, arrays and rows. ``KINDS``: functions of all but touch.

``conclusions`` are the paper's four, of displacements by voltage and frequency:

    1  SA-I and FA-I are reached at every frequency up to 20 Hz, at 30 V and at 50 V
    2  SA-II is never reached
    3  FA-II is above the curve of figure 11 at every voltage and every frequency from 120 Hz on
    4  FA-II, with the area of the pin's tip, is never reached
"""

import numpy as np

from meissner.physics import pins, receptors
from meissner.physics.receptors import CHANNELS, PLOTTED_CM2, SMALLEST_CM2, TIP_CM2, reached
from meissner.scenes.optacon import pictures, published
from meissner.scenes.optacon.felt import feel, frequency, voltages
from meissner.scenes.optacon.scene import step_s
from meissner.twins.actuate.pin_display import share


def _rounded(row, digits=3):
    return {key: round(value, digits) if isinstance(value, float) else value for key, value in row.items()}


def conclusions(hz, volts, db, tip_cm2=TIP_CM2, plotted_cm2=PLOTTED_CM2):
    """{number: whether it holds} of ``db`` [voltages, frequencies]."""
    hz, volts, db = np.asarray(hz), np.asarray(volts)[:, None], np.asarray(db)
    low = (volts >= published.SHALLOW_V) & (hz <= published.SHALLOW_HZ)
    high = hz >= published.DEEP_HZ
    shallow = reached("SA-I", hz, db) & reached("FA-I", hz, db)
    return {
        1: bool(low.any() and shallow[low].all()),
        2: not bool(reached("SA-II", hz, db).any()),
        3: bool(high.any() and reached("FA-II", hz, db, plotted_cm2)[:, high].all()),
        4: not bool(reached("FA-II", hz, db, tip_cm2).any()),
    }


def _driven(scene, core, recording):
    """(hz, widths of the pulses) of each steady drive, and the largest error of the frequency."""
    hz, widths = [], []
    for size, settings, frames in recording.drives:
        shown = core.pin_display(frames, size, settings)
        hz.append(frequency(shown, size))
        widths.append(float(share(shown.levels[-1], size.amplitude_bits)[0]))
    return hz, widths, float(np.abs(np.subtract(hz, scene.world["hz"])).max())


def sweep(hz, widths, volts, finger, rng, count=1, repetitions=1):
    """Mean peaks in dB [pins, frequencies] of ``count`` pins, each measured several times."""
    found = np.empty((count, len(hz)))
    spread = pins.SPREAD_DB * rng.standard_normal(count) if count > 1 else np.zeros(count)
    for k, (f, width) in enumerate(zip(hz, widths)):
        wave = pins.period(f, volts, finger, width)
        for pin in range(count):
            scaled = wave * 10 ** (spread[pin] / 20)
            repeated = [pins.measured_db(scaled, f, rng) for _ in range(repetitions)]
            found[pin, k] = np.mean(repeated)
    return found


def single_low_db(hz):
    """How far below the true peak a single peak can be read, at that frequency: the two nearest samples lie
    half a sample before and after it."""
    return float(-20 * np.log10(np.cos(np.pi * hz / pins.LASER_HZ)))


def _free(scene, core, recording, rng):
    """The free pin from above and from below."""
    hz, widths, off_hz = _driven(scene, core, recording)
    volts = scene.world["volts"]
    above = sweep(hz, widths, volts, False, rng)[0]
    below = sweep(hz, widths, volts, False, rng)[0] - pins.TILT_DB
    at = int(np.argmin(np.abs(np.array(hz) - published.FREE_HZ)))
    summary = {
        "above_db": float(above[at]),
        "below_db": float(below[at]),
        "fit_error_db": float(above[at] - published.FREE_DB),
        "apart_db": float(np.mean(above - below)),
        "correlation": float(np.corrcoef(above, below)[0, 1]),
        "single_low_db": single_low_db(hz[at]),
        "frequency_error_hz": off_hz,
    }
    rows = [
        _rounded({"drive_hz": f, "above_db": a, "below_db": b})
        for f, a, b in zip(scene.world["hz"], above.tolist(), below.tolist())
    ]
    arrays = {"hz": np.array(hz), "above_db": above, "below_db": below}
    return summary, arrays, rows, [(pictures.draw_free, arrays)]


def _reach(name, hz, db, cm2=TIP_CM2):
    """The frequencies at which a channel is reached, in words."""
    found = [f"{f:g}" for f, yes in zip(hz, reached(name, hz, db, cm2)) if yes]
    return (
        "none" if not found else found[0] if len(found) == 1 else f"{found[0]} to {found[-1]} ({len(found)})"
    )


def _contact(scene, core, recording, rng):
    """Pins under a finger at each voltage, against the four channels, and the free pin at the same drive."""
    hz, widths, off_hz = _driven(scene, core, recording)
    world, nominal = scene.world, np.array(scene.world["hz"])
    tip, volts = world["tip_cm2"], world["volts"]
    each = np.array([sweep(hz, widths, v, True, rng, world["pins"], pins.REPETITIONS) for v in volts])
    db = each.mean(axis=1)
    free = sweep(hz, widths, volts[0], False, rng)[0] + pins.in_db(np.array(volts) / volts[0])[:, None]
    held = conclusions(nominal, volts, db, tip)
    less = free - db
    gained = db[-1] - db[0] - pins.in_db(np.array(volts[-1] / volts[0]))
    lowest = nominal[db.argmin(axis=1)]
    slow, fast = nominal <= published.SHALLOW_HZ, nominal >= 100
    summary = {
        **{f"conclusion_{k}": held[k] for k in held},
        "smallest_reached": _reach("FA-II", nominal, db[-1], SMALLEST_CM2),
        "lowest_hz": float(lowest[0]) if len(set(lowest)) == 1 else None,
        "less_than_free_db": float(less.min()),
        "less_slow_db": float(less[:, slow].max()) if slow.any() else None,
        "less_fast_db": float(less[:, fast].min()) if fast.any() else None,
        "gained_slow_db": float(gained[slow].mean()) if slow.any() else None,
        "gained_fast_db": float(gained[fast].mean()) if fast.any() else None,
        "spread_db": float(each.std(axis=1).mean()),
        "frequency_error_hz": off_hz,
    }
    rows = []
    for v, one in zip(volts, db):
        ends = {f"at_{f}_hz_db": float(np.interp(f, nominal, one)) for f in (1, 20, 150, 230)}
        rows.append(
            _rounded(
                {
                    "volts": v,
                    **ends,
                    **{name: _reach(name, nominal, one) for name in ("SA-I", "SA-II", "FA-I")},
                    "FA-II": _reach("FA-II", nominal, one, PLOTTED_CM2),
                    "FA-II smallest": _reach("FA-II", nominal, one, SMALLEST_CM2),
                    "FA-II tip": _reach("FA-II", nominal, one, tip),
                },
                2,
            )
        )
    arrays = {"hz": nominal, "volts": np.array(volts), "db": db, "free_db": free}
    thresholds = {name: receptors.threshold_db(name, nominal, PLOTTED_CM2) for name in CHANNELS}
    arrays |= {f"threshold_{name.replace('-', '_')}": values for name, values in thresholds.items()}
    shown = {"hz": nominal, "volts": volts, "db": db, "tip_cm2": tip}
    return summary, arrays, rows, [(pictures.draw_channels, shown), (pictures.draw_thresholds, {})]


def _burst(scene, core, recording, rng):
    """Bursts of the drive: out, back, and the ripple on top, by the laser; and which channels feel them."""
    world, ((size, settings, frames),) = scene.world, recording.drives
    shown = core.pin_display(frames, size, settings)
    hz = frequency(shown, size)
    v, points = voltages(shown, size, world["volts"])
    rate = hz * points
    x = pins.moved(v[0], rate, True)
    seconds = np.arange(0, len(x) / rate, 1 / pins.LASER_HZ)
    seen = pins.LASER_UM * np.rint(np.interp(seconds, np.arange(len(x)) / rate, x) / pins.LASER_UM)
    phase = seconds % world["burst_s"] / world["burst_s"]
    on, off = (phase > 0.25) & (phase < 0.49), phase > 0.75
    out, back = float(seen[on].mean()), float(seen[off].mean())
    ripples = []
    for k in range(world["bursts"]):
        part = seen[on & (seconds // world["burst_s"] == k)]
        ripples.append(pins.peaks(part, hz).mean())
    ripple = float(np.mean(ripples))
    felt_hz = 1 / world["burst_s"]
    out_db, ripple_db = float(pins.in_db(out)), float(pins.in_db(ripple))
    tip = world["tip_cm2"]
    feels = {
        name: bool(reached(name, felt_hz, out_db, tip) or reached(name, hz, ripple_db, tip))
        for name in CHANNELS
    }
    summary = {
        "out_um": out,
        "out_db": out_db,
        "back_um": back,
        "ripple_um": ripple,
        "ripple_db": ripple_db,
        "felt_hz": felt_hz,
        "felt_by": [name for name, yes in feels.items() if yes],
        "frequency_error_hz": abs(hz - world["hz"]),
    }
    rows = [
        {
            "condition": what,
            "published": str(theirs),
            "ours": round(ours, 3),
            "error": round(ours - theirs, 3),
        }
        for what, theirs, ours in (
            ("out (um)", published.OUT_UM, out),
            ("out (dB)", published.OUT_DB, out_db),
            ("230 Hz on top (um)", published.RIPPLE_UM, ripple),
            ("230 Hz on top (dB)", published.RIPPLE_DB, ripple_db),
            ("felt (Hz)", published.FELT_HZ, felt_hz),
        )
    ]
    arrays = {"time_s": seconds, "um": seen, "volts": v[0], "volts_time_s": np.arange(len(x)) / rate}
    return summary, arrays, rows, [(pictures.draw_burst, {"time_s": seconds, "um": seen})]


def summed_pins(hz, db, tip_cm2):
    """How many pins at once reach FA-II, if it summed the areas of all their tips."""
    over = receptors.threshold_db("FA-II", hz, tip_cm2) - db
    return int(np.ceil(10 ** (float(over) / receptors.DECADE_DB)))


def _letter(scene, core, recording, rng):
    """A letter across each display: the pins that are driven, step by step, and the channels that respond."""
    rows, arrays, seen = [], {}, []
    wrong, off_hz, step = 0, 0.0, step_s(scene)
    for (size, settings, frames), images, grid in zip(recording.drives, recording.steps, scene.grids):
        shown = core.pin_display(frames, size, settings)
        feels, hz = feel(scene, shown, size)
        off_hz = max(off_hz, abs(hz - scene.world["hz"]))
        steps = len(images)
        of = np.minimum((np.arange(len(shown.levels) - 1) / scene.world["hz"] / step).astype(int), steps)
        driven = np.array([(shown.levels[1:][of == k] > 0).all(axis=0) for k in range(steps)])
        wrong += int((driven != images.reshape(steps, -1)).sum())
        by = {}
        for name, yes in feels.items():
            by[name] = np.array([yes[:, of == k].any(axis=1) for k in range(steps)])
        lit = images.reshape(steps, -1)
        changed = np.diff(np.concatenate([0 * lit[:1], lit]).astype(int), axis=0) != 0
        for name, yes in by.items():
            rows.append(
                _rounded(
                    {
                        "condition": f"{grid[0]} x {grid[1]}, {name}",
                        "on_felt": float(yes[lit].mean()),
                        "changes_felt": float(yes[changed].mean()),
                        "rest_felt": float(yes[~lit & ~changed].mean()),
                    }
                )
            )
        key = f"r{grid[0]}"
        arrays |= {f"{key}_driven": driven.reshape(-1, *grid)}
        arrays |= {f"{key}_{name.replace('-', '_')}": yes.reshape(-1, *grid) for name, yes in by.items()}
        seen.append((grid, images, {name: yes.reshape(-1, *grid) for name, yes in by.items()}))
    row, column = published.PIN
    on = np.flatnonzero(arrays[f"r{scene.grids[0][0]}_driven"][:, row - 1, column - 1]) + 1
    ripple_db = pins.peak_db(scene.world["hz"], scene.world["volts"], True)
    summary = {
        "pin_on_in_steps": on.tolist(),
        "pins_wrong": wrong,
        "step_ms": 1e3 * step,
        "characters_min": 60 / (step * 6),
        "words_min": scene.world["words_min"],
        "summed_pins": summed_pins(scene.world["hz"], ripple_db, scene.world["tip_cm2"]),
        "frequency_error_hz": off_hz,
    }
    first = {"steps": recording.steps[0], "pin": published.PIN}
    drawn = [(pictures.animate, {"seen": seen, "step_s": step}), (pictures.draw_steps, first)]
    return summary, arrays, rows, drawn


KINDS = {"free": _free, "contact": _contact, "burst": _burst, "letter": _letter}
