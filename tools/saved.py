"""Record what every scene saves beside everything on (docs/scenes.md): model/meissner/scenes/saved.json.

    python tools/saved.py fixed            every scene: some minutes
    python tools/saved.py rtl acrylic_slip cop_two_point normal_force      builds every feature's core first

The same measurement as ``meissner run SCENE --engine E --full`` prints, for several scenes.
"""

import argparse
import datetime
import json

from meissner import scenes
from meissner.builds.toolchain import ROOT
from meissner.scenes import full

FILE = ROOT / "model/meissner/scenes/saved.json"


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("engine", choices=("fixed", "rtl"))
    parser.add_argument("scenes", nargs="*", metavar="scene", help="all of them if none is named")
    wanted = parser.parse_args()
    parts = full.everything(wanted.engine)
    print(json.dumps(parts, indent=1), flush=True)
    costs = {}
    for name in wanted.scenes or scenes.names():
        costs[name] = full.cost(scenes.load(name), wanted.engine)
        print(name, costs[name], flush=True)
    recorded = json.loads(FILE.read_text("utf-8")) if FILE.exists() else {}
    recorded[wanted.engine] = {"on": str(datetime.date.today()), "full": parts, "scenes": costs}
    FILE.write_text(json.dumps(recorded, indent=1, sort_keys=True) + "\n", "utf-8")


if __name__ == "__main__":
    main()
