"""What a kind of evidence found, kept in docs/trust/<kind>.json for docs/trust.md."""

import datetime
import fcntl
import hashlib
import json
import re
from functools import cache

from meissner import toolchain
from meissner.trust import benches

FOLDER = toolchain.ROOT / "docs/trust"


@cache
def digest(block):
    """A block's RTL in eight digits: its file and those of all that it is made of, without comments."""
    texts = (path.read_text() for path in toolchain.sources_of(f"msn_{block}"))
    plain = "\n".join(" ".join(re.sub(r"//.*", "", text).split()) for text in texts)
    return hashlib.sha256(plain.encode()).hexdigest()[:8]


def earlier(recorded):
    """Names of the blocks that ``recorded``, what a kind's file says, is of an earlier revision of."""
    listed = set(benches.blocks())
    blocks = recorded["blocks"].items()
    return [name for name, facts in blocks if name in listed and facts.get("rtl") != digest(name)]


def _replace(before, now):
    return now


def _on_one_line(numbers):
    return f"[{' '.join(numbers[1].split())}]"


def merge(kind, command, blocks, summary, total, join=_replace, listed=None):
    """Put ``blocks`` {name: facts} among the recorded. ``summary`` makes a cell of a block's facts, ``total``
    the sentence of a list of all blocks' facts; ``join`` puts a block's facts to those it had of the same
    RTL, in place of replacing them; ``listed``: names of all blocks that there are, others are dropped.
    ``rtl`` among a block's facts: what ``digest`` was when they were found, if that is not now."""
    FOLDER.mkdir(exist_ok=True)
    path = FOLDER / f"{kind}.json"
    with path.open("a+") as file:
        fcntl.flock(file, fcntl.LOCK_EX)  # several may record at once
        file.seek(0)
        before = file.read()
        known = json.loads(before)["blocks"] if before else {}
        fresh = {}
        for name, facts in blocks.items():
            if name in benches.blocks():  # others are readers of files
                facts = {"rtl": digest(name)} | facts
            old = known.get(name, {})
            facts = join(old if old.get("rtl") == facts.get("rtl") else {}, facts)
            fresh[name] = facts | {"summary": summary(facts)}
        merged = {
            name: facts for name, facts in sorted((known | fresh).items()) if listed is None or name in listed
        }
        told = {"command": command, "date": str(datetime.date.today()), "total": total([*merged.values()])}
        text = json.dumps(told | {"blocks": merged}, indent=1)
        file.truncate(0)
        file.write(re.sub(r"\[\s+([-\d.,\s]+?)\s+\]", _on_one_line, text) + "\n")
    return path
