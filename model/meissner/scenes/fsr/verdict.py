"""The sentence about a run of an array of FSRs: position, load, and the cells found dead."""

from meissner.scenes.verdict import count, position_and_load


def answer(summary):
    text = position_and_load(summary)[:-1]
    as_injected = "those injected" if summary["dead_as_injected"] else "not all as injected"
    if summary["dead"] or not summary["dead_as_injected"]:
        text += f"; {count(summary['dead'], 'cell was', 'cells were')} found dead, {as_injected}"
    return text + "."
