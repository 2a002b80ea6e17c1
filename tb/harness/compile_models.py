"""Compile what Verilator wrote for a bench: as one or two units in place of its makefile's dozen.

Each file of a larger model reads all headers again: a core took 17 s, in two units it takes 6 s. Code that
runs in every clock is compiled at -Og: a core's benches take half the time they do at -O0, for 1 s more of
compiling. Code that runs once is left at -O0: GCC takes minutes for one of its constructors at -O1. The
runtime is cached by model/meissner/builds/objcache.py and linked from there.
"""

import hashlib
import re
import shutil
import subprocess
from pathlib import Path

import cocotb_tools.config
from cocotb_tools.runner import Verilator

from meissner.builds import objcache, toolchain

FEATURES = ("COVERAGE", "TIMING", "TRACE", "TRACE_FST", "TRACE_SAIF", "TRACE_VCD")
SMALL = 200_000  # bytes; less code that runs once is compiled faster at -Og than as a separate unit


class Units(Verilator):
    """cocotb's runner for Verilator without make."""

    def __init__(self, inside=()):
        """``inside``: what benches see below the top, beside all signals of the top: a module (its ports) or
        one signal, "<module>.<name>". With cocotb's own runner they see all signals of all modules.

        Verilator neither merges nor removes a signal that is visible from outside: for a core this costs 40 %
        of Verilator's time, two thirds of the compiler's, and half of the model's time in each clock.
        """
        super().__init__()
        self.inside = inside

    def _build_command(self):
        verilate, make = super()._build_command()
        assert make[0] == "make"
        at = verilate.index("--public-flat-rw")
        signals = [(*name.split("."), "*_i", "*_o")[: 2 if "." in name else 3] for name in self.inside]
        lines = [f'public_flat_rw -module "{top}" -var "{name}"' for top, *names in signals for name in names]
        seen = Path(self.build_dir) / "inside.vlt"
        seen.write_text("\n".join(["`verilator_config", *lines, ""]), "utf-8")
        return [[*verilate[:at], "--public-depth", "1", str(seen), *verilate[at + 1 :]]]

    def build(self, **options):
        super().build(**options)
        link(self.build_dir, options["hdl_toplevel"])


def _lists(folder):
    """{VM_name: words} that Verilator wrote for its makefile."""
    text = (folder / "Vtop_classes.mk").read_text("utf-8")
    rows = re.findall(r"^(VM_\w+) \+?= *((?:[^\\\n]|\\\n)*)", text, re.M)
    return {name: words.replace("\\\n", " ").split() for name, words in rows}


def _include():
    return Path(toolchain.environment()["VERILATOR_ROOT"]) / "include"


def _flags(says):
    """Compiler flags: the same for benches and engines, so that they share one runtime."""
    defined = [f"-DVM_{each}={says[f'VM_{each}'][0]}" for each in FEATURES]
    return ["-fPIC", f"-I{_include()}", f"-I{_include()}/vltstd", "-DVERILATOR=1", "-DVM_SC=0", *defined]


def _sources(says, folder, *kinds):
    return [folder / f"{stem}.cpp" for kind in kinds for stem in says[f"VM_{kind}"]]


def _compile(folder, unit, files, optimise, flags, *folders):
    """The object of one unit that includes all ``files``."""
    source = folder / f"{unit}.cpp"
    source.write_text("".join(f'#include "{path}"\n' for path in files), "utf-8")
    command = ["c++", optimise, *flags, "-c", "-o", f"{unit}.o", str(source)]
    header = objcache.precompiled(["c++", optimise, *flags, "-c", "-o", "none.o", "none.cpp"])
    first = ["-include", str(header)] if header else []
    _do([command[0], *first, *(f"-I{each}" for each in folders), *command[1:]], folder)
    return f"{unit}.o"


def _runtime(says, flags):
    stems = [*says["VM_GLOBAL_FAST"], *says["VM_GLOBAL_SLOW"]]
    return [objcache.runtime(["c++", "-Os", *flags, "-c", str(_include() / f"{stem}.cpp")]) for stem in stems]


def _linker():
    return ["-fuse-ld=gold"] if shutil.which("ld.gold") else []  # takes a third of the time of GNU ld


def link(folder, name):
    """Build the simulation ``name`` in a folder that Verilator wrote, unless it is up to date."""
    folder = Path(folder)
    says = _lists(folder)
    flags = _flags(says)
    main = cocotb_tools.config.share_dir / "lib/verilator/verilator.cpp"
    fast = _sources(says, folder, "CLASSES_FAST", "SUPPORT_FAST")
    slow = _sources(says, folder, "CLASSES_SLOW", "SUPPORT_SLOW")
    if sum(path.stat().st_size for path in slow) < SMALL:
        fast, slow = fast + slow, []
    made = [("fast", "-Og", [*fast, main]), ("slow", "-O0", slow)]
    made = [each for each in made if each[2]]
    read = [*sorted(folder.glob("*.h")), *(path for _, _, files in made for path in files)]
    digest = hashlib.sha256(repr((flags, made, objcache.version("c++"))).encode())
    for path in read:
        digest.update(path.read_bytes())
    stamp = folder / "units.sha256"
    if stamp.exists() and (folder / name).exists() and stamp.read_text() == digest.hexdigest():
        return
    stamp.unlink(missing_ok=True)
    objects = [_compile(folder, unit, files, optimise, flags, folder) for unit, optimise, files in made]
    objects += _runtime(says, flags)
    libraries = cocotb_tools.config.libs_dir
    shared = [f"-Wl,-rpath,{libraries}", f"-L{libraries}", "-lcocotbvpi_verilator"]
    _do(["c++", *_linker(), *map(str, objects), *shared, "-o", name], folder)
    stamp.write_text(digest.hexdigest())


def _do(command, folder):
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"{' '.join(command)}\n{done.stdout}{done.stderr}")
