"""Lint everything; no warning is allowed. Verilator and slang read each RTL module as a top, and the core in
every named configuration, on all boards that have it; then come Verible's style rules, ruff, and a check for
casts that Yosys alone reads differently."""

import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from meissner.builds import boards, config, toolchain, yowasp
from meissner.builds.build import verilog

ROOT = toolchain.ROOT
RULES = ROOT / "tb/lint/verible.rules"
CELLS = "tb/lint/cells.v"
WAIVERS = ROOT / "rtl/verilator.vlt"
# Each tool's name and its command.
VERILATOR = ["verilator", "verilator", "--lint-only", "--quiet", "-Wall", str(WAIVERS)]
SLANG = ["slang", sys.executable, str(ROOT / "tools/make/slang.py"), "-Werror"]  # no waivers
# Cover points take a block's own signals, an enum as its bits; all in one unit, for the macro.
COVERS = [*SLANG[1:], "-Wno-implicit-port-type-mismatch", "--single-unit"]
BINS = "tb/coverage/bin.svh"
# The vendors' cells that rtl/ecp5 uses.
MODELS = [CELLS, "model/meissner/engines/cells/MULT18X18D.v"]
# Yosys reads ~Bits'(1) as (~Bits)'(1), without a warning if the rest is constant.
CAST = re.compile(r"[~!&|^+-](?!signed'|unsigned')\w+'\(")
PYTHON = ("model", "tb", "tools", "examples")


def run(name, command):
    done = subprocess.run(command, cwd=ROOT, env=toolchain.environment(), capture_output=True, text=True)
    noise = (done.stdout + done.stderr).strip()
    return f"{name}\n{noise}" if done.returncode or noise else None


def casts(text):
    """Numbers of the lines with an operator directly before a size cast, comments ignored."""
    lines = enumerate(text.splitlines(), start=1)
    return [number for number, line in lines if CAST.search(line.split("//")[0])]


def main():
    files = [path.relative_to(ROOT) for path in toolchain.sources()]
    pairs = [*boards.pairs(), *((boards.ARTY, name) for name in boards.ARTY.configs)]
    own = {Path(source) for instead in yowasp.INSTEAD.values() for source in instead.values()}
    outer = sorted(own | {Path(source) for board, _ in pairs for source in board.sources})
    listed = {*files, *outer}
    strays = [str(p.relative_to(ROOT)) for p in ROOT.glob("rtl/**/*.sv") if p.relative_to(ROOT) not in listed]
    problems = [f"neither rtl/rtl.f nor a board nor a family lists {stray}" for stray in strays]
    tops = [path for path in files if not path.stem.endswith("_pkg")]
    modules = {path.stem for path in tops}
    misnamed = [path for path in tops if f"module {path.stem} " not in (ROOT / path).read_text()]
    problems += [f"{path} does not define module {path.stem}" for path in misnamed]
    for path in sorted(listed):
        for number in casts((ROOT / path).read_text("utf-8")):
            problems.append(f"{path}:{number}: an operator right before a size's cast: (~Bits)'(1) to Yosys")

    def elaborate(name, top, *more, instead=None, tools=(VERILATOR, SLANG)):
        inner = [path.relative_to(ROOT) for path in toolchain.sources_of(top)] if top in modules else files
        sources = [(instead or {}).get(str(path), str(path)) for path in inner]
        jobs.extend((f"{tool[0]} {name}", [*tool[1:], *sources, *more, "--top", top]) for tool in tools)

    # slang reads all modules as tops of one design, faster than it starts for each.
    jobs = [("slang", [*SLANG[1:], *map(str, files), *(f"--top={top.stem}" for top in tops)])]
    covers = sorted(path.relative_to(ROOT) for path in ROOT.glob("tb/coverage/cover_*.sv"))
    seen = [f"--top=msn_{path.stem.removeprefix('cover_')}" for path in covers]
    jobs.append(("slang, cover points", [*COVERS, *map(str, (*files, BINS, *covers)), *seen]))
    for top in tops:
        elaborate(top.stem, top.stem, tools=[VERILATOR])
    for family, instead in yowasp.INSTEAD.items():
        for source in instead:
            elaborate(f"{Path(source).stem}, {family}", Path(source).stem, *MODELS, instead=instead)
    written = []
    for board, name in pairs:
        folder = f"build/lint/{board.name}-{name}"
        boards.write_board(folder, board, name)
        made = f"{folder}/{board.top}.sv"
        written.append(made)
        elaborate(f"{board.top}, {name}", board.top, *board.sources, made, CELLS, f"-I{folder}")
    for name in sorted({*config.names()} - {name for _, name in pairs}):  # the others are on a board
        given = [f"-G{k}={v}" for k, v in verilog(config.load(name).parameters).items()]
        elaborate(f"msn_core {name}", "msn_core", *given)
    elaborate("finger", "finger", "examples/instantiate/finger.sv")
    binaries = Path(sys.executable).parent
    jobs += [
        (
            "verible",
            [
                str(binaries / "verible-verilog-lint"),
                f"--rules_config={RULES}",
                *map(str, (*files, *outer, *written)),
            ],
        ),
        ("ruff check", [str(binaries / "ruff"), "check", "--quiet", *PYTHON]),
        ("ruff format", [str(binaries / "ruff"), "format", "--quiet", "--check", *PYTHON]),
        ("mypy", [str(binaries / "mypy"), "--no-error-summary"]),  # the strict modules of pyproject.toml
    ]
    with ThreadPoolExecutor(os.cpu_count()) as pool:  # more at once wait for each other's memory
        problems += [problem for problem in pool.map(lambda job: run(*job), jobs) if problem]
    if problems:
        sys.exit("\n\n".join(problems))
    print(f"lint: {len(tops)} modules, {len(jobs)} checks, no warning")


if __name__ == "__main__":
    main()
