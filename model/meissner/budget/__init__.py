"""``meissner budget``: what a configuration can reach, term by term, before anything is built.

Without ``--cop4`` it is the latency of a scanned array (meissner.budget.array), with it the resolution of a
four-wire sensor (meissner.budget.cop4).
"""

import json
from pathlib import Path

from meissner.files import written

PICTURE = "budget_cop4.png"


def add_command(commands):
    """Add ``budget`` to the commands of the parser."""
    parser = commands.add_parser(
        "budget", help="what a scanned array takes, term by term; --cop4: what a four-wire sensor resolves"
    )
    parser.add_argument("--cop4", action="store_true", help="position and load resolution of four electrodes")
    parser.add_argument("--rows", type=int, metavar="M", help="taxels (64; four-wire: 41)")
    parser.add_argument("--columns", "--cols", type=int, metavar="N", help="taxels (64; four-wire: 41)")
    parser.add_argument("--json", action="store_true", help="print the numbers as JSON instead")
    parser.set_defaults(call=_budget)
    array = parser.add_argument_group("a scanned array")
    array.add_argument("--clock", type=float, default=100e6, metavar="HZ", help="of the core (100e6)")
    array.add_argument("--adc", default="ad7606", metavar="PART", help="converter (ad7606)")
    array.add_argument("--converters", type=int, metavar="N", help="1, 2, 4 or 8 (the fewest for 1 ms)")
    array.add_argument("--channels", type=int, metavar="N", help="inputs used of each converter (8)")
    array.add_argument(
        "--sclk-khz", type=int, metavar="KHZ", help="serial clock, at most (the part's usual one)"
    )
    array.add_argument(
        "--settle-us", type=float, default=1.0, metavar="US", help="lines to convert start (1)"
    )
    array.add_argument("--demod", action="store_true", help="taxels are amplitudes of a carrier")
    array.add_argument("--sample-period", type=int, default=500, metavar="CLOCKS", help="with --demod (500)")
    array.add_argument("--periods", type=int, default=4, metavar="N", help="of 4 samples, with --demod (4)")
    array.add_argument("--skip", type=int, default=4, metavar="N", help="samples to settle, with --demod (4)")
    array.add_argument("--no-health", action="store_true", help="without the mask of faulty taxels")
    array.add_argument("--no-tare", action="store_true", help="without zeros of the taxels")
    array.add_argument(
        "--bits-per-clock", type=int, default=2, metavar="N", help="of the division, 1 or 2 (2)"
    )
    parser = parser.add_argument_group("a four-wire sensor")
    parser.add_argument("--r", type=float, default=10.0, help="resistor between taxels, ohms (10)")
    parser.add_argument("--R0", type=float, default=10e3, help="resistor to the supply, ohms (10000)")
    parser.add_argument("--V0", type=float, default=15.0, help="supply, plus and minus, volts (15)")
    parser.add_argument("--k", type=float, default=4320.0, help="taxel: k / force, newton ohms (4320)")
    parser.add_argument("--adc-bits", type=int, default=16, metavar="B", help="8 to 24 (16)")
    parser.add_argument("--gain", type=float, default=1.0, help="of the differences, 1: none (1)")
    parser.add_argument("--load", type=float, default=5.0, metavar="F", help="on one point, newtons (5)")
    parser.add_argument("--out", metavar="PATH", help=f"a picture: a .png file, or a folder for {PICTURE}")


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
    side = 41 if arguments.cop4 else 64
    for name in ("rows", "columns"):
        if getattr(arguments, name) is None:
            setattr(arguments, name, side)
    if not arguments.cop4:
        _array(arguments)
        return
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


def _array(arguments):
    from meissner.budget import array

    if arguments.out:
        raise ValueError(
            "--out is the picture of --cop4; the budget of an array is printed, with --json as JSON"
        )
    for name in ("rows", "columns"):
        if not 1 <= getattr(arguments, name) <= 1024:
            raise ValueError(f"{name} = {getattr(arguments, name)} must lie in 1 .. 1024")
    if arguments.bits_per_clock not in (1, 2):
        raise ValueError(f"bits-per-clock = {arguments.bits_per_clock} must be 1 or 2")
    carrier = None
    if arguments.demod:
        names = ("sample_period", "periods", "skip")
        carrier = {name: getattr(arguments, name) for name in names}
    found = array.budget(
        *(arguments.rows, arguments.columns, arguments.clock, array.part_of(arguments.adc)),
        *(arguments.converters, arguments.settle_us * 1e-6, arguments.channels, arguments.sclk_khz, carrier),
        *(not arguments.no_health, not arguments.no_tare, arguments.bits_per_clock),
    )
    if arguments.json:
        print(json.dumps(found, indent=2))
    else:
        print(*array.tell(found), sep="\n")
