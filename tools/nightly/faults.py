"""Fault injection: record a block's tests, Verilate the block, run it with each fault and compare its output
with that of the run without one. docs/verification.md says what is injected and what an outcome means."""

import collections
import hashlib
import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from meissner.builds import toolchain
from meissner.twins.link.registers import members
from nightly import benches, evidence, initial

DRIVER = Path(__file__).with_name("faults_driver.cpp")
ENGINES = toolchain.ROOT / "model/meissner/engines"  # the converters' models
WORK = toolchain.BUILD / "faults"
LONG_S = 3600  # wall-clock time; a build on a busy machine may be slow
COUNT, SEED = 200, 1  # bits upset per block


@dataclass(frozen=True)
class Result:
    kind: str
    where: str
    at: int
    outcome: str
    what: str


def blocks():
    return [name for name in benches.blocks() if not stated(name, "none", "")]


def stated(block, key, otherwise):
    """The value of ``key`` that the block's tests state for its faults (evidence.KEYS)."""
    return evidence.of(block, "faults").get(key, otherwise)


def _spelt(parameters):
    return {name: str(value) for name, value in parameters.items()}


def _header(source, block):
    found = re.search(rf"^module msn_{block}\b(.*?^\);)", source, re.S | re.M)
    return found[1], re.findall(r"^\s*parameter\s[^=]*?(\w+)\s*=", found[1], re.M)


def wrapper(block, source):
    """A top around the block, since a register that is a port of the top cannot be upset."""
    header, names = _header(source, block)
    given = ", ".join(f".{name}({name})" for name in names)
    given = f"#({given}) " if given else ""
    return f"module faults_top{header}\n  msn_{block} {given}u_block (.*);\nendmodule\n"


def sizes(block):
    """Which of its tests' sizes the block is run with: one, and one for each part that another chooses."""
    return [stated(block, "size", {}), *stated(block, "more", [])]


def run_of(block, wanted=None):
    """The arguments of the bench run to record: the block's first own run with the wanted or stated size."""
    told = [run for run in benches.runs(block) if run["block"] == block and run["module"] == f"test_{block}"]
    wanted = sizes(block)[0] if wanted is None else wanted
    told = [run for run in told if evidence.fits(wanted, run["parameters"])]
    if not told:
        raise RuntimeError(f"{block}: its tests build nothing of size {wanted or 'any'} for a recording")
    return told[0] | {"parameters": told[0]["parameters"] | _spelt(stated(block, "short", {}))}


def program_parameters(block, size=None):
    """The parameters of the program: those of the recording, except where the tests state others."""
    return run_of(block, size)["parameters"] | _spelt(stated(block, "program", {}))


def recording(block, size=None):
    """Path of the recording of the block's tests; made now if there is none for these sources."""
    run = run_of(block, size)
    test = toolchain.ROOT / f"tb/{run['stage']}/test_{block}.py"
    inputs = [test, *sorted(benches.imports(test))]
    inputs += toolchain.sources_of(f"msn_{block}")
    digest = hashlib.sha256(repr(run).encode() + b"".join(path.read_bytes() for path in inputs)).hexdigest()[
        :12
    ]
    path = WORK / f"{block}-{digest}.rec"
    if not path.exists():
        WORK.mkdir(parents=True, exist_ok=True)
        fresh = path.with_suffix(f".{os.getpid()}")
        call = "import bench; bench.run({stage!r}, {block!r}, {parameters!r}, {test_filter!r}, "
        call += "sources={sources!r})"
        text = call.format(**{**run, "sources": [*map(str, run["sources"])] or None})
        paths = [str(toolchain.ROOT / folder) for folder in ("tb", "tools", "tools/make")]
        paths = os.pathsep.join([*paths, *filter(None, [os.environ.get("PYTHONPATH")])])
        source = next(path for path in toolchain.sources() if path.stem == f"msn_{block}").read_text()
        ports = re.findall(
            r"^\s*(?:input|output)\s[^/]*?(\w+)\s*,?\s*(?://.*)?$", _header(source, block)[0], re.M
        )
        env = {**os.environ, "MEISSNER_RECORD": str(fresh), "PYTHONPATH": paths}
        env["MEISSNER_RECORD_PORTS"] = ",".join(ports)
        done = subprocess.run(
            [sys.executable, "-c", text], env=env, capture_output=True, text=True, timeout=LONG_S
        )
        if not fresh.exists():
            raise RuntimeError(f"{block}: nothing was recorded:\n{done.stdout}{done.stderr}")
        fresh.replace(path)
    return path


SHIM = """#include "Vfaults_top.h"
struct Block : Vfaults_top { using Vfaults_top::Vfaults_top; };
Block *block_new(VerilatedContext *context) { return new Block{context, "TOP"}; }
void block_delete(Block *block) { delete block; }
void block_eval(Block *block) { block->eval(); }
uint8_t &block_clock(Block *block) { return block->clk_i; }
"""


def _do(what, command, cwd=None):
    done = subprocess.run(
        [*map(str, command)],
        cwd=cwd,
        env=toolchain.environment(),
        capture_output=True,
        text=True,
        timeout=LONG_S,
    )
    if done.returncode:
        raise RuntimeError(f"{what} did not build:\n{done.stdout}{done.stderr}")


# Without assertions: the effect of an upset is judged by the outputs alone.
VERILATE = (
    "--cc",
    "--build",
    "--no-assert",
    "--vpi",
    "--public-flat-rw",
    "-Wno-fatal",
    "-Wno-lint",
    "-Wno-style",
)


def _digest(*parts):
    digest = hashlib.sha256()
    for part in parts:
        digest.update(part.read_bytes() if isinstance(part, Path) else repr(part).encode())
    return digest.hexdigest()[:12]


def _compiled(source, folder, *flags):
    """Path of the object file of this C++ source, compiled with Verilator's headers."""
    include = Path(toolchain.environment()["VERILATOR_ROOT"]) / "include"
    target = folder / f"{source.stem}-{_digest(source, flags, *sorted(ENGINES.glob('*.hpp')))}.o"
    if not target.exists():
        folder.mkdir(parents=True, exist_ok=True)
        see = [
            f"-I{include}",
            f"-I{include}/vltstd",
            f"-I{folder}",
            f"-I{ENGINES}",
            "-DVERILATOR=1",
            "-DVM_TRACE=0",
            "-DVM_SC=0",
        ]
        fresh = target.with_suffix(f".{os.getpid()}")
        _do(source.name, ["g++", "-std=gnu++20", *flags, *see, "-c", source, "-o", fresh])
        fresh.replace(target)
    return target


def program(block, size=None):
    """Path of the block's program with the driver; built now if there is none for these sources."""
    parameters = program_parameters(block, size)
    sources = toolchain.sources_of(f"msn_{block}")
    own = next(path for path in sources if path.stem == f"msn_{block}").read_text()
    given = [f"-G{name}={value}" for name, value in parameters.items()]
    folder = toolchain.folder_for_make(WORK / f"{block}-{_digest(given, SHIM, VERILATE, *sources)}")
    sources = [toolchain.for_make(path) for path in sources]
    driver = _compiled(DRIVER, WORK, "-O1")
    built = folder / f"{driver.stem}.run"
    if not built.exists():
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "faults_top.sv").write_text(wrapper(block, own))
        (folder / "shim.cpp").write_text(SHIM)
        if not (folder / "libverilated.a").exists():
            command = ["verilator", *VERILATE, "--top-module", "faults_top", "-Mdir", folder, *given]
            command += ["-MAKEFLAGS"]
            command += ["OPT_FAST=-O1 OPT_SLOW=-O0 OPT_GLOBAL=-O1 CFG_CXXFLAGS_PCH_I=-include"]
            _do(block, [*command, *sources, folder / "faults_top.sv"])
        shim = _compiled(folder / "shim.cpp", folder, "-O1")
        libraries = [folder / "libVfaults_top.a", folder / "libverilated.a"]
        _do(block, ["g++", driver, shim, *libraries, "-pthread", "-o", built])
    return built


def settings():
    """The state of msn_registers that holds settings: what the core gets, what the host wrote, what waits."""
    return ["cfg", "written", "pending"]


def placed(text):
    """The option ``set`` with each GROUP.SETTING replaced by its bits of the block's port cfg_i."""

    def bits(found):
        group, setting = found.groups()
        fields = members(group)
        names = list(fields)
        low = sum(fields[name].width for name in names[names.index(setting) + 1 :])
        return f"cfg_i[{low + fields[setting].width - 1}:{low}]:"

    return re.sub(r"\b(\w+)\.(\w+):", bits, text)


def inject(block, count, seed):
    """Inject ``count`` upsets and a share of every other fault; a Result for each."""
    around, instance = stated(block, "inside", (block, ""))
    options = stated(around, "driver", {})
    if "set" in options:
        options = options | {"set": placed(options["set"])}
    if kept := kept_of(around):
        options = options | {"kept": " ".join(kept)}
    if instance:
        options = options | {"only": instance}
    found = []
    for size in sizes(around):
        told = _run(around, count, seed, options, size)
        for writes in stated(block, "writes", []):
            told += _run(around, count, seed, options | writes | {"alone": 1}, size)
        parameters = program_parameters(around, size)
        tables = initial.only(toolchain.sources_of(f"msn_{around}"), f"msn_{around}", parameters)
        found += [
            result for result in told if not result.where.startswith(tuple(f"{name}[" for name in tables))
        ]
    return [result for result in found if result.outcome != "constant"]  # not state; see the driver


def kept_of(block):
    """Names of the state that the block keeps by design, including that of inner blocks and settings."""
    kept = str(stated(block, "driver", {}).get("kept", "")).split()
    for instance, other in stated(block, "kept_inside", {}).items():
        kept += inside(instance, kept_of(other))
    return kept + (settings() if stated(block, "keeps_settings", False) else [])


def inside(instance, names):
    """These names, restricted to this instance."""
    return [f"{instance}.&{name}" for name in names]


def _run(block, count, seed, options, size):
    if "part" in options:
        options = options | {"part": size.get("Part", options["part"]), "lanes": size.get("Lanes", 1)}
    given = [f"{key}={','.join(str(value).split())}" for key, value in options.items()]
    command = [program(block, size), recording(block, size), count, seed, stated(block, "settle", 0), *given]
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, timeout=LONG_S)
    if done.returncode:
        raise RuntimeError(f"{block}: {done.stderr}{done.stdout[-300:]} exit {done.returncode}")
    lines = done.stdout.splitlines()
    print("\n".join(f"    {line}" for line in lines if line.startswith("#")))
    found = [line.split() for line in lines if not line.startswith("#")]
    return [Result(k, w, int(a), o, " ".join(rest)) for k, w, a, o, *rest in found]


def run(block, limits, jobs=1):
    """The facts of a block: how often each outcome occurred, and the faults that nothing reports."""
    results = inject(block, COUNT, SEED)
    counts = collections.Counter(result.outcome for result in results)
    silent = [result for result in results if result.outcome == "silent"]
    named = {result.where for result in silent if limits.undetected(block, result.where)}
    broken = [f"{r.kind} {r.where} at {r.at}: undetected {r.what}" for r in silent if r.where not in named]
    text = f"{len(results)} injected, {len(silent)} undetected" + " (named)" * bool(named)
    if not results:
        broken.append("nothing was injected")
    return {"text": text, "broken": broken, "outcomes": counts, "named": sorted(named)}
