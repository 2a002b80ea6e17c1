"""Bit-exact twin of rtl/frontend/msn_health_report.sv: events of beats to reports of single taxels."""

from meissner.twins.shared import LANES, one_of

DEAD, RAILED, BLINKING = 1, 2, 4


def reports(events, lanes):
    """(taxel, faults) of ``events``: (id of the beat, dead, railed, blinking), a bit for each lane."""
    one_of(LANES, lanes=lanes)
    found = []
    for beat, dead, railed, blinking in events:
        for lane in range(lanes):
            kinds = ((dead, DEAD), (railed, RAILED), (blinking, BLINKING))
            faults = sum(kind for bits, kind in kinds if bits >> lane & 1)
            found += [(beat * lanes + lane, faults)] if faults else []
    return found
