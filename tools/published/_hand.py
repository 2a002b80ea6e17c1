"""The hand of the initial-slip paper (V, figures 16 and 17) and its scenes: rows and strip charts."""

from functools import cache

from PIL import Image

from meissner import scenes
from meissner.scenes.hand import loop, pictures
from meissner.scenes.hand.run import PARTS, joined, statistics

# (figure, scene, seeds): the first condition of each, 10 ms.
MOTIONS = ((16, "grip_pour", 20), (17, "grip_release", 10))


@cache
def held(name, seeds):
    scene = scenes.load(name)
    return scene, loop.hold(scene, scene.conditions[0], range(1, 1 + seeds), PARTS["fixed"])


def rows():
    """Row V and those of figures 16 and 17."""
    cycles = sorted({one.cycle_ms for one in scenes.load("grip_pour").conditions}, reverse=True)
    yield (
        *("V", "control cycle of the hand", "10 ms", " and ".join(f"{one} ms" for one in cycles)),
        "none at 10 ms",
    )
    said = {
        16: ("the grip rises while the glass is filled", "the glass hardly moves"),
        17: (
            "the hand loosens its grip until a slip is flagged, then tightens it",
            "the glass moves by 0.5 mm only, for minutes",
        ),
    }
    for number, name, seeds in MOTIONS:
        scene, found = held(name, seeds)
        row, lasts_s = statistics(scene.conditions[0], joined([found])), scene.world["duration_s"]
        ours = (
            f"{row['runs']} runs of {lasts_s:.0f} s, {row['dropped']} dropped; displacement at most "
            f"{row['moved_mm_max']:.3f} mm: sag {row['sag_mm_max']:.3f}, slipped rings "
            f"{row['ring_mm_max']:.3f}, slip {row['slip_mm_max']:.3f}"
        )
        apart = "no number published" if number == 16 else f"{row['moved_mm_max'] - 0.5:+.2f} mm"
        yield (f"Fig. {number}", *said[number], ours, apart)


def draw(folder):
    """[(file, caption)] of figures 16 and 17: grip force, wavelet detail, position."""
    shown = []
    for number, name, seeds in MOTIONS:
        scene, found = held(name, seeds)
        file = f"initial_slip_{number}.png"
        pictures.draw(scene, scene.conditions[0], 1, found.trace, folder / file)
        Image.open(folder / file).quantize(64).save(folder / file, optimize=True)  # halves the file size
        caption = f"Figure {number}: `{name}`, seed 1: grip force, Haar detail, the glass's displacement"
        shown.append((file, caption))
    return shown
