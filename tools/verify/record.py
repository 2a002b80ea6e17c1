"""What a kind of evidence found, kept in docs/trust/<kind>.json for docs/trust.md."""

import datetime
import fcntl
import json
import re
import resource

from meissner.builds import toolchain
from verify import benches
from verify.revision import digest

FOLDER = toolchain.ROOT / "docs/trust"


def stale(recorded, kind):
    """Names of the blocks whose entry in ``recorded``, what a kind's file says, rests on what has changed; of
    netlists also on the proof of a block in it that is not there, not proven or stale itself."""
    listed = set(benches.blocks())
    blocks = recorded["blocks"]
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
    """{(block, family)} that a netlist is proven around, by families."""
    entries = [(family, entry) for family, entry in facts.items() if isinstance(entry, dict)]
    return {(box, family) for family, entry in entries for box in entry.get("around", ())}


def _replace(before, now):
    return now


def _on_one_line(numbers):
    return f"[{' '.join(numbers[1].split())}]"


def _since(told=[0.0]):  # noqa: B006
    """Seconds of a processor, of this process and of those it waited for, since this was asked last."""
    usages = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    now, before = sum(usage.ru_utime + usage.ru_stime for usage in usages), told[0]
    told[0] = now
    return now - before


def merge(kind, command, blocks, summary, total, join=_replace, listed=None):
    """Put ``blocks`` {name: facts} among the recorded. ``summary`` makes a cell of a block's facts, ``total``
    the sentence of a list of all blocks' facts; ``join`` adds a block's facts to those it had of the same
    revision, in place of replacing them; ``listed``: names of all blocks that there are, others are dropped.
    ``of`` among a block's facts: what ``digest`` was when they were found, if that is not now. ``cpu_s`` of
    them: seconds of a processor since this process recorded last, an equal share of each block."""
    FOLDER.mkdir(exist_ok=True)
    spent = round(_since() / max(1, len(blocks)), 1)
    path = FOLDER / f"{kind}.json"
    with path.open("a+") as file:
        fcntl.flock(file, fcntl.LOCK_EX)  # several may record at once
        file.seek(0)
        before = file.read()
        known = json.loads(before)["blocks"] if before else {}
        fresh = {}
        for name, facts in blocks.items():
            if name in benches.blocks():  # others are readers of files
                facts = {"of": digest(name, kind)} | facts
            old = known.get(name, {})
            before_s = old.get("cpu_s", 0) if join is not _replace else 0  # what is joined may be a part
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
