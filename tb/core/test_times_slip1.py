"""The smallest core, one channel of an MCP3208 and only slip packets on the line: each packet has the clock
of the CS edge that began the deciding conversion, at any phase of the sender's sweep; the pins show each
detail's state. Settings are constants; events are those of a loop written from docs/slip.md."""

import cocotb
import numpy as np

import bench
from core import pins
from core.test_settings_channels import CONTACT, GROSS, INCIPIENT, Contact
from meissner.twins.link.registers import RESET_BITS, reset_word
from parts.mcp3208 import Mcp3208

PERIOD, WINDOW = 397, 4
SETTINGS = {
    **{"threshold": 201, "gross_threshold": 603, "contact_level": 2000, "release_level": 1500},
    **{"contact_rises": 1, "hold": 1, "refractory": 2, "blank": 3},
}


class Line(pins.LineHost):
    bit = 8


def scene():
    """Held at 1500, with a step in every sixth detail: each comes in another phase of the sweep."""
    codes = np.full(2 * 80, 1500)
    codes[12::12] += np.tile([202, 203, 201, 604, 603], 3)[: len(codes[12::12])]
    return codes


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def each_event_carries_its_converts_clock(dut):
    codes, contact = scene(), Contact()

    def part(dut):
        taken = iter(codes.tolist())
        code = lambda channel, _: next(taken, 1500)
        return Mcp3208(dut.adc_cs_n_o, dut.adc_sclk_o, dut.adc_mosi_o, dut.adc_miso_i, code)

    host, _ = await pins.begin(dut, part, Line)
    starts = pins.Edges(host, dut.adc_cs_n_o, to=0)
    flags, wanted, states = [], [], [0]
    for n in range(len(codes)):
        while len(starts.at) <= n:
            await pins.rest(dut, 5)
        await pins.rest(dut, PERIOD - 30)
        if n % 2:
            flags.append([bench.read(getattr(dut, f"{name}_o")) for name in ("touched", "gross", "slip")])
    await pins.rest(dut, 12 * PERIOD)
    found = [(starts.at.index(packet.time), pins.slip_of(packet)) for packet in host.of_kind(pins.SLIP)]
    expected = []
    for detail in range(len(codes) // 2):
        event, _ = contact.step(*codes[2 * detail : 2 * detail + 2].tolist(), detail, False, SETTINGS)
        if event:
            expected.append((2 * detail + 1, (0, *event)))
        states.append(contact.state)
        slips = contact.state in (INCIPIENT, GROSS)
        wanted.append([int(slips or contact.state == CONTACT), int(contact.state == GROSS), int(slips)])
    assert set(np.diff(starts.at)) == {PERIOD}
    assert len({starts.at[frame] % 64 for frame, _ in expected}) == len(expected) > 5
    assert found == expected
    assert flags == wanted
    changes = [
        (starts.at[2 * place - 1], 0, states[place - 1], state)
        for place, state in enumerate(states)
        if place and state != states[place - 1]
    ]
    assert pins.changes_of(host.packets) == changes and len(changes) > len(expected) + 3


def test_times_slip1():
    build = {"Adc": 1, "ClkKhz": 4000, "AdcPeriod": PERIOD, "BaudHz": 500_000, "Serial": 1, "SlipOnly": 1}
    build |= {"Registers": 0, "Statistics": 0, "SampleBits": 13, "TimerBits": 10}
    build |= {"Window": WINDOW, "Hop": WINDOW}
    word = reset_word({"adc.enable": 1} | {f"slip.{name}": value for name, value in SETTINGS.items()})
    bench.run("core", "core", build | {"Resets": f"{RESET_BITS}'h{word:x}"}, module="test_times_slip1")
