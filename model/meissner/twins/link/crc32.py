"""Bit-exact twin of rtl/link/msn_crc32.sv: CRC-32, ISO-HDLC."""

from meissner.twins.shared import within

START, RESIDUE = 0xFFFFFFFF, 0xDEBB20E3


def crc32(values, bits=8, start=START):
    """The register after ``values`` of ``bits`` bits each, lowest first; the checksum is its complement."""
    within(bits=(bits, 1, 32))
    crc = start
    for value in values:
        for place in range(bits):
            feedback = (crc ^ value >> place) & 1
            crc = crc >> 1 ^ (0xEDB88320 if feedback else 0)
    return crc
