"""The core of the site's front page: msn_core's RTL, Verilated, as WebAssembly, with a scene to play on it.

    python tools/make/wasm.py      build/wasm/: core.js; scene.js, samples and what the twin decides on them

It needs Emscripten (Debian: emscripten). The page compares its core's decisions with the twin's.
"""

import base64
import json
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

import version
from meissner import scenes
from meissner.builds import toolchain
from meissner.engines import fixed, rtl_slip
from meissner.engines.verilated import HERE
from meissner.scenes.rubber.recording import simulate
from meissner.twins.link.registers import ADDRESSES, members, words
from meissner.twins.slip.config import SAMPLE_BITS, TIMER_BITS

SCENE, SEED = "acrylic_slip", 1
OUT = toolchain.ROOT / "build/wasm"
SOURCES = toolchain.ROOT / "docs/try"


def setup(config):
    """{address: word} that an engine writes for a configuration, and the place of the threshold."""
    values = {name: int(getattr(config, name) or 0) for name in members("slip")}
    values["keep_threshold"] = config.keeps_above
    return words("slip", values, {"detail": SAMPLE_BITS + config.level, "timer": TIMER_BITS})


def write_scene():
    scene = scenes.load(SCENE)
    recording = simulate(scene, scene.conditions[0], SEED)
    config = scene.slip_config()
    watched = fixed.watch(recording.codes[None], config)
    pack = lambda values, kind: base64.b64encode(np.asarray(values).astype(kind).tobytes()).decode()
    low, high = np.polyfit(recording.codes, recording.volts, 1)[::-1]
    told = {
        "scene": SCENE,
        "rtl": version.commit(),
        "rate_hz": scene.rate_hz,
        "volts": [float(low), float(high)],  # at code 0, and a code's
        "bits": SAMPLE_BITS,
        "level": config.level,
        "registers": {hex(address): word for address, word in setup(config).items()},
        "threshold": {"address": ADDRESSES["slip.threshold"], "value": config.threshold},
        "codes": pack(recording.codes, "<i2"),
        "p2p": pack(watched.p2p[0], "<i4"),
        "state": pack(watched.state[0], "<u1"),
    }
    (OUT / "scene.js").write_text(f"window.SCENE = {json.dumps(told)};\n", "utf-8")
    return config


def build(config, folder):
    """core.js: the core with its WebAssembly inside, so that a page opened as a file has it too."""
    parameters = rtl_slip._parameters(1, config) | rtl_slip._CORE
    vlt = folder / "detail.vlt"
    lines = ["`verilator_config", *(f'public_flat_rd -module "msn_haar" -var "{name}"' for name in SEEN)]
    vlt.write_text("\n".join([*lines, ""]), "utf-8")
    command = ["verilator", "--cc", "--quiet", "-O3", "--x-assign", "fast", "--x-initial", "fast"]
    command += ["--top-module", "msn_core", "-Mdir", str(folder), *toolchain.VERILATOR_FLAGS]
    command += [*(f"-G{name}={value}" for name, value in parameters.items()), str(vlt)]
    environment = toolchain.environment()
    sources = [str(source) for source in toolchain.sources_of("msn_core")]
    subprocess.run([*command, *sources], env=environment, check=True)
    header = (folder / "Vmsn_core___024root.h").read_text("utf-8")
    names = {name: re.search(rf"\b(msn_core__DOT__\w*u_haar__DOT__\w*{name})\b", header) for name in SEEN}
    include = Path(environment["VERILATOR_ROOT"]) / "include"
    flags = [
        "-std=c++17",
        "-include",
        "stdint.h",
        "-DVL_IGNORE_UNKNOWN_ARCH=1",
        f"-I{include}",
        f"-I{include}/vltstd",
        f"-I{folder}",
    ]
    flags += [f"-I{HERE}", f"-DLEVEL={config.level}"]
    flags += [f"-DDETAIL={names['out_detail_o'][1]}", f"-DDETAIL_VALID={names['out_valid_o'][1]}"]
    objects = []
    runtime = [include / "verilated.cpp", include / "verilated_threads.cpp"]
    for source in [*sorted(folder.glob("V*.cpp")), *runtime, SOURCES / "driver.cpp"]:
        objects.append(str(folder / f"{source.stem}.o"))
        subprocess.run(["em++", "-O3", *flags, "-c", str(source), "-o", objects[-1]], check=True)
    objects.append(str(folder / "affinity.o"))
    subprocess.run(["emcc", "-O3", "-c", str(SOURCES / "affinity.c"), "-o", objects[-1]], check=True)
    exported = "_start,_put,_get,_next"
    link = [
        "-O1",
        "-sMODULARIZE=1",
        "-sEXPORT_NAME=MeissnerCore",
        "-sSINGLE_FILE=1",
        "-sALLOW_MEMORY_GROWTH=1",
    ]
    link += ["-sENVIRONMENT=web,node", f"-sEXPORTED_FUNCTIONS={exported}"]
    subprocess.run(["em++", *link, *objects, "-o", str(OUT / "core.js")], check=True)


SEEN = ("out_valid_o", "out_detail_o")


def main():
    if not shutil.which("em++"):
        raise SystemExit("em++ of Emscripten is not installed (Debian: apt install emscripten)")
    OUT.mkdir(parents=True, exist_ok=True)
    config = write_scene()
    with tempfile.TemporaryDirectory() as folder:
        build(config, Path(folder))
    print(f"build/wasm/core.js: {(OUT / 'core.js').stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
