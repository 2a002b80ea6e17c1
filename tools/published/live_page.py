"""The page of ``live --web`` in Debian's Chromium: its pictures in README and docs, and its figures.

    PYTHONPATH=tb python tools/published/live_page.py picture     [--of start/live_array] docs/live_page.png
                                                            and others: PICTURES
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
from harness.web import Fed, resident_mb, shown
from meissner import host
from meissner.host import web

ROOT = Path(__file__).parents[2]
# In docs: {name: (line, second of the page at which it is taken, height)}.
PICTURES = {
    "live_page": ("sim:", 11, 990),
    "start/live_slip1": ("core:slip1", 5.4, 720),
    "start/live_fingertip": ("core:fingertip", 1.5, 990),
    "start/live_array": ("sim:fsr_64x64", 8.4, 990),
}


def speed(minutes):
    """Print what was received in that time, with the page open."""
    source = Fed()
    with shown(source) as (host, port), chromium.browser() as browser:
        time.sleep(2)
        page = browser.open(f"http://{host}:{port}/")
        page.until("window.meissner?.firstPicture")
        print(f"first picture after {page.do('meissner.firstPicture') / 1e3:.2f} s of the page's own clock")
        count = "if (window.last && image.time !== last + 250_000) window.gaps++; window.last = image.time;"
        page.do(f"window.gaps = 0; import('/page.js').then(it => it.on('Image', image => {{ {count} }}))")
        turns = min(10, max(1, round(2 * minutes)))
        for turn in range(turns):
            before, sent, cpu, wall = page.do("meissner.newest"), source.sent, *clocks()
            time.sleep(60 * minutes / turns)
            cpu, wall = (now - then for now, then in zip(clocks(), (cpu, wall)))
            received = (page.do("meissner.newest") - before) * Fed.RATE_HZ
            page.call("HeapProfiler.collectGarbage")
            heap = page.do("performance.memory.usedJSHeapSize")
            print(
                f"{minutes * (turn + 1) / turns:g} min: {(source.sent - sent) / wall:.1f} frames/s sent, "
                f"{received / wall:.1f} received; so far {page.do('gaps')} gaps between frames, "
                f"{page.do('meissner.dropped')} parts dropped; server {100 * cpu / wall:.1f} % of a core, "
                f"{resident_mb():.0f} MB; browser {browser.resident_mb():.0f} MB, of which the page's heap "
                f"{heap / 1e6:.0f} MB and {page.do('meissner.imageBytes') / 1e6:.0f} MB of images",
                flush=True,
            )


def clocks():
    return time.process_time(), time.monotonic()


def picture(path, line, seconds, height):
    """The page of ``live LINE --web`` at that time."""
    with (
        host.connect(line) as core,
        shown(web.OfCore(core, line)) as (address, port),
        chromium.browser() as browser,
    ):
        page = browser.open(f"http://{address}:{port}/", 1280, height)
        page.until(f"meissner.newest > {seconds}")
        page.picture(path)
        assert not browser.wrong, browser.wrong
    smaller(path)
    print(f"{path}: {path.stat().st_size / 1e3:.0f} kB")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=("picture", "speed"))
    parser.add_argument("--minutes", type=float, default=3)
    parser.add_argument("--of", choices=PICTURES, action="append")
    given = parser.parse_args()
    if chromium.missing:
        sys.exit(chromium.missing)
    if given.what == "speed":
        speed(given.minutes)
    else:
        for name in given.of or PICTURES:
            picture(ROOT / f"docs/{name}.png", *PICTURES[name])


def smaller(path):
    """The same with a palette, a third of the size."""
    from PIL import Image

    few = (
        Image.open(path).convert("RGB").quantize(256, Image.Quantize.MEDIANCUT, kmeans=4)
    )  # rare colours, too
    few.save(path, optimize=True)


if __name__ == "__main__":
    main()
