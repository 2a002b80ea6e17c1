"""Running a slip scene: every condition and seed through an engine, compared with the truth."""

import time

import numpy as np

from meissner import engines, scenes
from meissner.engines.float import first_crossing
from meissner.scenes.results import check_waves, finish, table
from meissner.scenes.rubber import pictures as report
from meissner.twins.slip.slip import State
from meissner.twins.slip.slip_path import details

SHOWN = (
    "the sensor's voltage, its Haar detail, the peak to peak over the window with the threshold, the state "
    "and the forces over time; left the whole run, right its shaded part"
)


def slipping(state):
    """Where the slip flag is up."""
    return (state == State.INCIPIENT) | (state == State.GROSS)


def _raised(state):
    """Indices of the details at which the slip flag rises."""
    slips = slipping(state)
    return np.flatnonzero(slips & ~np.concatenate([[False], slips[:-1]]))


def judge(recording, state, config):
    """Compare the states of one run with the truth; times in seconds, None where there is none.

    ``flag_s``: the first rise of the flag at or after the onset; ``missed``: a slip without one;
    ``false_alarms``: rises before the onset, or any where nothing slips; ``crossing_s``: when the exact
    sliding window of the float reference first crosses after the onset. Before it lies the wait for
    an event that is large enough, after it the detector's own delay. A detail is known at its last
    sample, so that sample's time is its time. ``sliding_s``: from the slip of the whole contact to the end;
    ``contact_share_of_sliding``: share of its details in which the state is not incipient or gross.
    """
    group, rate_hz = 1 << config.level, recording.scene.rate_hz
    rises = ((_raised(state) + 1) * group - 1) / rate_hz
    onset = recording.onset_s
    crossing = None
    if onset is not None:
        detail = first_crossing(recording.codes, config, int(np.ceil(onset * rate_hz)) // group)
        crossing = None if detail is None else ((detail + 1) * group - 1) / rate_hz
    early = rises if onset is None else rises[rises < onset]
    flag = None if onset is None or len(early) == len(rises) else float(rises[len(early)])
    sliding = contact_share = None
    if recording.gross_s is not None:
        known_s = ((np.arange(len(state)) + 1) * group - 1) / rate_hz
        slides = ~slipping(state[known_s >= recording.gross_s])
        sliding = len(slides) * group / rate_hz
        contact_share = float(slides.mean()) if len(slides) else None
    return {
        "onset_s": onset,
        "gross_s": recording.gross_s,
        "sliding_s": sliding,
        "contact_share_of_sliding": contact_share,
        "crossing_s": crossing,
        "flag_s": flag,
        "delay_s": None if flag is None else flag - onset,
        "lead_s": None if flag is None else recording.gross_s - flag,
        "missed": onset is not None and flag is None,
        "false_alarms": len(early),
    }


def _mismatches(watched, twin):
    """How many details differ from the twin's in any field."""
    fields = ("p2p", "over", "state")
    wrong = np.zeros(twin.p2p.shape, dtype=bool)
    for field in fields:
        wrong |= getattr(watched, field) != getattr(twin, field)
    return int(wrong.sum()) + int((watched.end != twin.end).sum()) + int(watched.blanked != twin.blanked)


def _saved(scene):
    """The time saved by leaving physics out: milliseconds per simulated second, here and with everything."""
    everything = scenes.load("acrylic_slip")
    return {
        "world_ms_per_s": _world_cost(scene),
        "everything_ms_per_s": _world_cost(everything),
    }


def _world_cost(scene, repeats=5):
    costs = []
    for seed in range(repeats):
        began = time.perf_counter()
        recording = scenes.simulate(scene, 0, seed)
        costs.append((time.perf_counter() - began) * 1e3 / (len(recording.time_s) / scene.rate_hz))
    return round(float(np.median(costs)), 3)


def _contact_share(verdicts):
    """Share of the sliding time in which the state does not say so, of all runs; None if none slid."""
    slid = [verdict for verdict in verdicts if verdict["sliding_s"]]
    if not slid:
        return None
    without = sum(verdict["sliding_s"] * verdict["contact_share_of_sliding"] for verdict in slid)
    return round(without / sum(verdict["sliding_s"] for verdict in slid), 6)


def _statistics(condition, verdicts):
    """One row of the table of conditions."""
    delays = np.array([v["delay_s"] for v in verdicts if v["delay_s"] is not None]) * 1e3
    leads = np.array([v["lead_s"] for v in verdicts if v["lead_s"] is not None]) * 1e3
    row = {
        "condition": condition.name,
        "runs": len(verdicts),
        "missed": sum(v["missed"] for v in verdicts),
        "false_alarms": sum(v["false_alarms"] for v in verdicts),
    }
    row["contact_share_of_sliding"] = _contact_share(verdicts)
    # A flag without a crossing: what raised it came before the onset, but was blanked until after.
    own = [v["flag_s"] - v["crossing_s"] for v in verdicts if None not in (v["flag_s"], v["crossing_s"])]
    if len(delays):
        row |= {
            "delay_ms_median": round(float(np.median(delays)), 3),
            "delay_ms_mean": round(float(delays.mean()), 3),
            "delay_ms_max": round(float(delays.max()), 3),
            **({"detector_ms_max": round(max(own) * 1e3, 3)} if own else {}),
            "lead_ms_median": round(float(np.median(leads)), 3),
            "lead_ms_min": round(float(leads.min()), 3),
        }
    return row


def _table(rows):
    """The rows with the keys of all of them: a condition without a flag has no delays."""
    keys = dict.fromkeys(key for row in rows for key in row)
    return [{key: row.get(key) for key in keys} for row in rows]


def check(scene, engine, waves):
    """ValueError with one sentence if this engine cannot run the scene."""
    check_waves(engine, waves)


def run(scene, engine, out, seed, waves, progress):
    """Run every condition of a slip scene with its seeds; write results to ``out``; return the summary."""
    began = time.perf_counter()
    module, twin_module = engines.load(engine), engines.load("fixed")
    config = scene.slip_config()
    seeds = range(seed, seed + scene.seeds)
    arrays, shown = {}, {}
    mismatches, samples, simulated, engine_s = 0, 0, 0.0, 0.0
    module.watch(np.zeros((1, config.window), dtype=np.int64), config)  # built and warm before it is timed
    jobs = [(condition, number) for condition in scene.conditions for number in seeds]
    verdicts = {condition: [] for condition in scene.conditions}
    for condition, number in progress(jobs):
        recording = scenes.simulate(scene, condition, number)
        codes = recording.codes[None]
        started = time.perf_counter()
        watched = module.watch(codes, config, recording.moving)
        engine_s += time.perf_counter() - started
        if engine in engines.VERILATED:
            mismatches += _mismatches(watched, twin_module.watch(codes, config, recording.moving))
        samples += codes.size
        simulated += len(recording.time_s) / scene.rate_hz
        verdicts[condition].append(judge(recording, watched.state[0], config))
        if number == seed:
            shown[condition] = (recording, watched)
    saved = _saved(scene) if shown[scene.conditions[0]][0].left_out else None
    pins = None
    if engine in engines.VERILATED:
        recording, watched = shown[scene.conditions[0]]
        pins = module.watch_pins(recording, config, waves=out / "waves.vcd" if waves else None)
        mismatches += _mismatches(pins.watched, watched)

    rows = _table([_statistics(condition, verdicts[condition]) for condition in scene.conditions])
    first = verdicts[scene.conditions[0]][0]
    summary = {
        "scene": scene.name,
        "engine": engine,
        "seed": seed,
        "seconds_simulated": round(simulated, 3),
        "seconds_taken": None,
        "samples_per_second": round(samples / engine_s),
        "twin_mismatches": mismatches if engine in engines.VERILATED else None,
        "modelled": list(shown[scene.conditions[0]][0].modelled),
        "left_out": list(shown[scene.conditions[0]][0].left_out),
        "saved": saved,
        **{key: first[key] for key in ("onset_s", "crossing_s", "flag_s", "delay_s", "gross_s")},
        "missed": sum(row["missed"] for row in rows),
        "false_alarms": sum(row["false_alarms"] for row in rows),
        "contact_share_of_sliding": _contact_share([v for of in verdicts.values() for v in of]),
        "runs": len(jobs),
        "conditions": rows,
        "pins": None if pins is None else pins.facts,
    }
    pictures = []
    for index, (condition, (recording, watched)) in enumerate(shown.items()):
        name = f"{scene.name}.png" if len(shown) == 1 else f"{scene.name}_{index + 1}.png"
        verdict = verdicts[condition][0]
        _draw(out / name, recording, watched, config, verdict)
        pictures.append((out / name, condition.name, SHOWN))
        arrays |= _arrays(recording, watched, config, f"c{index}_" if len(shown) > 1 else "")
    tables = {"Conditions": rows, **({"At the converter's pins": [pins.facts]} if pins else {})}
    return finish(scene, summary, out, arrays, pictures, tables, began, ("conditions", "pins", "saved"))


def _milliseconds(seconds):
    return "none" if seconds is None else f"{seconds * 1e3:.2f} ms"


def _seconds(value):
    return "none" if value is None else f"{value:.4f} s"


def tell(summary):
    """The lines to print of a summary."""
    lines = []
    if summary["saved"]:
        saved = summary["saved"]
        lines.append(
            f"saved by it: the world takes {saved['world_ms_per_s']:.2f} ms per simulated second, "
            f"{saved['everything_ms_per_s']:.2f} ms with everything"
        )
    if summary["pins"]:
        pins = summary["pins"]
        lines.append(
            f"at the pins of the {pins['adc']}: {pins['frames']} frames in {pins['clocks']} clocks; "
            f"decision {pins['decision_us']:.2f} us after convert start"
        )
    lines.append(
        f"shown run (seed {summary['seed']}): onset at {_seconds(summary['onset_s'])}, flag at "
        f"{_seconds(summary['flag_s'])}, delay {_milliseconds(summary['delay_s'])}"
    )
    share = summary["contact_share_of_sliding"]
    if share is not None:
        lines.append(
            f"of the time in which the whole contact slid, the state said contact in {100 * share:.2f} %"
        )
    return [*lines, "", *table(summary["conditions"])]


def _arrays(recording, watched, config, prefix):
    """The arrays of one run for result.npz."""
    kept = {
        "time_s": recording.time_s,
        "codes": recording.codes,
        "normal_n": recording.normal_n,
        "tension_n": recording.tension_n,
        "p2p": watched.p2p[0],
        "state": watched.state[0],
        "over": watched.over[0],
        "threshold": np.int64(config.threshold),
    }
    return {prefix + name: values for name, values in kept.items()}


def _draw(path, recording, watched, config, verdict):
    detail, _ = details(recording.codes[None], config)
    group = 1 << config.level
    volts = recording.scene.adc.lsb_v / 2 ** (config.level / 2)  # of one code of the unnormalised detail
    report.draw_slip(
        path,
        recording,
        detail_time_s=((np.arange(detail.shape[1]) + 1) * group - 1) / recording.scene.rate_hz,
        detail_v=detail[0] * volts,
        p2p_v=watched.p2p[0] * volts,
        state=watched.state[0],
        threshold_v=recording.scene.peak_to_peak_v(),
        flag_s=verdict["flag_s"],
    )
