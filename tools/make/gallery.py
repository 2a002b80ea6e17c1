"""Run every scene on the fixed engine and keep its picture for `make docs`: build/gallery/NAME.png.

    python tools/make/gallery.py [SCENE ...]

The picture that `meissner run` writes beside its report; of several conditions with one each, the last.
"""

import shutil
import sys
import tempfile
from pathlib import Path

from meissner import run, scenes
from meissner.builds.toolchain import ROOT

OUT = ROOT / "build/gallery"


def main(names):
    OUT.mkdir(parents=True, exist_ok=True)
    for name in names or scenes.names():
        with tempfile.TemporaryDirectory() as folder:
            run.run(scenes.load(name), "fixed", Path(folder))
            pictures = sorted(Path(folder).glob("*.png"), key=lambda path: (path.stem == name, path.name))
            if not pictures:
                raise SystemExit(f"{name} drew no picture")
            shutil.copy(pictures[-1], OUT / f"{name}.png")
        print(f"build/gallery/{name}.png", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
