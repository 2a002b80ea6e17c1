"""The sentence about a run of a held object: its slips, and their direction."""

from meissner.report.words import fact
from meissner.scenes.verdict import slips


def answer(summary):
    text = slips(summary, "the pull began", "the object moved")
    if summary["direction_error_deg"] is None:
        return text
    worst = fact("direction_error_deg", summary["direction_error_deg"]["maximum"])
    return f"{text[:-1]}; the reported direction is at most {worst} off."
