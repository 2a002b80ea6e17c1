"""Compile once what every simulation shares: Verilator's runtime, three quarters of a build's time.

Called as ``objcache.py COMPILER ARGUMENTS...`` by Verilator's makefiles (their OBJCACHE). Only the
runtime's own sources, verilated*.cpp of the pinned package, are kept, under the hash of the command: they
include nothing of the model, so the command names them fully. All else is compiled as usual.
"""

import hashlib
import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
KEPT = ROOT / "build" / "objects"
# Without its package, which takes a second to import.
SPEC = importlib.util.spec_from_file_location("kept", ROOT / "model/meissner/engines/kept.py")
kept = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(kept)


def main():
    command = sys.argv[1:]
    sources = [Path(word) for word in command if word.endswith(".cpp") and Path(word).is_absolute()]
    runtime = [source for source in sources if source.parent.name == "include"]
    shared = len(sources) == 1 and len(runtime) == 1 and runtime[0].stem.startswith("verilated")
    if not shared or "-o" not in command:
        os.execvp(command[0], command)
    output = Path(command[command.index("-o") + 1])
    compiler = subprocess.run([command[0], "-dumpfullversion"], capture_output=True, text=True).stdout
    words = [word for word in command if word != str(output)]
    key = hashlib.sha256("\0".join([compiler, *words]).encode()).hexdigest()
    found = KEPT / f"{key}.o"
    if not kept.intact(found):
        status = subprocess.run(command).returncode
        if status:
            sys.exit(status)
        KEPT.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=KEPT, delete=False) as fresh:
            fresh.write(output.read_bytes())
        kept.keep(Path(fresh.name), found)
    else:
        shutil.copyfile(found, output)


if __name__ == "__main__":
    main()
