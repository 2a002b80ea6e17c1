"""``meissner completion``: scripts for bash, zsh and fish, made from the parser by shtab."""

import argparse

from meissner.names import EVERY
from meissner.parser import parser


def _filled(at, known):
    """Give every argument of ``at`` and its commands what it completes to: known words, else files."""
    import shtab

    for action in at._actions:
        if isinstance(action, argparse._SubParsersAction):
            for inner in action.choices.values():
                _filled(inner, known)
        elif action.choices is None and action.nargs != 0:
            action.choices = known.get(action.metavar)
            if action.choices is None:
                action.complete = shtab.FILE


def script(shell):
    """The text for ``shell``."""
    import shtab

    from meissner.builds import boards
    from meissner.scenes import names

    top = parser()
    _filled(top, {"SCENE": names(), "BOARD": list(boards.BOARDS), "E": EVERY})
    return shtab.complete(top, shell=shell)


def command(arguments):
    """``meissner completion``."""
    print(script(arguments.shell))
