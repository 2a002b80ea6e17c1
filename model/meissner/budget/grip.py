"""Latency from the sample that shows slip to the command word: the terms that the blocks' headers give."""

from meissner.budget import channels
from meissner.budget.terms import table

MOST = 16  # clocks that a command word may take
NAMES = channels.NAMES | {
    "count": "count the window for its finger",
    "join": "combine the fingers; a cycle begins",
    "goal": "the goal within its limits",
    "command": "limit the change to the rate",
    "after another": "if the end of a period has just given a command",
}


def of_config(config):
    """The numbers of ``meissner budget --config``; ``config``: meissner.builds.build.Config with [grip]."""
    reflex = config.features["grip"].grip
    terms = channels.slip_terms(config.slip) | {"count": 1, "join": 1, "goal": 1, "command": 1}
    if reflex.immediate:
        terms["after another"] = 1
    total = sum(terms.values())
    return {
        "config": config.name,
        "clock_hz": 1000 * config.clk_khz,
        "immediate": reflex.immediate,
        "terms_clocks": terms,
        "total_clocks": total,
        "total_s": total / (1000 * config.clk_khz),
        "within_16": total <= MOST,
        "wait_clocks": 0 if reflex.immediate else reflex.period,
        "cycle_clocks": reflex.period,
        "convert_clocks": config.converter.latencies()[-1],
    }


def tell(found):
    """The lines to print, the verdict first."""
    clock_us = 1e6 / found["clock_hz"]
    total = found["total_clocks"]
    side = "within" if found["within_16"] else "above"
    lines = [
        f"from the sample that shows slip to the command word: at most {total} clocks "
        f"({total * clock_us:.3f} us), {side} the limit of {MOST}",
        f"{found['config']}, {found['clock_hz'] / 1e6:g} MHz",
        "",
        *table(found, NAMES),
        "",
    ]
    lines.append(
        f"in addition, {found['convert_clocks']} clocks before it, from convert start to the last "
        "finger's sample"
    )
    cycle = found["cycle_clocks"]
    lines.append(
        f"for the first slip in a period of {cycle} clocks; a later slip waits for the next period"
        if found["immediate"]
        else f"for slip at the end of a period; an earlier slip waits for the end, up to {cycle} clocks"
    )
    return lines
