"""Figures of synthesis, place and route: measured, no estimates.

constraints/fmax.json and constraints/resources.json have them, under the version of Meissner that they were
measured on.
"""

import json
from functools import cache

from meissner.builds.toolchain import ROOT

BLOCKS = ROOT / "constraints/fmax.json"
BOARDS = ROOT / "constraints/resources.json"
NOTHING = {"lut": None, "mhz": None}


@cache
def recorded(path, command):
    """The figures in a file of measured figures; ValueError with the ``command`` that writes it if it is
    missing or damaged."""
    try:
        return json.loads(path.read_text("utf-8"))["figures"]
    except FileNotFoundError:
        raise ValueError(f"{path} is missing; `{command}` writes it") from None
    except (ValueError, KeyError, TypeError):
        raise ValueError(f"{path} is damaged; `{command}` writes it") from None


def placed(entry, target):
    """{"lut", "mhz"} of an entry of `make fmax`, mhz of its worst seed; ValueError if it was not measured."""
    command = f"make fmax FMAX=\"--record '{entry}'\""
    kept = recorded(BLOCKS, command).get(f"{entry} {target}")
    if kept is None:
        raise ValueError(f"{BLOCKS} has no figures of {entry} on {target}; `{command}` measures them")
    return {"lut": kept["area"]["lut"], "mhz": kept["mhz_worst"]}


def of_board(board, config):
    """The resources of a configuration's bitstream for a board; None if there is none."""
    kept = recorded(BOARDS, "make resources").get(f"{board}-{config}", {})
    return kept if "lut" in kept else None
