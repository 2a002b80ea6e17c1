"""Set the slip threshold of a core in volts, and see how the number of slip events changes.

    python examples/set_threshold.py [PORT]

PORT is, for example, serial:/dev/ttyUSB0; without it a simulated core runs on a pty.
"""

import sys

from meissner import host
from meissner.builds.units import of_scene
from meissner.host.pty import Pty
from meissner.host.simulated import of_scenes
from meissner.scenes import load


def events(core, seconds):
    """Slip events in the next ``seconds`` of the core's own time, which each of its answers brings."""
    first = core.now
    last, count = first + seconds * 1000 * core["core.clk_khz"], 0
    while True:
        over = core.now >= last
        found = [packet.time for packet in core.packets(0.1) if isinstance(packet, host.SlipEvent)]
        count += sum(first <= time < last for time in found)
        if over:
            return count
        core["core.clk_khz"]


def run(port, seconds=11):
    # The core does not know its converter, sample rate and rubber: take them from this scene.
    with host.connect(port, of_scene(load("acrylic_slip"))) as core:
        print(f"the core has {', '.join(core.features)}; slip.threshold = {core['slip.threshold']} codes")
        print(f"{events(core, seconds)} slip events in {seconds:g} s")
        code = core.set("slip.threshold", volts=1.0)
        print(f"1 V, peak to peak, are {code} codes: {core['slip.threshold']} are in the register now")
        print(f"{events(core, seconds)} slip events in {seconds:g} s")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        run(sys.argv[1])
    else:
        with Pty(of_scenes("acrylic_slip", speed="20")) as pty:
            run(pty.url)
