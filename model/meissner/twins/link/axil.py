"""Twin of rtl/link/msn_axil.sv: the AXI4-Lite response of an access to the registers."""

OKAY, SLVERR = 0, 2


def write(registers, address, data, strobe=15):
    """BRESP of a write to ``registers`` (link.registers.Registers, or an object with its ``access``)."""
    return SLVERR if registers.access(True, address, data, strobe)[1] else OKAY


def read(registers, address, status=None):
    """(RDATA, RRESP) of a read."""
    data, error, _ = registers.access(False, address, status=status)
    return data, SLVERR if error else OKAY
