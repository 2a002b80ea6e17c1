"""The tables of docs/references.md: the reference of each twin, as the tests of its block state it.

EVIDENCE["reference"] of tb/<stage>/test_<block>.py is one of

    {"against": "`Fraction`", "test": "tb/<stage>/test_<file>.py::test_<name>"}   the twin computes
    {"moves": "words in their order"}                                         it moves data only
    {"joins": "scan_plan, scan_buffer"}                                       it joins other blocks

`python tools/blocks.py --page` writes them.
"""

import re

from meissner.builds import toolchain
from verify import benches, evidence

PAGE = toolchain.ROOT / "docs/references.md"
# Twins that belong to no single block.
OTHERS = {
    "core.py": {"joins": "all of a build"},
    "link/decoder.py": {
        "against": "bytes by hand, `zlib`",
        "test": "tb/link/test_packet_reference.py::test_the_host_reads_them_by_hand",
    },
    "link/register.py": {"moves": "what a map of registers is made of"},
    "link/register_map.py": {"moves": "the map, made from `rtl/registers.rdl`"},
    "slip/config.py": {"joins": "the settings of the slip path"},
}
TOPS = ("core", "axis")  # their twin is core.py


def stated():
    """{twin: entry} of every twin; ValueError with one sentence if a block's tests do not state it."""
    found = dict(OTHERS)
    for block in benches.blocks():
        if block not in TOPS:
            entry = evidence.of(block, "reference")
            if sorted(entry) not in (["against", "test"], ["joins"], ["moves"]):
                name = evidence.path_of(block).relative_to(toolchain.ROOT)
                raise ValueError(f'{name}: EVIDENCE["reference"] needs against and test, or moves, or joins')
            text = (toolchain.ROOT / f"rtl/{benches.stage_of(block)}/msn_{block}.sv").read_text("utf-8")
            twin = re.search(r"model/meissner/twins/(\w+/\w+\.py)", text)[1]
            if twin not in found or twin.endswith(f"/{block}.py"):  # blocks that share a twin
                found[twin] = entry
    return found


def page(before):
    """The text of docs/references.md with its tables replaced by these."""
    rows = {"against": [], "moves": [], "joins": []}
    for twin, entry in sorted(stated().items()):
        kind = next(kind for kind in rows if kind in entry)
        test = f" `{entry['test']}` |" if kind == "against" else ""
        rows[kind].append(f"| `{twin}` | {entry[kind]} |{test}\n")
    tables = iter(rows.values())
    return re.sub(r"(?m)(?<=-\|\n)(?:^\| `.*\n)+", lambda _: "".join(next(tables)), before)
