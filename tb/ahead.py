"""Rewrite the assertions of all test files once, before the workers of pytest-xdist start.

Every worker imports every test file. In a fresh clone they begin at the same moment, none finds a file that
another has rewritten, and each spends 8 s of processor time on the same work. Here the files are shared among
as many processes, which write them where pytest's import looks for them."""

import multiprocessing
import os
import sys

from _pytest.assertion import rewrite


def cached(path):
    """Where pytest keeps the rewritten code of a test file."""
    return rewrite.get_cache_dir(path) / f"{path.stem}{rewrite.PYC_TAIL}"


def rewritten(config, paths):
    """Write the code of each file that has none, or that of another version, as pytest's import does."""
    state = config.stash[rewrite.assertstate_key]
    for path in paths:
        if rewrite._read_pyc(path, cached(path)) is None and rewrite.try_makedirs(cached(path).parent):
            source_hash, code = rewrite._rewrite_test(path, config)
            rewrite._write_pyc(state, code, source_hash, cached(path))


def of_session(config):
    """All test files of the session, if this process starts workers for it."""
    count = getattr(config.option, "numprocesses", None)
    off = sys.dont_write_bytecode or config.option.assertmode != "rewrite"
    if hasattr(config, "workerinput") or not count or off or not hasattr(os, "fork"):
        return
    given = [config.invocation_params.dir / argument.split("::")[0] for argument in config.args]
    found = [(sorted(path.rglob("test_*.py")) if path.is_dir() else [path]) for path in given]
    paths = [path for each in found for path in each if path.is_file()]
    fork = multiprocessing.get_context("fork")
    processes = [fork.Process(target=rewritten, args=(config, paths[k::count])) for k in range(count)]
    for process in processes:
        process.start()
    for process in processes:
        process.join()
