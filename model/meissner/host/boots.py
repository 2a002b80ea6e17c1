"""Where in a stream the core was reset, and how many packets were lost: from packet numbers and times alone.

A core numbers its packets from 0 after a reset. Before the next reset the times of one kind of packet never
go back, and two CoP frames, or two images, never have the same time. So a packet is the first one received
after a reset if it does not continue the numbers, unless with 0, and its time lies before that of the last
packet of its kind. If packets are missing before it, it is also the first one if its time is that of the last
packet of its kind, or if it has number 0 and the line could not have carried the missing packets since the
newest time. Of an answer only the time counts, and of statistics too.
"""

from meissner.twins.link import packet as p
from meissner.twins.link.decoder import Packet

# A time that goes back means a reset, unless the 48-bit time wrapped around (after 33 days at 100 MHz): then
# at most this many clocks lie between the two.
LONGEST_SILENCE = 1 << 40
CLOCKS = 600  # of the shortest packet: 15 bytes on the line, 10 bits each, of 4 clocks
SAME = {p.ANSWER: p.STATISTIC}  # both are stamped when they are sent
MANY = 16  # missing packets, too many for noise between two packets


def _back(time: int, last: int) -> bool:
    return time < last and time + p.TIMES - last > LONGEST_SILENCE


class Boots:
    """``next`` takes the packets of a stream and returns (whether the core was reset before this one, packets
    lost before it); ``restart`` says that a reset came before the next packet."""

    def __init__(self) -> None:
        self.restart()
        self._number: int | None = None  # of the last packet

    def restart(self) -> None:
        self._number = -1
        self._newest: int | None = None  # time in this boot
        self._last: dict[int, int] = {}  # of each kind

    def next(self, packet: Packet) -> tuple[bool, int]:
        if self._number is None:
            self._number = packet.number - 1
        missing = (packet.number - self._number - 1) % 256
        reset = packet.kind in p.KNOWN and self._is_first(packet, missing)
        if reset:
            self.restart()
            missing = packet.number
        self._number = packet.number
        if packet.kind in p.KNOWN:
            self._last[SAME.get(packet.kind, packet.kind)] = packet.time
            if self._newest is None or (packet.time - self._newest) % p.TIMES < p.TIMES // 2:
                self._newest = packet.time
        return reset, missing

    def _is_first(self, packet: Packet, missing: int) -> bool:
        kind, time = SAME.get(packet.kind, packet.kind), packet.time
        last = self._last.get(kind)
        if last is not None and _back(time, last):
            return missing > 0 or packet.number == 0 or kind == p.STATISTIC
        later_part = packet.fields.get("first", 0) > 0
        if not missing or self._newest is None or packet.kind == p.ANSWER or later_part:
            return False
        if time == last:
            return packet.number == 0 or packet.kind in (p.COP, p.IMAGE)
        since = (time - self._newest) % p.TIMES
        fast = missing >= MANY and since < CLOCKS * missing
        return packet.number == 0 and (fast or _back(time, self._newest))
