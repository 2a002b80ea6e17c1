"""What a block's tests state about its evidence: EVIDENCE, a literal in tb/<stage>/test_<block>.py.

    EVIDENCE = {"equivalence": {"size": {"Depth": 7}}, "faults": {"settle": 12}}

{kind: {key: value}}, read without importing the file; KEYS lists every key and its meaning. A missing kind,
or {} for all, keeps the tool's defaults: the first size in the block's tests, nothing left out. Proofs
(tb/formal/proofs.toml), coverage exclusions (tb/coverage/waivers.toml) and mutants judged by hand
(tb/verify/equivalent.toml) are in separate files, since a proof or a waiver may concern several blocks.
"""

import ast
from functools import cache

from meissner.builds import toolchain
from verify import benches

NAME = "EVIDENCE"
KEYS = {  # {kind: {key: (type, meaning)}}
    "reference": {
        "against": (str, "what the twin is checked against, in docs/references.md"),
        "test": (str, "the test that does so, as pytest names it"),
        "moves": (str, "in place of these: what the block moves, as it computes nothing"),
        "joins": (str, "or the blocks that it joins"),
    },
    "equivalence": {
        "size": (dict, "which of the tests' sizes: a small memory, but more than one of each thing"),
        "reset_size": (dict, "the same of the reset's proof, where that takes a smaller one"),
        "defined": (bool, "synthesis makes use of what the source leaves undefined: that reads 0 in both"),
        "boxes": (bool, "the netlist is proven around the blocks in it, which have proofs of their own"),
        "yosys": (str, "why Yosys' own reader reads the source, too, in place of slang"),
        "open": (list, "kinds of proof that are not proven; docs/equivalence.md says why"),
        "reset": (dict, "arguments of verify.reset_proof.Task: what the reset's proof assumes"),
    },
    "mutants": {
        "whole": (bool, "every mutant is to be killed, and more of them are drawn"),
        "sets": (list, "places in the list of the tests' sizes, in place of some of them"),
        "limit": (int, "seconds that the tests of a size may take"),
        "unsolved": (bool, "ask the solver of a single clock only: the others would not end"),
    },
    "faults": {
        "none": (str, "why no faults are injected"),
        "size": (dict, "which of the tests' sizes"),
        "short": (dict, "parameters of no test: timers that end while a recording lasts"),
        "program": (dict, "parameters of the program that are not those of the recording"),
        "inside": (
            list,
            "the block in which this one is run, as it waits for others there, and the instance",
        ),
        "settle": (int, "frames until what a fault left behind has gone, if more than the one it hits"),
        "driver": (dict, "what the driver needs to know: options of tools/verify/faults_driver.cpp"),
        "kept_inside": (dict, "{instance: block}: what that block keeps by design is kept there"),
        "keeps_settings": (bool, "the registers' settings are kept by design"),
        "writes": (list, "further runs with these options: writes to registers while it measures"),
    },
    "icarus": {
        "refused": (str, "why Icarus Verilog cannot run it, nor a block around it"),
        "runs": (dict, "of a refused block the size that it does run"),
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


def statement(tree):
    """The assignment to EVIDENCE among the statements of a file; None if there is none."""
    for node in tree.body:
        if isinstance(node, ast.Assign) and [getattr(target, "id", "") for target in node.targets] == [NAME]:
            return node
    return None


@cache
def _read(text, name):
    found = statement(ast.parse(text))
    if found is None:
        raise ValueError(f"{name} has no {NAME}: a literal dict, {{}} if the tools' defaults will do")
    try:
        told = ast.literal_eval(found.value)
    except ValueError:
        raise ValueError(f"{name}: {NAME} is not a literal, line {found.lineno}") from None
    if wrong := refused(told):
        raise ValueError(f"{name}: {wrong}")
    return told


def refused(told):
    """The error sentence for what a file states; empty if nothing is wrong."""
    if not isinstance(told, dict):
        return f"{NAME} is not a dict"
    for kind, entry in told.items():
        if kind not in KEYS:
            return f"{NAME} has no kind {kind!r}; there are {', '.join(KEYS)}"
        if not isinstance(entry, dict):
            return f"{NAME}[{kind!r}] is not a dict"
        for key, value in entry.items():
            if key not in KEYS[kind]:
                return f"{NAME}[{kind!r}] has no key {key!r}; there are {', '.join(KEYS[kind])}"
            wanted = KEYS[kind][key][0]
            if type(value) is not wanted:
                return f"{NAME}[{kind!r}][{key!r}] is {value!r}, not a {wanted.__name__}"
    return ""


def of(block, kind):
    """{key: value} that the block's tests state for a kind; ValueError with one sentence if it is invalid."""
    path = path_of(block)
    name = path.relative_to(toolchain.ROOT)
    if not path.exists():
        raise ValueError(f"msn_{block} has no tests: {name} does not exist")
    return _read(path.read_text("utf-8"), str(name)).get(kind, {})


def resting(block, kind):
    """{block: what its tests state for the kind}, for the block and for the blocks that it names there."""
    found, waiting = {}, [block] if kind in KEYS else []
    while waiting:
        name = waiting.pop()
        if name not in found:
            found[name] = of(name, kind)
            waiting += [*found[name].get("inside", [])[:1], *found[name].get("kept_inside", {}).values()]
    return {name: entry for name, entry in sorted(found.items()) if entry}


def refusal(blocks):
    """The error sentence for the first of ``blocks`` (default: all) that does not exist or whose tests state
    something invalid; empty if all are valid."""
    known = benches.blocks()
    for block in blocks or known:
        if block not in known:
            return f"rtl/rtl.f has no block {block}"
        try:
            of(block, "")
        except ValueError as error:
            return str(error)
    return ""


def fits(size, parameters):
    """Whether a size of the tests, {name: text}, has the values that an entry asks for."""
    return all(parameters.get(name) == str(value) for name, value in size.items())
