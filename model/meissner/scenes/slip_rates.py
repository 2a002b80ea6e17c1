"""The rates of a slip scene: the share of slips missed, and the share of runs with a false alarm."""

from meissner import interval


def rates(verdicts):
    """The rates with their intervals, and the worst lead; None where no run applies.

    ``missed_rate``: among runs with a slip; ``false_alarm_rate``: runs with one or more, among all runs;
    ``lead_ms_min``: shortest time from a flag to the slip, over all flags; 0 or less if one is late.
    """
    slips = [verdict for verdict in verdicts if verdict["onset_s"] is not None]
    leads = [1e3 * verdict["lead_s"] for verdict in slips if verdict["lead_s"] is not None]
    alarmed = sum(verdict["false_alarms"] > 0 for verdict in verdicts)
    return {
        "missed_rate": interval.rate(sum(v["missed"] for v in slips), len(slips)) if slips else None,
        "false_alarm_rate": interval.rate(alarmed, len(verdicts)),
        "lead_ms_min": round(min(leads), 3) if leads else None,
    }


def tell(summary):
    """The lines to print of a summary with ``rates``, ``late``, ``runs`` and ``seeds``."""
    first, last = summary["seeds"]
    lines = [f"{summary['runs']} runs, seeds {first} to {last} of each condition"]
    if summary["missed_rate"]:
        lines.append(
            f"slips missed: {interval.words(summary['missed_rate'])}; of these late: {summary['late']}"
        )
    if summary["lead_ms_min"] is not None:
        lines.append(f"shortest lead of a flag before the slip: {summary['lead_ms_min']:.1f} ms")
    return [*lines, f"with a false alarm: {interval.words(summary['false_alarm_rate'])}"]
