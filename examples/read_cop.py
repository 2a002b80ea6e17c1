"""Read the centre of pressure and the image of an array.

    python examples/read_cop.py [PORT]

PORT is, for example, serial:/dev/ttyUSB0; without it the core is simulated.
"""

import sys

from meissner import host
from meissner.host.view import heat_map


def main(port="sim:walk_25x5", images=3):
    with host.connect(port) as core:
        print(f"an array of {core['core.size.rows']}×{core['core.size.columns']}")
        cop = None
        for packet in core.packets():
            if isinstance(packet, host.CopFrame):
                cop = packet
            elif isinstance(packet, host.Image) and cop is not None:
                place = f"x {cop.x:+.3f}  y {cop.y:+.3f}" if cop.pressed else "not pressed"
                print(f"{packet.time_s:.3f} s  {place}  load {cop.load}")
                images -= 1
                if not images:
                    print(*heat_map(packet.taxels), sep="\n")
                    return


if __name__ == "__main__":
    main(*sys.argv[1:])
