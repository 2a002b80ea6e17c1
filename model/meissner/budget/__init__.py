"""``meissner budget``: what a configuration can reach, term by term, before anything is built.

``--cop4`` asks for the resolution of a four-wire sensor (meissner.budget.cop4). A budget of another kind adds
its options to ``add_command`` and its module beside that one.
"""

import json
from pathlib import Path

from meissner.files import written

PICTURE = "budget_cop4.png"


def add_command(commands):
    """Add ``budget`` to the commands of the parser."""
    parser = commands.add_parser("budget", help="what a configuration can reach: --cop4, a four-wire sensor")
    parser.add_argument("--cop4", action="store_true", help="position and load resolution of four electrodes")
    parser.add_argument("--rows", type=int, default=41, metavar="M", help="taxels (41)")
    parser.add_argument("--columns", "--cols", type=int, default=41, metavar="N", help="taxels (41)")
    parser.add_argument("--r", type=float, default=10.0, help="resistor between taxels, ohms (10)")
    parser.add_argument("--R0", type=float, default=10e3, help="resistor to the supply, ohms (10000)")
    parser.add_argument("--V0", type=float, default=15.0, help="supply, plus and minus, volts (15)")
    parser.add_argument("--k", type=float, default=4320.0, help="taxel: k / force, newton ohms (4320)")
    parser.add_argument("--adc-bits", type=int, default=16, metavar="B", help="8 to 24 (16)")
    parser.add_argument("--gain", type=float, default=1.0, help="of the differences, 1: none (1)")
    parser.add_argument("--load", type=float, default=5.0, metavar="F", help="on one point, newtons (5)")
    parser.add_argument("--out", metavar="PATH", help=f"a picture: a .png file, or a folder for {PICTURE}")
    parser.add_argument("--json", action="store_true", help="print the numbers as JSON instead")
    parser.set_defaults(call=_budget)


def _picture(out):
    """The file that ``out`` names, its folder there; ValueError if there can be none."""
    path = Path(out)
    if path.suffix.lower() == ".png":
        return path
    there = next(folder for folder in (path, *path.parents) if folder.exists())
    if not there.is_dir():
        raise ValueError(f"{there} is a file; name a folder or a .png file")
    path.mkdir(parents=True, exist_ok=True)
    return path / PICTURE


def _budget(arguments):
    if not arguments.cop4:
        raise ValueError("say which budget: --cop4 is the resolution of a four-wire sensor")
    from meissner.budget import cop4, cop4_report
    from meissner.world.mesh import Mesh

    for name, value in (("rows", arguments.rows), ("columns", arguments.columns)):
        if not 1 <= value <= cop4.SIDE:
            raise ValueError(f"{name} = {value} must lie in 1 .. {cop4.SIDE}")
    mesh = Mesh(arguments.rows, arguments.columns, arguments.r, arguments.R0, arguments.V0, arguments.k)
    found = cop4.budget(mesh, arguments.adc_bits, arguments.gain, arguments.load)
    if arguments.out:
        with written(_picture(arguments.out)) as file:
            cop4_report.draw(file, found)
    if arguments.json:
        print(json.dumps(found, indent=2))
        return
    print(*cop4_report.tell(found), sep="\n")
    if arguments.out:
        print(f"\npicture: {_picture(arguments.out)}")
