"""Stream a recording through the integer twins of the slip path, block by block, and print the slip events.

    python examples/stream_recording.py [IN.npy [THRESHOLD]]

IN has codes, [samples] or [channels, samples], at 10 kHz; without it a pulled plate is simulated.
"""

import sys

from meissner import engines, readers, scenes
from meissner.host import Units, packets
from meissner.host.sensors import blocks_of, settings_of, slip_source
from meissner.host.simulated import SimulatedCore
from meissner.twins.link.decoder import Decoder
from meissner.twins.slip.config import SlipConfig


def main(path=None, threshold=40):
    scene = scenes.load("acrylic_slip")
    if path is None:
        codes, config = scenes.simulate(scene).codes, scene.slip_config()
    else:
        codes = engines.check_samples(readers.read(path).scaled()[0])
        config = SlipConfig(threshold=int(threshold), contact_level=-(1 << 17), release_level=-(1 << 17))
    source = slip_source(blocks_of(codes, config.level), scene.rate_hz, config.window, config.hop)
    core = SimulatedCore(source, settings=settings_of(config), level=config.level)
    decoder, assembler = Decoder(), packets.Assembler(Units(clk_khz=core.clk_khz))
    count = 0
    while data := core.read(4096):  # the bytes that a core would send over its serial line
        for packet in decoder.next(data):
            event = assembler.next(packet)
            count += isinstance(event, packets.SlipEvent)
            print(
                f"{event.time_s:.4f} s: channel {event.channel}, {event.state.name.lower()}, p2p {event.p2p}"
            )
    print(f"{count} slip events")


if __name__ == "__main__":
    main(*sys.argv[1:])
