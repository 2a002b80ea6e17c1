"""The proofs of netlists and resets on small blocks: they hold, and they fail for a wrong netlist or a wrong
reset.

Bugs are planted in the netlist's bits: an inverter before a register or at an operand, an output stuck, a
reset that is ignored.
"""

import os
from dataclasses import replace
from functools import cache

import pytest

from meissner.builds import toolchain
from nightly import circuit, netlist_proof, netlists, reset_proof, two_copies


def folder(block):
    """A folder for this process, as others may plant another fault into the same block."""
    return f"build/netlists/test_{block}_{os.getpid()}"


@cache
def bits(block):
    return circuit.synthesise(block, {}, folder(block))


@pytest.mark.parametrize("block", ["skid", "frame_gate", "round_sat"])
def test_netlist_is_proven_and_so_is_the_reset(block):
    made = bits(block)
    for family in circuit.FAMILIES:
        assert netlist_proof.prove(made["source"], made[family], folder(block), family) == []
    assert reset_proof.prove(made["source"]) == []


def inverted_register(netlist):
    register, after = next(iter(netlist.registers.items()))
    return replace(
        netlist, registers=netlist.registers | {register: "bug"}, gates=netlist.gates | {"bug": (after,)}
    )


def inverted_operand(netlist):
    gate = netlist.outputs["out_data_o", 5]
    while len(netlist.gates[gate]) == 1:  # an inverter
        [gate] = netlist.gates[gate]
    first, second = netlist.gates[gate]
    return replace(netlist, gates=netlist.gates | {"bug": (second,), gate: (first, "bug")})


def stuck_output(netlist):
    return replace(netlist, outputs=netlist.outputs | {("out_data_o", 3): "0"})


@pytest.mark.parametrize("plant", [inverted_register, inverted_operand, stuck_output])
def test_bug_in_the_netlist_is_found(plant):
    made = bits("skid")
    assert netlist_proof.prove(made["source"], plant(made["ecp5"]), folder("skid"), "bug")


MISWIRED = {  # in msn_cop: the text, and its replacement
    "input": (".in_last_i,", ".in_last_i(in_valid_i),"),
    "inputs changed over": (".in_mx_i(mx)", ".in_mx_i(my)"),
    "reset": (".rst_i,", ".rst_i(1'b0),"),
}


def around(monkeypatch, families, old="", new=""):
    """msn_cop's bits with its inner blocks as boxes, ``old`` replaced by ``new`` in its file."""
    copy = toolchain.ROOT / folder("cop") / "msn_cop.sv"
    copy.parent.mkdir(parents=True, exist_ok=True)
    text = (toolchain.ROOT / "rtl/cop/msn_cop.sv").read_text()
    assert old in text
    copy.write_text(text.replace(old, new, 1))
    with monkeypatch.context() as patch:
        listed = [copy if path.name == copy.name else path for path in toolchain.sources_of("msn_cop")]
        patch.setattr(toolchain, "sources_of", lambda top: listed)
        return circuit.synthesise("cop", {}, folder("cop"), families, cut=True)


def test_a_block_is_proven_around_the_blocks_in_it(monkeypatch):
    made = around(monkeypatch, circuit.FAMILIES)
    assert circuit.boxes(made["source"]) == ["cop_accumulate", "cop_divide"]
    for family in circuit.FAMILIES:
        assert netlist_proof.prove(made["source"], made[family], folder("cop"), family) == []


@pytest.mark.parametrize("plant", MISWIRED)
def test_wrong_wire_between_blocks_is_found(plant, monkeypatch):
    source = around(monkeypatch, ())["source"]
    netlist = around(monkeypatch, ["ecp5"], *MISWIRED[plant])["ecp5"]
    assert netlist_proof.prove(source, netlist, folder("cop"), "bug")


def test_what_yosys_reads_otherwise_is_found(monkeypatch):
    """~Bits'(1) of three bits is 6, but 1 in Yosys' own reader: both sides look alike if that reads both."""
    copy = toolchain.ROOT / folder("pwm") / "msn_pwm.sv"
    copy.parent.mkdir(parents=True, exist_ok=True)
    text = (toolchain.ROOT / "rtl/actuate/msn_pwm.sv").read_text()
    assert text.count("{{(Bits - 1){1'b1}}, 1'b0}") == 1
    copy.write_text(text.replace("{{(Bits - 1){1'b1}}, 1'b0}", "~Bits'(1)"))
    monkeypatch.setattr(toolchain, "sources_of", lambda top: [toolchain.ROOT / "rtl/msn_pkg.sv", copy])
    found = {}
    for slang in (True, False):
        made = circuit.synthesise("pwm", {"Bits": 3}, folder("pwm"), ["ecp5"], slang=slang)
        found[slang] = netlist_proof.prove(made["source"], made["ecp5"], folder("pwm"), "read")
    assert "pwm_o" in found[True] and found[False] == []


def test_reset_that_is_not_heard_is_found():
    source = bits("skid")["source"]
    reset = source.inputs["rst_i", 0]

    def deaf(operands):
        return tuple("0" if bit == reset else bit for bit in operands)

    gates = {bit: deaf(operands) for bit, operands in source.gates.items()}
    assert "in_ready_o" in reset_proof.prove(replace(source, gates=gates))


def test_payload_counts_only_while_it_is_valid():
    source = bits("skid")["source"]
    task = reset_proof.Task(qualifiers={"out_data_o": "in_ready_o !in_ready_o"})  # always
    assert reset_proof.prove(source, task) == []  # after reset no word is kept aside
    source = bits("round_sat")["source"]
    task = reset_proof.Task(qualifiers={"out_data_o": "out_valid_o !out_valid_o"})
    assert reset_proof.prove(source, task) == ["out_data_o"]


@pytest.mark.parametrize("block", ["delay", "multiply", "adc_store", "uart_rx"])
def test_resets_hold_with_what_is_taken_for_granted(block):
    chosen = netlists.parameters(block, "size", "reset_size")
    assert netlists.prove_reset(block, chosen)["reset"]["proven"]


def test_a_reset_fails_without_what_is_taken_for_granted():
    """A frame that begins in the same clock as a word shows a code from before the reset."""
    chosen = netlists.parameters("adc_store", "size")
    source = circuit.synthesise("adc_store", chosen, folder("adc_store"), ())["source"]
    assert "out_data_o" in reset_proof.prove(source)


def test_a_state_while_a_bit_is_0_is_a_condition():
    """Whether msn_adc_spi drops a frame is defined while it reads, except in the first clock of reading."""
    chosen = netlists.parameters("adc_spi", "size")
    source = circuit.synthesise("adc_spi", chosen, folder("adc_spi"), ())["source"]
    task = netlists.task_of("adc_spi")
    assert reset_proof.prove(source, task) == []
    assert "dropped_o" in reset_proof.prove(source, replace(task, joined=()))
    with pytest.raises(ValueError, match="nothing of the state is called nosuch"):
        two_copies.conditions(source, [("nosuch", "!convert_o")])
