"""What a kind of evidence found, kept in docs/trust/<kind>.json for docs/trust.md."""

import datetime
import fcntl
import json

from meissner import toolchain

FOLDER = toolchain.ROOT / "docs/trust"


def _replace(before, now):
    return now


def merge(kind, command, blocks, summary, total, join=_replace, listed=None):
    """Put ``blocks`` {name: facts} among the recorded. ``summary`` makes a cell of a block's facts, ``total``
    the sentence of a list of all blocks' facts; ``join`` puts a block's facts to those it had, in place of
    replacing them; ``listed``: names of all blocks that there are, others are dropped."""
    FOLDER.mkdir(exist_ok=True)
    path = FOLDER / f"{kind}.json"
    with path.open("a+") as file:
        fcntl.flock(file, fcntl.LOCK_EX)  # several may record at once
        file.seek(0)
        before = file.read()
        known = json.loads(before)["blocks"] if before else {}
        fresh = {name: join(known.get(name, {}), facts) for name, facts in blocks.items()}
        fresh = {name: facts | {"summary": summary(facts)} for name, facts in fresh.items()}
        merged = {
            name: facts for name, facts in sorted((known | fresh).items()) if listed is None or name in listed
        }
        told = {"command": command, "date": str(datetime.date.today()), "total": total([*merged.values()])}
        file.truncate(0)
        file.write(json.dumps(told | {"blocks": merged}, indent=1) + "\n")
    return path
