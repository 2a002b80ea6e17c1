"""Files that are built once and kept: each has its digest beside it, so that a damaged one is built again.

A library that was cut short (a full disk, a killed copy) would otherwise end the process with a bus error.
"""

import hashlib
import os


def _beside(path):
    return path.with_name(f"{path.name}.sha256")


def _digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def intact(path):
    """Whether the file is there, as ``keep`` left it."""
    try:
        return _beside(path).read_text() == _digest(path)
    except (OSError, UnicodeDecodeError):
        return False


def keep(fresh, path):
    """``fresh`` becomes ``path``, whole or not at all: several builds may do this at once."""
    written = path.with_name(f"{path.name}.sha256.{os.getpid()}")
    written.write_text(_digest(fresh))
    fresh.replace(path)
    written.replace(_beside(path))
