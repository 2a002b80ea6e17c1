"""The records of each kind of evidence, docs/trust/<kind>.json, from which docs/trust.md is written."""

import datetime
import fcntl
import json
import re
import resource

from meissner.builds import toolchain
from nightly import benches
from verify.revision import digest

FOLDER = toolchain.ROOT / "docs/trust"


def stale(recorded, kind):
    """Names of the blocks whose entry in ``recorded``, the contents of a kind's file, is stale:
    its digest has changed, or, for netlists, the proof of an inner block is missing, failed or stale."""
    blocks = recorded["blocks"]
    listed = set(benches.blocks())
    found = {name for name in listed & blocks.keys() if blocks[name].get("of") != digest(name, kind)}
    waits = {name: _boxes(facts) for name, facts in blocks.items() if name in listed - found}

    def lacks(box, family):
        return box in found or not blocks.get(box, {}).get(family, {}).get("proven")

    while more := {
        name for name, boxes in waits.items() if name not in found and any(lacks(*b) for b in boxes)
    }:
        found |= more
    return [name for name in blocks if name in found]


def _boxes(facts):
    """{(block, family)} of the inner blocks that a block's netlists are proven around."""
    entries = [(family, entry) for family, entry in facts.items() if isinstance(entry, dict)]
    return {(box, family) for family, entry in entries for box in entry.get("around", ())}


def _replace(before, now):
    return now


def _on_one_line(numbers):
    return f"[{' '.join(numbers[1].split())}]"


def _since(told=[0.0]):  # noqa: B006
    """CPU seconds of this process and its finished children since the last call."""
    usages = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    now, before = sum(usage.ru_utime + usage.ru_stime for usage in usages), told[0]
    told[0] = now
    return now - before


def merge(kind, command, blocks, summary, total, join=_replace, listed=None):
    """Merge ``blocks`` {name: facts} into the record. ``summary`` turns a block's facts into a cell,
    ``total`` a list of all blocks' facts into a sentence. ``join`` combines a block's facts with earlier ones
    of the same revision instead of replacing them. ``listed``: all existing blocks; others are dropped. A
    block's facts have ``of``, its ``digest`` at the time of the run (default: the current one), and
    ``cpu_s``, the CPU seconds since this process last recorded, shared equally among the blocks."""
    FOLDER.mkdir(exist_ok=True)
    spent = round(_since() / max(1, len(blocks)), 1)
    path = FOLDER / f"{kind}.json"
    with path.open("a+") as file:
        fcntl.flock(file, fcntl.LOCK_EX)  # several processes may record at the same time
        file.seek(0)
        before = file.read()
        known = json.loads(before)["blocks"] if before else {}
        fresh = {}
        for name, facts in blocks.items():
            if name in benches.blocks():
                facts = {"of": digest(name, kind)} | facts
            old = known.get(name, {})
            before_s = old.get("cpu_s", 0) if join is not _replace else 0  # joined facts may be only a part
            facts = join(old if old.get("of") == facts.get("of") else {}, facts)
            fresh[name] = facts | {"summary": summary(facts), "cpu_s": max(spent, before_s)}
        merged = {
            name: facts for name, facts in sorted((known | fresh).items()) if listed is None or name in listed
        }
        told = {"command": command, "date": str(datetime.date.today()), "total": total([*merged.values()])}
        text = json.dumps(told | {"blocks": merged}, indent=1)
        file.truncate(0)
        file.write(re.sub(r"\[\s+([-\d.,\s]+?)\s+\]", _on_one_line, text) + "\n")
    return path
