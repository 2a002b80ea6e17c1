"""The sentence that a run's report begins with; each sensor's part of it is in the sensor's folder."""

from meissner.report.words import fact, number


def count(count, one, many=None):
    return f"{number(count)} {one if count == 1 else many or one + 's'}"


def slips(summary, began="the first partial slip", moved="the whole contact slipped"):
    """Slips detected and missed and false alarms of all runs; a row without delays and misses has no slip.

    ``began``, ``moved``: the event that the delay starts from, and the event that the lead ends at.
    """
    rows = summary["conditions"]
    slipping = [row for row in rows if row["missed"] or row.get("delay_ms_median") is not None]
    total, missed, false = sum(row["runs"] for row in slipping), summary["missed"], summary["false_alarms"]
    alarms = f"with {count(false, 'false alarm')}" if false else "without a false alarm"
    if not total:
        reported = f"{count(false, 'false alarm')} rose" if false else "no slip was reported"
        return f"Nothing slips in {count(summary['runs'], 'run')}, and {reported}."
    found = [row for row in slipping if row.get("delay_ms_median") is not None]
    if missed == total:
        text = f"{'The slip was' if total == 1 else f'All {number(total)} slips were'} missed"
        if not found:
            return f"{text}, {alarms}."
        text += "; the flag rose"
    elif any(row["lead_ms_min"] <= 0 for row in found):
        text = f"{number(missed)} of {count(total, 'slip')} were missed; the flags rose"
    elif missed:
        text = f"{number(missed)} of {count(total, 'slip')} were missed; the others were detected"
    else:
        text = "The slip was detected" if total == 1 else f"All {number(total)} slips were detected"
    delay_ms, lead_ms = max(row["delay_ms_max"] for row in found), min(row["lead_ms_min"] for row in found)
    text += f" at most {number(delay_ms)} ms after {began}"
    if lead_ms > 0:
        text += f" and at least {number(lead_ms)} ms before {moved}"
    else:
        text += f", the latest {number(abs(lead_ms))} ms after {moved}"
    return f"{text}, {alarms}."


def position_and_load(summary):
    """The errors of position and load."""
    place, load = summary["position_error"], summary["load_error"]
    if place is None or load is None:
        return "No frame has a position."

    def of(key, which):
        return fact(key, summary[key][which])

    text = (
        f"The error of the position is at most {of('position_error', 'maximum')} of the range, that of the "
        f"load {of('load_error', 'maximum')}; their means are {of('position_error', 'mean')} and "
        f"{of('load_error', 'mean')}"
    )
    if "response_s" in summary:
        text += f"; 95 % of the load is reported after {fact('response_s', summary['response_s'])}"
    if "locus" in summary:
        locus = summary["locus"]
        text += f"; the locus is a circle of radius {number(locus['radius'])}"
        text += f", {fact('roundness', locus['roundness'])} out of round"
    return text + "."


def verdict(summary, text):
    """The sensor's sentence with the comparison of core and twin; a difference comes first."""
    wrong = summary.get("twin_mismatches")
    if wrong:
        return (
            f"The core differs from its integer twin in {count(wrong, 'value')}: its results are not valid. "
            f"{text}"
        )
    if wrong == 0:
        return f"{text[:-1]}; the core equals its integer twin in every value."
    return text
