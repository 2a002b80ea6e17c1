"""All mutants of a block in one netlist: Yosys reads the sources, `mutate` changes one bit of a cell's port.

    netlist(run, count, seeds, folder)  [Mutant, ...], and how many exist; writes folder/mutated.v, mutated.il
                                        and wrapper.sv

Only cells of the block itself and the ports of its inner blocks are changed; inner blocks have their own
mutants. The netlist's input `mutsel` chooses the mutant, 0 the unchanged block. A generated wrapper has the
block's name, parameters and ports, so the block's tests run unmodified. Clocks are not changed.
"""

import re
from dataclasses import dataclass, field

from meissner.builds import toolchain
from meissner.builds.yowasp import ROOT, chparam, yosys
from nightly import benches

INNER = "mutated"  # the block's module in the netlist
BITS = r"(?:signed )?(?:\[\d+:0\] )?"
CLOCKS = ("CLK", "RD_CLK", "WR_CLK", "clk_i")
UNREAD = re.compile(r"\\?(.*\.)?unused_")
SYNTHESIS = "proc; opt_expr; opt_clean; opt -keepdc; wreduce -keepdc; memory_dff; opt_clean; memory_collect"
SYNTHESIS += "; opt -keepdc -fast; opt_clean"


@dataclass
class Mutant:
    """One change. ``what``: Yosys's description, ``source``: source lines, ``number``: its mutsel value."""

    number: int
    what: str
    source: str
    command: str
    block: str = ""
    verdict: str = ""
    by: str = ""
    parameters: dict = field(default_factory=dict)


def source_of(block):
    """The block's source file."""
    return next(path for path in toolchain.sources() if path.stem == f"msn_{block}")


def tests_of(run):
    """The test file of an entry of benches.runs."""
    return ROOT / f"tb/{run['stage']}/{run['module']}.py"


def _listed(text):
    """The mutants in the output of `mutate -list`, without those of clocks and of unused wires."""
    for line in text.splitlines():
        option = dict(re.findall(r"-(mode|cell|port|portbit|ctrlbit|wire|wirebit) (\S+)", line))
        if option["port"].lstrip("\\") in CLOCKS or UNREAD.match(option.get("wire", "")):
            continue
        lines = dict.fromkeys(re.findall(r"(\w+\.sv):(\d+)", line))
        source = " ".join(f"{name}:{at}" for name, at in lines)
        wire = f" {option['wire']}[{option['wirebit']}]".replace("\\", "") if "wire" in option else ""
        when = f" by [{option['ctrlbit']}]" if "ctrlbit" in option else ""
        cell = option["cell"].split("$")[1] if option["cell"].startswith("$") else option["cell"]
        what = f"{option['mode']} {cell} {option['port']}[{option['portbit']}]{when}{wire}".replace("\\", "")
        yield what, source, line


def head_of(text, module):
    """The head of a module in a source, up to its port list."""
    return re.search(rf"^module {module}\b.*?^\);", text, re.DOTALL | re.MULTILINE).group()


def scopes_of(tests):
    """Paths of inner blocks that the tests name in quotes, through generate blocks and other blocks."""
    return re.findall(r'"((?:(?:gen|u)_\w+\.)*u_\w+)"', tests)


def module_of(text, name):
    """A module of a netlist, from its head to its end."""
    return text.partition(f"\nmodule {name}(")[2].partition("\nendmodule")[0]


def named(run):
    """The block's own signals that the tests name."""
    return sorted(set(re.findall(r"\bdut\.(\w+)", tests_of(run).read_text())))


def signals_of(run):
    """Signal names in quoted "<block>.<signal>" in the tests and their imports."""
    test = tests_of(run)
    text = "".join(path.read_text() for path in (test, *sorted(benches.imports(test))))
    return set(re.findall(r'"\w+\.(\w+)[\["]', text))


def _scopes(tree):
    """Verilog of nested scopes, down to the signals in them."""
    return "".join(
        inner if isinstance(inner, str) else f"  if (1) begin : {name}\n{_scopes(inner)}  end\n"
        for name, inner in tree.items()
    )


def _scope(tree, path):
    """The scope of ``path`` in the tree, created if it does not exist."""
    for name in path.split("."):
        tree = tree.setdefault(name, {})
    return tree


PORT = rf"^  (?:in|out)put ({BITS})(\w+);"
# The space ends an escaped name with dots.
_copy = "  logic {bits}{name};\n  assign {name} = u_mutated.{at}{name} ;\n".format


def _blocks_inside(text, module, wanted, paths, signals, at, tree):
    """Put copies of the ports and ``signals`` of the blocks at ``wanted`` in ``module`` into the tree.
    ``at``: the path of the module.

    Inside a wanted block all ``paths`` are searched, since tests join two of them.
    """
    for kind, path in re.findall(r"^  (\S+) +\\?([\w.]+) +\($", module, re.MULTILINE):
        deeper = [other.removeprefix(f"{path}.") for other in wanted if other.startswith(f"{path}.")]
        if not deeper and path not in wanted:
            continue
        block = module_of(text, f"{kind} " if kind.startswith("\\") else kind)
        there = f"{at}\\{path} ." if "." in path else f"{at}{path}."  # an escaped name with dots
        scope = {}
        if path in wanted:
            own = re.findall(rf"^  (?:wire|reg) ({BITS})(\w+);", block, re.MULTILINE)
            own = [(bits, name) for bits, name in own if name in signals]
            scope = {
                name: _copy(bits=bits, at=there, name=name)
                for bits, name in re.findall(PORT, block, re.MULTILINE) + own
            }
            deeper += paths
        _blocks_inside(text, block, deeper, paths, signals, there, scope)
        if scope:
            _scope(tree, path).update(scope)


def _seen_inside(run, folder):
    """The wrapper's copies of the inner signals that the block's tests name; in scopes of the same names,
    also of all ports of inner blocks, at any depth, and all signals of generate blocks whose path the tests
    quote."""
    text, tests = (ROOT / folder / "mutated.v").read_text(), tests_of(run).read_text()
    module = module_of(text, INNER)
    ports = [name for _, name in re.findall(PORT, module, re.MULTILINE)]
    wires = {name: bits for bits, name in re.findall(rf"^  (?:wire|reg) ({BITS})(\w+);", module, re.M)}
    seen = "".join(
        _copy(bits=wires[name], at="", name=name)
        for name in named(run)
        if name in wires and name not in ports
    )
    paths, tree = scopes_of(tests), {}
    _blocks_inside(text, module, paths, paths, signals_of(run), "", tree)
    for bits, path, name in re.findall(rf"^  (?:wire|reg) ({BITS})\\([\w.]+)\.(\w+) ;", module, re.M):
        if f'"{path}"' in tests and path not in paths:
            _scope(tree, path)[name] = _copy(bits=bits, at=f"\\{path}.", name=name)
    return seen + _scopes(tree)


def netlist(run, count, seeds, folder):
    """Write the netlist of ``run`` (an entry of benches.runs) with at most ``count`` mutants into ``folder``.

    ``folder`` is relative to ROOT. Returns the mutants, numbered from 1, and the number to draw from.
    """
    block = f"msn_{run['block']}"
    (ROOT / folder).mkdir(parents=True, exist_ok=True)
    sources = [str(path.relative_to(ROOT)) for path in toolchain.sources_of(block)]
    yosys(
        f"read_verilog -sv {' '.join(sources)}; {chparam(block, run['parameters'])}"
        f"hierarchy -check -top {block}; rename -top {INNER}; {SYNTHESIS}; write_rtlil {folder}/plain.il",
        f"{folder}/read.log",
    )
    listed = {}
    for place, seed in enumerate(seeds, 1):
        wanted = count * place // len(seeds)
        # More than wanted, since some concern clocks; Yosys itself thins out several in one place.
        for more in (count + count // 4 + 8, 4 * count):
            said = yosys(
                f"read_rtlil {folder}/plain.il; mutate -list {more} -seed {seed} -o {folder}/listed {INNER}",
                f"{folder}/list.log",
            )
            found = {entry[2]: entry for entry in _listed((ROOT / folder / "listed").read_text())}
            new = [line for line in found if line not in listed]
            if len(listed) + len(new) >= wanted:
                break
        listed |= {line: found[line] for line in new[: wanted - len(listed)]}
    listed = list(listed.values())
    width = len(listed).bit_length()
    mutants = [Mutant(n, *entry) for n, entry in enumerate(listed, 1)]
    for mutant in mutants:
        mutant.block, mutant.parameters = run["block"], run["parameters"]
    control = [m.command.replace("mutate ", f"mutate -ctrl mutsel {width} {m.number} ", 1) for m in mutants]
    (ROOT / folder / "apply.ys").write_text("\n".join(control) + "\n")
    # Signals that only the tests read are kept, even if a mutant renames them.
    kept = " ".join(f"{INNER}/w:{name}" for name in named(run))
    yosys(
        f"read_rtlil {folder}/plain.il; setattr -set keep 1 {kept}; script {folder}/apply.ys; opt_clean; "
        f"write_rtlil {folder}/mutated.il; write_verilog -noattr {folder}/mutated.v",
        f"{folder}/apply.log",
    )
    wrap(run, folder, width)
    return mutants, int(re.search(r"^Raw database size: (\d+)", said, re.MULTILINE)[1])


def wrap(run, folder, width):
    """Write the wrapper of the netlist in ``folder``, whose ``mutsel`` has ``width`` bits."""
    block = f"msn_{run['block']}"
    text = source_of(run["block"]).read_text()
    header = head_of(text, block)
    inner = f"  logic [{width - 1}:0] mutsel;\n  {INNER} u_mutated (.*);\n{_seen_inside(run, folder)}"
    (ROOT / folder / "wrapper.sv").write_text(f"{header}\n\n{inner}\nendmodule\n")
