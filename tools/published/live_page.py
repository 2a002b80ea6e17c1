"""The page of ``live --web`` in Debian's Chromium: README's picture of it, and its figures.

    PYTHONPATH=tb python tools/published/live_page.py picture     docs/live_page.png
    PYTHONPATH=tb python tools/published/live_page.py speed       [--minutes 3] 64×64 at 100 frames/s: first
                                                            picture, frames received, processor time, memory

speed sends images and centres of pressure into the page's hub at the given rate; a core that would send so
many needs more than a serial line, and decoding is no part of it.
"""

import argparse
import sys
import time
from pathlib import Path

from harness import browser as chromium
from harness.web import Fed, of_pipe, resident_mb, shown
from meissner.host.simulated import of_scenes

ROOT = Path(__file__).parents[2]


def speed(minutes):
    """Print what was received in that time, with the page open."""
    source = Fed()
    with shown(source) as (host, port), chromium.browser() as browser:
        time.sleep(2)
        page = browser.open(f"http://{host}:{port}/")
        page.until("window.meissner?.firstPicture")
        print(f"first picture after {page.do('meissner.firstPicture') / 1e3:.2f} s of the page's own clock")
        for turn in range(max(1, round(2 * minutes))):
            before, sent, cpu, wall = page.do("meissner.newest"), source.sent, *clocks()
            time.sleep(30 if minutes >= 0.5 else 60 * minutes)
            cpu, wall = (now - then for now, then in zip(clocks(), (cpu, wall)))
            received = (page.do("meissner.newest") - before) * Fed.RATE_HZ
            heap = page.do("performance.memory.usedJSHeapSize")
            print(
                f"{(turn + 1) / 2:g} min: {(source.sent - sent) / wall:.1f} frames/s sent, "
                f"{received / wall:.1f} received, {page.do('meissner.dropped')} parts dropped; "
                f"{100 * cpu / wall:.1f} % of a core, {resident_mb():.0f} MB; heap of the page "
                f"{heap / 1e6:.0f} MB, and {page.do('meissner.imageBytes') / 1e6:.0f} MB of images",
                flush=True,
            )


def clocks():
    return time.process_time(), time.monotonic()


def picture(path):
    """The page of ``live sim:`` a moment after a slip."""
    pipe = of_scenes()
    with shown(of_pipe(pipe, pipe.units, "sim:")) as (host, port), chromium.browser() as browser:
        page = browser.open(f"http://{host}:{port}/", 1280, 990)
        page.until("meissner.newest > 11", 120)
        page.picture(path)
        assert not browser.wrong, browser.wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=("picture", "speed"))
    parser.add_argument("--minutes", type=float, default=3)
    given = parser.parse_args()
    if chromium.missing:
        sys.exit(chromium.missing)
    if given.what == "speed":
        speed(given.minutes)
    else:
        path = ROOT / "docs/live_page.png"
        picture(path)
        smaller(path)
        print(f"{path}: {path.stat().st_size / 1e3:.0f} kB")


def smaller(path):
    """The same with a palette, a third of the size."""
    from PIL import Image

    Image.open(path).convert("P", palette=Image.Palette.ADAPTIVE, colors=128).save(path, optimize=True)


if __name__ == "__main__":
    main()
