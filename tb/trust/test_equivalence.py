"""The proofs of tools/equivalence.py on small blocks: they hold, but not of a netlist or a reset that is wrong.

Bugs are planted in the bits: an inverter before a register or at an operand, an output stuck, a reset not heard.
"""

import subprocess
import sys
from dataclasses import replace
from functools import cache

import pytest

from meissner import toolchain
from meissner.trust import circuit, netlist_proof, reset_proof

TOOL = [sys.executable, "tools/equivalence.py"]


def folder(block):
    return f"build/equivalence/test_{block}"


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
    assert reset_proof.prove(source, task) == []  # no word is kept aside after reset: it comes from the input
    source = bits("round_sat")["source"]
    task = reset_proof.Task(qualifiers={"out_data_o": "out_valid_o !out_valid_o"})
    assert reset_proof.prove(source, task) == ["out_data_o"]


def test_refuses_an_unknown_block():
    done = subprocess.run([*TOOL, "nosuch"], cwd=toolchain.ROOT, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (2, "equivalence: rtl/rtl.f has no block nosuch\n")
