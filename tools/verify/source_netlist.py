"""Mutants of a block's source in one netlist, like that of mutate.netlist for changed cells.

    netlist(run, count, seed, folder)     [Mutant, ...], and how many exist; writes mutate.netlist's files

Changes that can be combined are in one text, each selected by its number on `mutsel`. A change of a constant
makes another block: the netlist has one copy of the block for each, side by side, and `mutsel` selects whose
outputs are used. A change that the project's lint reports (style rules apart), or with which the block does
not elaborate, is not used; another one is drawn instead.
"""

import re
import subprocess
from itertools import islice

from meissner.builds import toolchain
from meissner.builds.yowasp import ROOT, ToolError, chparam, yosys
from verify import mutate, source_mutants, source_text
from verify.mutate import BITS, INNER, SYNTHESIS, Mutant

BLOCK = "plain"  # the module with the combined changes, if there are copies
LINT = ("verilator", "--lint-only", "--quiet", "-Wall", "-Wno-style", "rtl/verilator.vlt")


class Source:
    """The block of a run (an entry of benches.runs) with changes in its source; files go to ``folder``."""

    def __init__(self, run, folder):
        self.run, self.folder, self.block = run, folder, f"msn_{run['block']}"
        self.paths = toolchain.sources_of(self.block)
        self.text = source_mutants.read(self.paths[-1])
        elaborated = source_mutants.elaborate(self.paths, self.block, run["parameters"])
        self.changes = source_mutants.changes(self.text, elaborated)
        (ROOT / folder).mkdir(parents=True, exist_ok=True)

    def write(self, name, text):
        """The sources, with the block's own replaced by ``text``, which is written to a folder ``name``."""
        path = ROOT / self.folder / name / self.paths[-1].name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
        return [str(source.relative_to(ROOT)) for source in (*self.paths[:-1], path)]

    def together(self, changes):
        """The text with all changes that can be combined; they are numbered from 1."""
        numbered = {number: change for number, change in enumerate(changes, 1) if change}
        return source_text.together(self.text, numbered, len(changes).bit_length())

    def elaborate(self, texts):
        """Write folder/<name>.il for each of {name: (text, commands)}, with its block as module ``name``.

        ToolError if Yosys refuses one.
        """
        script = []
        for name, (text, more) in texts.items():
            sources = " ".join(self.write(name, text))
            kept = " ".join(f"{name}/w:{wire}" for wire in mutate.named(self.run))
            script.append(
                f"design -reset; read_verilog -sv {sources}; {chparam(self.block, self.run['parameters'])}"
                f"hierarchy -check -top {self.block}; rename -top {name}; setattr -set keep 1 {kept}; "
                f"{more}{SYNTHESIS}; write_rtlil {self.folder}/{name}.il"
            )
        (ROOT / self.folder / "read.ys").write_text("\n".join(script) + "\n")
        yosys(f"script {self.folder}/read.ys", f"{self.folder}/read.log")

    def elaborates(self, change):
        """Whether Yosys reads the block with this change."""
        text = source_text.alone(self.text, change) if change.constant else self.together([change])
        try:
            self.elaborate({"tried": (text, "")})
        except ToolError:
            return False
        return True

    def refused(self, change):
        """Whether the project's lint, style rules apart, reports the change at these parameters."""
        if not hasattr(self, "fine"):
            self.fine = not self.lint(self.text)
        return self.fine and self.lint(source_text.alone(self.text, change))

    def lint(self, text):
        given = [f"-G{name}={value}" for name, value in self.run["parameters"].items()]
        command = [*LINT, "--top-module", self.block, *given, *self.write("lint", text)]
        done = subprocess.run(command, cwd=ROOT, env=toolchain.environment(), capture_output=True, text=True)
        return bool(done.returncode or done.stderr.strip())

    def drawn(self, known, seeds):
        """The changes in ``known`` that pass the lint, in the order in which the seeds draw them."""
        orders = [source_mutants.draw(known, len(known), seed) for seed in seeds]
        for change in dict.fromkeys(change for turn in zip(*orders) for change in turn):
            if not self.refused(change):
                yield change


def _ports(text, name):
    """[(direction, bits, port)] of a module written by Yosys."""
    port = rf"^  (input|output) ({BITS})(\w+);"
    return re.findall(port, mutate.module_of(text, name), re.MULTILINE)


def _copies(ports, width, copies):
    """Verilog of a module with the block and its copies; it has the outputs of the selected one."""
    pins = [f"{way} {bits}{name}" for way, bits, name in ports if name != "mutsel"]
    lines = [f"module {INNER}({', '.join([*pins, f'input [{width - 1}:0] mutsel'])});"]
    inputs = [f".{name}({name})" for way, _, name in ports if way == "input" and name != "mutsel"]
    outputs = [(bits, name) for way, bits, name in ports if way == "output"]
    for number in (0, *copies):
        lines += [f"wire {bits}{name}_{number};" for bits, name in outputs]
        joined = [*inputs, *(f".{name}({name}_{number})" for _, name in outputs)]
        if not number and any(name == "mutsel" for _, _, name in ports):
            joined.append(".mutsel(mutsel)")
        lines.append(f"{f'copy_{number}' if number else BLOCK} u_{number} ({', '.join(joined)});")
    for _, name in outputs:
        value = f"{name}_0"
        for number in copies:
            value = f"mutsel == {number} ? {name}_{number} : {value}"
        lines.append(f"assign {name} = {value};")
    return "\n".join([*lines, "endmodule", ""])


def netlist(run, count, seeds, folder):
    """Write the netlist of ``run`` with at most ``count`` mutants; returns them, and how many exist.

    Each mutant's ``command`` is its Change. If the tests look inside the block, constants are not changed.
    """
    source = Source(run, folder)
    inside = _looked_into(run, source.text)
    known = [change for change in source.changes if not (inside and change.constant)]
    waiting = source.drawn(known, seeds)
    chosen = list(islice(waiting, count))
    while chosen:
        copied = {number: change for number, change in enumerate(chosen, 1) if change.constant}
        texts = {f"copy_{n}": (source_text.alone(source.text, c), "flatten; ") for n, c in copied.items()}
        if copied:
            texts["copy_0"] = source.text, "flatten; "
        texts[BLOCK] = source.together([None if change.constant else change for change in chosen]), ""
        try:
            source.elaborate(texts)
            break
        except ToolError:
            bad = [change for change in chosen if not source.elaborates(change)]
            if not bad:
                raise
            chosen = [change for change in chosen if change not in bad]
            chosen += islice(waiting, count - len(chosen))
    if not chosen:
        return [], len(known)
    width = len(chosen).bit_length()
    read = f"read_rtlil {folder}/{BLOCK}.il; "
    if copied:
        yosys(f"{read}write_verilog -noattr {folder}/{BLOCK}.v", f"{folder}/{BLOCK}.v.log")
        ports = _ports((ROOT / folder / f"{BLOCK}.v").read_text(), BLOCK)
        (ROOT / folder / "copies.v").write_text(_copies(ports, width, copied))
        files = " ".join(f"{folder}/copy_{number}.il" for number in copied)
        read += f"read_rtlil {files}; read_verilog {folder}/copies.v; hierarchy -check -top {INNER}; "
    else:
        read += f"rename {BLOCK} {INNER}; "
    yosys(
        f"{read}write_rtlil {folder}/mutated.il; write_verilog -noattr {folder}/mutated.v",
        f"{folder}/apply.log",
    )
    mutate.wrap(run, folder, width)
    file = source.paths[-1].name
    mutants = [
        Mutant(number, change.what, f"{file}:{change.line}", change, parameters=run["parameters"])
        for number, change in enumerate(chosen, 1)
    ]
    for mutant in mutants:
        if mutant.number in copied and _netlist(folder, mutant.number) == _netlist(folder, 0):
            mutant.verdict = "equivalent"
    return mutants, len(known)


def _netlist(folder, number):
    """A copy of the block as written by Yosys, with names that contain source positions renumbered."""
    text = (ROOT / folder / f"copy_{number}.il").read_text()
    text = re.sub(rf"copy_{number}\b|[\w/-]+\.sv:[\d.-]+", "", text)
    lines = [line for line in text.splitlines() if not re.match(r" *attribute|autoidx|#", line)]
    names = {}
    return re.sub(r"\$\d+", lambda found: names.setdefault(found[0], f"${len(names)}"), "\n".join(lines))


def _looked_into(run, text):
    """Whether the tests name an inner block or a signal that is not a port."""
    head = mutate.head_of(text, f"msn_{run['block']}")
    named = [name for name in mutate.named(run) if not re.search(rf"\b{name}\b", head)]
    body = text.replace(head, "")
    seen = any(re.search(rf"\b{name}\b", body) for name in named)
    return seen or bool(mutate.scopes_of(mutate.tests_of(run).read_text()))
