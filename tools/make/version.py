"""The version that figures are measured on: the heading of their pages, and files of figures under it."""

import datetime
import json
import subprocess
import tomllib

from meissner.builds.toolchain import ROOT
from meissner.files import written

VERSION = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["version"]

SOURCES = (".", ":!docs", ":!constraints/*.json")  # what figures are measured on


def commit():
    """The commit that is checked out; "with changes" if tracked files other than docs/ and recorded figures
    differ from it."""
    git = lambda *told: subprocess.run(["git", *told], cwd=ROOT, capture_output=True, text=True, check=True)
    changed = git("status", "--porcelain", "--untracked-files=no", "--", *SOURCES).stdout
    return git("rev-parse", "--short=8", "HEAD").stdout.strip() + " with changes" * bool(changed)


def heading():
    return f"Version {VERSION}, commit {commit()}, {datetime.date.today()}."


def record(path, fresh):
    """Merge ``fresh`` into a file of product data. Figures of another version are dropped from it, so that
    what stands under a version was measured on it."""
    found = json.loads(path.read_text("utf-8")) if path.exists() else {}
    own = found["figures"] if found.get("version") == VERSION else {}
    kept = dict(sorted((own | fresh).items()))
    with written(path) as file:
        file.write(json.dumps({"version": VERSION, "figures": kept}, indent=1).encode() + b"\n")
    return kept
