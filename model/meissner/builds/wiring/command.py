"""``meissner wiring``."""

from argparse import Namespace

from meissner.builds.boards import BOARDS, label
from meissner.builds.flash import EVERY
from meissner.builds.wiring.drawing import READOUTS, svg
from meissner.files import check_out, written
from meissner.tables import one_of
from meissner.terminal import plain


def command(arguments: Namespace) -> None:
    """``meissner wiring``; ValueError in one sentence if the board lacks the pins."""
    one_of("board", arguments.board, EVERY)
    one_of("columns-in", arguments.columns_in, READOUTS)
    if check_out(arguments.out).suffix != ".svg":
        raise ValueError(f"{arguments.out} must be a .svg file")
    if arguments.volts is not None and not 1 <= arguments.volts <= 10:
        raise ValueError(f"volts = {arguments.volts:g} must lie in 1 .. 10")
    board = EVERY[arguments.board]
    if arguments.board in BOARDS and arguments.config in board.left_out:
        why = board.left_out[arguments.config]
        raise ValueError(f"the {board.name} is not offered with {arguments.config}: {why}")
    drawing = svg(board, arguments.config, arguments.volts, arguments.columns_in)
    with written(arguments.out) as file:
        file.write(drawing)
    name, taken = label(arguments.config), board.plan(arguments.config).taken
    print(f"{plain(name)} on the {board.title}: {taken} header pins; {plain(arguments.out)}")
