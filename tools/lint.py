"""Lint everything, without a warning: each RTL module as its own top, the core in every named configuration,
Verible's style rules, ruff."""

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from meissner import boards, config, toolchain
from meissner.build import verilog

ROOT = toolchain.ROOT
RULES = ROOT / "tb/lint/verible.rules"
CELLS = ROOT / "tb/lint/cells.v"
WAIVERS = ROOT / "tb/lint/verilator.vlt"
PYTHON = ("model", "tb", "tools", "examples")


def run(name, command):
    done = subprocess.run(command, cwd=ROOT, env=toolchain.environment(), capture_output=True, text=True)
    noise = (done.stdout + done.stderr).strip()
    return f"{name}\n{noise}" if done.returncode or noise else None


def main():
    files = [path.relative_to(ROOT) for path in toolchain.sources()]
    pairs = [*boards.pairs(), *((boards.ARTY, name) for name in boards.ARTY.configs)]
    outer = sorted({Path(source) for board, _ in pairs for source in board.sources})
    listed = {*files, *outer}
    strays = [str(p.relative_to(ROOT)) for p in ROOT.glob("rtl/**/*.sv") if p.relative_to(ROOT) not in listed]
    problems = [f"neither rtl/rtl.f nor a board lists {stray}" for stray in strays]
    tops = [path for path in files if not path.stem.endswith("_pkg")]
    misnamed = [path for path in tops if f"module {path.stem} " not in (ROOT / path).read_text()]
    problems += [f"{path} does not define module {path.stem}" for path in misnamed]
    verilator = ["verilator", "--lint-only", "--quiet", "-Wall", str(WAIVERS), *map(str, files)]
    jobs = [(f"verilator {top.stem}", [*verilator, "--top-module", top.stem]) for top in tops]
    written = []
    for board, name in pairs:
        folder = f"build/lint/{board.name}-{name}"
        boards.write_board(folder, board, name)
        made = f"{folder}/{board.top}.sv"
        written.append(made)
        command = [*verilator, *board.sources, made, str(CELLS), f"-I{folder}", "--top-module", board.top]
        jobs.append((f"verilator {board.top}, {name}", command))
    for name in config.names():
        given = [f"-G{k}={v}" for k, v in verilog(config.load(name).parameters).items()]
        jobs.append((f"verilator msn_core {name}", [*verilator, "--top-module", "msn_core", *given]))
    example = "examples/instantiate/finger.sv"
    jobs.append(("verilator finger", [*verilator, example, "--top-module", "finger"]))
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
    ]
    with ThreadPoolExecutor() as pool:
        problems += [problem for problem in pool.map(lambda job: run(*job), jobs) if problem]
    if problems:
        sys.exit("\n\n".join(problems))
    print(f"lint: {len(tops)} modules, {len(jobs)} checks, no warning")


if __name__ == "__main__":
    main()
