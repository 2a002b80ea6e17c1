"""Makes the small complete files from which `make fuzz` starts: python tb/corpus/make.py."""

from pathlib import Path

import numpy as np

from meissner import host
from meissner.builds import units
from meissner.host import line, log
from meissner.host.simulated import SimulatedCore
from meissner.twins.link import packet as p
from meissner.twins.link.cobs import encode

HERE = Path(__file__).parent


def main():
    for name in ("packets", "recordings", "calibration", "log"):
        (HERE / name).mkdir(exist_ok=True)
    packets = [p.packet(p.SLIP, n, n << 30, p.slip_event(n, n * n, 2)) for n in range(6)]
    packets += [
        p.packet(p.IMAGE, 6 + n, 5, chunk) for n, chunk in enumerate(p.image_chunks(3, list(range(150))))
    ]
    packets += [p.packet(p.COP, 9, 6, p.cop_frame(-5, 7, 99, 1)), p.packet(p.HEALTH, 10, 7, p.health(5, 6))]
    packets += [p.packet(77, 11, 8, bytes(range(40)))]
    (HERE / "packets/line.bin").write_bytes(b"".join(map(encode, packets)))
    rng = np.random.default_rng(1)
    codes = rng.integers(0, 4096, (4, 2, 3))
    np.save(HERE / "recordings/codes.npy", codes.astype(np.int16))
    np.savetxt(HERE / "recordings/samples.csv", codes[0].T, delimiter=",", fmt="%d", header="x, y")
    probed = np.array([[0, 0], [1, 2], [-1, -1], [0, 1]])
    np.savez(HERE / "recordings/press.npz", codes=codes, force_n=np.array([1.0, 2, 0, 3]), probed=probed)
    known = {"offset": codes[0], "gain": codes[1], "gain_shift": 12, "dead": codes[0] > 3000}
    np.savez(HERE / "calibration/small.npz", **known, force_lsb_n=1e-3)
    taxels = rng.integers(0, 65536, 12).tolist()
    for kind in ("npz", "mcap"):
        model = SimulatedCore(size=(3, 4), clk_khz=1000)
        path = HERE / f"log/small.{kind}"
        with (
            host.Core(line.Pipe(model), units.Units(newtons_per_code=0.25)) as core,
            log.recording(path, core) as out,
        ):
            model.say(p.COP, 1000, p.cop_frame(5, -6, 700, 1))
            for part in p.image_chunks(1, taxels, 5):
                model.say(p.IMAGE, 1000, part)
            model.say(p.SLIP, 1500, p.slip_event(3, 99, 3))
            model.say(p.HEALTH, 1600, p.health(2, 5))
            model.say(p.STATISTIC, 1700, p.statistic(1, 4))
            for item in core.packets(0.05):
                out.add(item)


if __name__ == "__main__":
    main()
