"""What a block's tests state for the nightly checks: EVIDENCE, a literal in tb/<stage>/test_<block>.py.

    EVIDENCE = {"equivalence": {"size": {"Depth": 7}}, "faults": {"settle": 12}}

{kind: {key: value}}, read without importing the file; KEYS lists every key. A missing kind, or {} for all,
keeps the defaults: the first size in the block's tests, nothing left out. What may be open, waived or
undetected is not stated here but in tb/limits.toml.
"""

import ast
from functools import cache

from meissner.builds import toolchain
from nightly import benches

NAME = "EVIDENCE"
KEYS = {  # {kind: {key: type}}
    "equivalence": {  # of the netlist and of the reset
        "size": dict,  # which of the tests' sizes: a small memory, but more than one of each thing
        "reset_size": dict,  # the same for the reset's proof, where that takes a smaller one
        "defined": bool,  # synthesis makes use of what the source leaves undefined: that reads 0 in both
        "boxes": bool,  # the netlist is proven around the blocks in it, which have proofs of their own
        "yosys": str,  # why Yosys' own reader reads the source, too, in place of slang
        "reset": dict,  # arguments of nightly.reset_proof.Task: what the reset's proof assumes
    },
    "mutants": {
        "whole": bool,  # a mutant for each line of the source, in place of 25
        "sets": list,  # places in the list of the tests' sizes, in place of some of them
        "limit": int,  # CPU seconds that the tests of a size may take
        "unsolved": bool,  # ask the solver of a single clock only: the others would not end
    },
    "faults": {
        "none": str,  # why no faults are injected
        "size": dict,  # which of the tests' sizes
        "more": list,  # further ones, for parts of the block that a parameter chooses
        "short": dict,  # parameters of no test: timers that end while a recording lasts
        "program": dict,  # parameters of the program that are not those of the recording
        "inside": list,  # the block in which this one is run, as it waits for others there, and the instance
        "settle": int,  # frames until what a fault left behind has gone, if more than the one it hits
        "driver": dict,  # options of tools/nightly/faults_driver.cpp
        "kept_inside": dict,  # {instance: block}: what that block keeps by design is kept there
        "keeps_settings": bool,  # the registers' settings are kept by design
        "writes": list,  # further runs with these options: writes to registers while it measures
    },
    "icarus": {
        "refused": str,  # why Icarus Verilog cannot run it, nor a block around it
        "runs": dict,  # the size of a refused block that it does run
    },
}


def path_of(block):
    """The test file of a block."""
    return toolchain.ROOT / f"tb/{benches.stage_of(block)}/test_{block}.py"


def tests_of(block):
    """Its test files: test_<block>.py and each test_<block>_*.py, unless a longer name of a block fits."""
    own = path_of(block)
    longer = [f"test_{name}_" for name in benches.blocks() if name.startswith(f"{block}_")]
    more = sorted(own.parent.glob(f"test_{block}_*.py"))
    return [own, *(path for path in more if not f"{path.stem}_".startswith(tuple(longer)))]


@cache
def _read(text, name):
    for node in ast.parse(text).body:
        if isinstance(node, ast.Assign) and [getattr(target, "id", "") for target in node.targets] == [NAME]:
            try:
                told = ast.literal_eval(node.value)
            except ValueError:
                raise ValueError(f"{name}: {NAME} is not a literal, line {node.lineno}") from None
            _check(told, name)
            return told
    raise ValueError(f"{name} has no {NAME}: a literal dict, {{}} if the defaults will do")


def _check(told, name):
    for kind, entry in told.items():
        if kind not in KEYS:
            raise ValueError(f"{name}: {NAME} has no kind {kind!r}; there are {', '.join(KEYS)}")
        for key, value in entry.items():
            wanted = KEYS[kind].get(key)
            if wanted is None:
                known = ", ".join(KEYS[kind])
                raise ValueError(f"{name}: {NAME}[{kind!r}] has no key {key!r}; there are {known}")
            if type(value) is not wanted:
                raise ValueError(f"{name}: {NAME}[{kind!r}][{key!r}] is {value!r}, not a {wanted.__name__}")


def of(block, kind):
    """{key: value} that the block's tests state for a kind; ValueError with one sentence if it is invalid."""
    path = path_of(block)
    name = path.relative_to(toolchain.ROOT)
    if not path.exists():
        raise ValueError(f"msn_{block} has no tests: {name} does not exist")
    return _read(path.read_text("utf-8"), str(name)).get(kind, {})


def fits(size, parameters):
    """Whether a size of the tests, {name: text}, has the values that an entry asks for."""
    return all(parameters.get(name) == str(value) for name, value in size.items())
