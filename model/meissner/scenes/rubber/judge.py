"""Judging a slip scene: each run's flag against the ground truth, and the figures of all runs.

A slip is missed if no flag comes before the whole contact slips: there is none, or a late one.
"""

import numpy as np

from meissner.engines.float_slip import first_crossing
from meissner.scenes.slip_rates import rates
from meissner.twins.slip.slip import State

COUNTS = ("missed", "late", "false_alarms", "false_alarms_masked")  # of runs, to be added up


def slipping(state):
    """Whether the slip flag is up, for each detail."""
    return (state == State.INCIPIENT) | (state == State.GROSS)


def _raised(state):
    """Indices of the details at which the slip flag rises."""
    slips = slipping(state)
    return np.flatnonzero(slips & ~np.concatenate([[False], slips[:-1]]))


def risen(state, group, rate_hz):
    """Times at which the slip flag rises, in seconds; the time of a detail is that of its last sample."""
    return ((_raised(state) + 1) * group - 1) / rate_hz


def flagged(rises, onset, gross):
    """Judge flags that rise at ``rises``: the entries of ``judge`` from flag_s to false_alarms.

    ``onset``, ``gross``: seconds, None without a slip.
    """
    early = rises if onset is None else rises[rises < onset]
    flag = None if onset is None or len(early) == len(rises) else float(rises[len(early)])
    late = flag is not None and flag >= gross
    return {
        "flag_s": flag,
        "delay_s": None if flag is None else flag - onset,
        "lead_s": None if flag is None else gross - flag,
        "missed": late or (onset is not None and flag is None),
        "late": late,
        "false_alarms": len(early),
    }


def judge(recording, state, config):
    """Compare the states of one run with the truth; times in seconds, None where there is none.

    ``flag_s``: the first rise of the flag at or after the onset; ``missed``: a slip without one before the
    whole contact slips, also ``late`` if one comes at or after that; ``lead_s``: from the flag to the slip of
    the whole contact, negative if late; ``false_alarms``: rises before the onset, or all where nothing slips;
    ``crossing_s``: first crossing of the float reference's exact sliding window after the onset; the time
    before it is the wait for a large enough event, the time after it the detector's own delay.
    ``sliding_s``: from the slip of the whole contact to the end; ``contact_share_of_sliding``: share of its
    details in which the state is not incipient or gross. ``contact_wrong_share``: share of all details in
    which state and truth disagree on whether the plate presses; the truth has contact from the first force
    on, the state from its contact level on.
    """
    group, rate_hz = 1 << config.level, recording.scene.rate_hz
    onset = recording.onset_s
    crossing = None
    if onset is not None:
        detail = first_crossing(recording.codes, config, int(np.ceil(onset * rate_hz)) // group)
        crossing = None if detail is None else ((detail + 1) * group - 1) / rate_hz
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
        "contact_wrong_share": _contact_wrong(recording, state, group),
        "crossing_s": crossing,
        **flagged(risen(state, group, rate_hz), onset, recording.gross_s),
    }


def _contact_wrong(recording, state, group):
    pressed = recording.normal_n[group - 1 :: group][: len(state)] > 0
    says = (state != State.NONE) & (state != State.RELEASE)
    return float((says != pressed).mean())


def contact_share(verdicts):
    """Share of all runs' sliding time in which the state is not a slip; None if no run slid."""
    slid = [verdict for verdict in verdicts if verdict["sliding_s"]]
    if not slid:
        return None
    without = sum(verdict["sliding_s"] * verdict["contact_share_of_sliding"] for verdict in slid)
    return round(without / sum(verdict["sliding_s"] for verdict in slid), 6)


def contact_wrong(verdicts):
    """The mean of contact_wrong_share over all runs."""
    return round(float(np.mean([verdict["contact_wrong_share"] for verdict in verdicts])), 6)


def _ends(rate):
    return rate and [rate["low"], rate["high"]]


def statistics(condition, verdicts):
    """A row of the table of conditions. Delays and leads include those of late flags."""
    delays = np.array([v["delay_s"] for v in verdicts if v["delay_s"] is not None]) * 1e3
    leads = np.array([v["lead_s"] for v in verdicts if v["lead_s"] is not None]) * 1e3
    found = rates(verdicts)
    row = {
        "condition": condition.name,
        "runs": len(verdicts),
        **{key: sum(v[key] for v in verdicts) for key in COUNTS},
        "missed_interval": _ends(found["missed_rate"]),
        "false_alarm_interval": _ends(found["false_alarm_rate"]),
        "contact_share_of_sliding": contact_share(verdicts),
        "contact_wrong_share": contact_wrong(verdicts),
    }
    # A flag may have no crossing: an event before the onset raised it, blanked until after the onset.
    own = [v["flag_s"] - v["crossing_s"] for v in verdicts if None not in (v["flag_s"], v["crossing_s"])]
    if len(delays):
        row |= {
            "delay_ms_median": round(float(np.median(delays)), 3),
            "delay_ms_mean": round(float(delays.mean()), 3),
            "delay_ms_max": round(float(delays.max()), 3),
            **({"detector_ms_max": round(max(own) * 1e3, 3)} if own else {}),
            "lead_ms_median": round(float(np.median(leads)), 3),
            "lead_ms_min": found["lead_ms_min"],
        }
    return row
