"""Which checks the files that changed since a commit concern.

A change of a block's source concerns all kinds of checks of the block itself, and of the blocks that contain
it the kinds in AROUND. Mutants and coverage are of a block's own lines and tests, so those of the blocks
around it stay what they are.
"""

import re
import subprocess
import tomllib

from meissner.builds import toolchain
from nightly import benches, evidence, proofs

ROOT = toolchain.ROOT
KINDS = ("proofs", "netlists", "faults", "mutants", "coverage")  # boards take too long: only if asked
AROUND = ("proofs", "netlists", "faults")
TABLES = {"tb/formal/proofs.toml", "tb/coverage/waivers.toml", "tb/limits.toml"}
SHARED = re.compile(r"tools/nightly/.*|tb/\w+\.py|tb/(harness|reference)/.*")  # what all blocks rest on


def git(*arguments):
    done = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True)
    if done.returncode:
        raise ValueError(f"git: {done.stderr.strip().splitlines()[0]}")
    return done.stdout


def changed(ref):
    """Paths of the files that differ from ``ref``, and of new files that git does not track yet."""
    new = git("ls-files", "--others", "--exclude-standard")
    return sorted({*git("diff", "--name-only", ref, "--").splitlines(), *new.splitlines()})


def concerned(paths, ref):
    """({(kind, block): whether the block itself changed}, the paths in SHARED among ``paths``)."""
    found, shared = {}, []

    def add(kinds, names, own=True):
        for key in [(kind, name) for kind in kinds for name in names]:
            found[key] = found.get(key, False) or own

    for path in paths:
        name = path.rpartition("/")[2].rpartition(".")[0]
        if path in TABLES:
            for kind, names in rows_changed(path, ref):
                add([kind], names)
        elif re.fullmatch(r"rtl/.*/msn_\w+\.sv|rtl/msn_\w+\.sv", path):
            inside = name.removeprefix("msn_")
            add(KINDS, {inside} & {*benches.blocks()})
            add(AROUND, [block for block in benches.blocks() if inside in benches.inner(block)], own=False)
        elif path.startswith("model/meissner/twins/"):
            add(("mutants", "coverage"), twin_of(path))
        elif path.startswith("tb/formal/"):
            add(["proofs"], [proof.block for proof in proofs.proofs().values() if reads(proof, name)])
        elif path.startswith("tb/coverage/cover_"):
            add(["coverage"], [name.removeprefix("cover_")])
        elif SHARED.fullmatch(path):
            shared.append(path)
        elif path.startswith("tb/"):
            tests = [block for block in benches.blocks() if ROOT / path in evidence.tests_of(block)]
            add(("netlists", "faults", "mutants", "coverage"), tests)
    return found, shared


def reads(proof, name):
    """Whether the harness of a proof is tb/formal/<name>.sv or names it."""
    return name == proof.name or name in (ROOT / f"tb/formal/{proof.name}.sv").read_text("utf-8")


def twin_of(path):
    """The blocks that the twins in ``path`` name; of a file that names none, those whose tests import it."""
    package, _, name = path.removeprefix("model/meissner/").removesuffix(".py").rpartition("/")
    text = (ROOT / path).read_text("utf-8") if (ROOT / path).exists() else ""
    named = re.findall(r"\bmsn_(\w+)\.sv", text)
    if named:
        return [block for block in benches.blocks() if block in named]
    used = re.compile(rf"meissner\.{package.replace('/', '[.]')}(\.{name}\b| import .*\b{name}\b)")
    texts = {block: evidence.path_of(block).read_text("utf-8") for block in benches.blocks()}
    return [block for block, text in texts.items() if used.search(text)]


def rows_changed(path, ref):
    """(kind, blocks) of each row of a table that differs from the one in ``ref``."""
    there = subprocess.run(["git", "show", f"{ref}:{path}"], cwd=ROOT, capture_output=True, text=True)
    before, now = rows(path, there.stdout), rows(path, (ROOT / path).read_text("utf-8"))
    for row in [row for row in before + now if row not in before or row not in now]:
        yield row[0], [block for block in benches.blocks() if block in row[1] or row[1] == ["*"]]


def rows(path, text):
    """[(kind, blocks, row)] of a table."""
    table = tomllib.loads(text)
    if path.endswith("proofs.toml"):
        return [("proofs", [row.get("block", name)], row) for name, row in table.items()]
    if path.endswith("waivers.toml"):
        return [("coverage", row["block"].split(), row) for row in table.get("waiver", ())]
    listed = [
        (kind, row)
        for kind, entry in table.items()
        for rows in entry.values()
        if isinstance(rows, list)
        for row in rows
    ]
    waived = table.get("coverage", {}).get("waived", {})
    found = [(kind, row.get("blocks", [row.get("block")]), row) for kind, row in listed]
    return found + [("coverage", [block], count) for block, count in waived.items()]
