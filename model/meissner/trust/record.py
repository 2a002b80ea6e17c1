"""What a kind of evidence found, kept in docs/trust/<kind>.json for docs/trust.md."""

import datetime
import fcntl
import json

from meissner import toolchain

FOLDER = toolchain.ROOT / "docs/trust"


def merge(kind, command, blocks, summary, total):
    """Put ``blocks`` {name: facts} among the recorded. ``summary`` makes a cell of a block's facts, ``total``
    the sentence of a list of all blocks' facts."""
    FOLDER.mkdir(exist_ok=True)
    path = FOLDER / f"{kind}.json"
    with path.open("a+") as file:
        fcntl.flock(file, fcntl.LOCK_EX)  # several may record at once
        file.seek(0)
        before = file.read()
        known = json.loads(before)["blocks"] if before else {}
        fresh = {name: facts | {"summary": summary(facts)} for name, facts in blocks.items()}
        merged = dict(sorted((known | fresh).items()))
        told = {"command": command, "date": str(datetime.date.today()), "total": total([*merged.values()])}
        file.truncate(0)
        file.write(json.dumps(told | {"blocks": merged}, indent=1) + "\n")
    return path
