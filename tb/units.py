"""Compile what Verilator wrote for a bench: one or two units in place of the dozen of its makefile.

A file of a larger model reads all of it again: a core's took 17 s, in two units they take 6 s. What runs in
every clock is compiled at -Og: a core's benches take half of the time that they do at -O0, for 1 s of the
compiler. What runs once is left at -O0: one of its constructors takes GCC minutes at -O1. The runtime is kept
by model/meissner/builds/objcache.py, and linked where it is.
"""

import hashlib
import re
import shutil
import subprocess
from pathlib import Path

import cocotb_tools.config
from cocotb_tools.runner import Verilator

from meissner.builds import objcache, toolchain

SMALL = 200_000  # bytes of what runs once that are compiled sooner at -Og than in a unit of their own


class Units(Verilator):
    """cocotb's runner for Verilator without make."""

    def __init__(self, inside=()):
        """``inside``: what benches see beside all signals of the top: modules, of which that is the ports, or
        signals, "<module>.<name>". With cocotb's own runner they see all signals of all modules.

        What can be seen from outside is neither joined nor left out: of a core that is 40 % of Verilator's
        time, two thirds of the compiler's, and half of what the model takes of each clock.
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
    """{VM_name: words} of what Verilator says to its makefile."""
    text = (folder / "Vtop_classes.mk").read_text("utf-8")
    rows = re.findall(r"^(VM_\w+) \+?= *((?:[^\\\n]|\\\n)*)", text, re.M)
    return {name: words.replace("\\\n", " ").split() for name, words in rows}


def link(folder, name):
    """The simulation ``name`` in a folder that Verilator wrote, if it is not there already."""
    folder = Path(folder)
    says = _lists(folder)
    include = Path(toolchain.environment()["VERILATOR_ROOT"]) / "include"
    features = ("COVERAGE", "TIMING", "TRACE", "TRACE_FST", "TRACE_SAIF", "TRACE_VCD")
    defined = [f"-DVM_{each}={says[f'VM_{each}'][0]}" for each in features]
    flags = [f"-I{include}", f"-I{include}/vltstd", "-DVERILATOR=1", "-DVM_SC=0", *defined]
    main = cocotb_tools.config.share_dir / "lib/verilator/verilator.cpp"

    def paths(*kinds):
        return [folder / f"{stem}.cpp" for kind in kinds for stem in says[f"VM_{kind}"]]

    fast, slow = paths("CLASSES_FAST", "SUPPORT_FAST"), paths("CLASSES_SLOW", "SUPPORT_SLOW")
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
    objects = []
    for unit, optimise, files in made:
        source = folder / f"{unit}.cpp"
        source.write_text("".join(f'#include "{path}"\n' for path in files), "utf-8")
        command = ["c++", optimise, *flags, f"-I{folder}", "-c", "-o", f"{unit}.o", str(source)]
        header = objcache.precompiled(["c++", optimise, *flags, "-c", "-o", "none.o", "none.cpp"])
        _do([command[0], *(["-include", str(header)] if header else []), *command[1:]], folder)
        objects.append(f"{unit}.o")
    for stem in [*says["VM_GLOBAL_FAST"], *says["VM_GLOBAL_SLOW"]]:
        objects.append(objcache.runtime(["c++", "-Os", *flags, "-c", str(include / f"{stem}.cpp")]))
    libraries = cocotb_tools.config.libs_dir
    shared = [f"-Wl,-rpath,{libraries}", f"-L{libraries}", "-lcocotbvpi_verilator"]
    quicker = ["-fuse-ld=gold"] if shutil.which("ld.gold") else []  # a third of GNU ld's time
    _do(["c++", *quicker, *map(str, objects), *shared, "-o", name], folder)
    stamp.write_text(digest.hexdigest())


def _do(command, folder):
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"{' '.join(command)}\n{done.stdout}{done.stderr}")
