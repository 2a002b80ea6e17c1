"""The sentence about a run of an array of capacitors."""

from meissner.report.words import fact
from meissner.scenes.verdict import position_and_load


def answer(summary):
    def of(key):
        return fact(key, summary[key])

    if "difference_from_eq18_v" in summary:
        return f"The demodulated output is at most {of('difference_from_eq18_v')} off eq. 18."
    if "sag_of_hold" in summary:
        worst = max(row["of_the_mean"] for row in summary["conditions"])
        return (
            f"The reading of a held force rises by {of('sag_of_hold')} and leaves "
            f"{of('left_after_release_g')} at its release; the same press repeats within "
            f"{fact('of_the_mean', worst)} (standard deviation)."
        )
    if "peaks_apart_mm" in summary:
        return (
            f"Neighbouring cells peak {of('peaks_apart_mm')} apart; over a cell's centre its neighbour reads "
            f"{of('neighbour_at_a_centre')} of it."
        )
    text = position_and_load(summary)
    return (
        f"Calibration brings the cells of an even press from {of('unevenness_before')} to "
        f"{of('unevenness_after')} of their mean; {text[0].lower()}{text[1:]}"
    )
