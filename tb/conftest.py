"""The marks of tests that `make test` leaves out (tb/long.txt), and what every session of tests shares."""

import os
from pathlib import Path

import pytest

os.environ.setdefault("MEISSNER_OPTIMISE", "-O1")  # before meissner.builds.toolchain reads it
# Each worker is a process: extra BLAS threads for small matrices wait for each other and double the time.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before NumPy reads it
os.environ.setdefault("MEISSNER_JOBS", "1")  # the workers of pytest use all cores

from harness import applicable, drawing, shared_builds

BIG = {
    line
    for line in Path(__file__).with_name("long.txt").read_text("utf-8").splitlines()
    if not line.startswith("#")
}


def left_alone(items):
    """Files of ``items`` none of whose builds `make test` runs, but for those that need a package of their
    own."""
    builds = {}
    for item in items:
        if shared_builds.calls_run(item.function) and "importorskip" not in item.function.__code__.co_names:
            left = item.get_closest_marker("long") or item.get_closest_marker("big")
            builds.setdefault(item.nodeid.split("::")[0], []).append(not left)
    return sorted(name for name, runs in builds.items() if not any(runs))


@pytest.fixture
def undrawn(monkeypatch):
    """Pictures are not rendered: for tests of numbers. Another test renders them."""
    drawing.off(monkeypatch)


def pytest_configure(config):
    # Icarus cannot run every build; benches.py does not run every test.
    judges = os.environ.get("MEISSNER_SIM", "verilator") == "verilator"
    judges = judges and "MEISSNER_RUNS" not in os.environ
    config.pluginmanager.register(applicable.Watch(config, Path(__file__).parent, judges))


def pytest_collection_finish(session):
    shared_builds.of_session[:] = session.items


def pytest_collection_modifyitems(items):
    left, files = set(BIG), {item.nodeid.split("::")[0] for item in items}
    for item in items:
        named = {item.nodeid, item.nodeid.split("[")[0], item.nodeid.split("::")[0]} & BIG
        if named:
            item.add_marker(pytest.mark.big)
            left -= named
    whole = len(items) > 1000  # a smaller run may hold only part of a file
    if gone := sorted(name for name in left if whole and name.split("::")[0] in files):
        raise pytest.UsageError(f"tb/long.txt names {gone[0]}, which is not there")
    if whole and (alone := left_alone(items)):
        raise pytest.UsageError(f"of the builds of {alone[0]} `make test` runs none")
