"""Files that are built once and cached, each with its digest, so that a damaged one is built again.

Loading a truncated library (full disk, interrupted copy) would otherwise kill the process with a bus error.
"""

import hashlib
import os
from pathlib import Path


def _beside(path: Path) -> Path:
    return path.with_name(f"{path.name}.sha256")


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def intact(path: Path) -> bool:
    """Whether the file exists, unchanged since ``keep``."""
    try:
        return _beside(path).read_text() == _digest(path)
    except (OSError, UnicodeDecodeError):
        return False


def keep(fresh: Path, path: Path) -> None:
    """Move ``fresh`` to ``path`` atomically, because concurrent builds may do the same."""
    written = path.with_name(f"{path.name}.sha256.{os.getpid()}")
    written.write_text(_digest(fresh))
    fresh.replace(path)
    written.replace(_beside(path))
