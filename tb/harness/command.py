"""Run the command ``meissner`` as a shell does, in a process of its own with its own folder and streams.

Most commands of tests end at once, after a start that takes ten times as long. So they are forked from one
process that has imported what commands import. tb/cli/test_start.py and test_wheel.py start every command
alone, as a shell does.
"""

import os
import signal
import subprocess
import sys
import tempfile
from functools import cache
from multiprocessing import get_context
from pathlib import Path

from meissner import cli

IMPORTED = (
    *(
        "meissner.cli",
        "meissner.run",
        "meissner.engines",
        "meissner.scenes.timed",
        "meissner.builds.boards",
    ),
    *("meissner.budget.array", "meissner.budget.cop4", "meissner.budget.grip", "matplotlib.figure"),
)


@cache
def _forkserver():
    context = get_context("forkserver")
    context.set_forkserver_preload(list(IMPORTED))
    return context


def _run(arguments, cwd, streams):
    os.chdir(cwd)
    for number, path in enumerate(streams, 1):
        os.dup2(os.open(path, os.O_WRONLY), number)
    sys.argv = ["meissner", *arguments]
    cli.main()


def meissner(*arguments, cwd="."):
    """subprocess.CompletedProcess of a command: its exit code and what it wrote."""
    arguments = [*map(str, arguments)]
    with tempfile.TemporaryDirectory() as folder:
        streams = [Path(folder) / name for name in ("out", "err")]
        for path in streams:
            path.touch()
        process = _forkserver().Process(target=_run, args=(arguments, str(cwd), streams))
        process.start()
        try:
            process.join()
        finally:
            process.kill()  # if the test's time is over; multiprocessing would wait for it at the end
        out, err = (path.read_text("utf-8") for path in streams)
    return subprocess.CompletedProcess(arguments, process.exitcode, out, err)


def python(*arguments, **more):
    """The Popen of a Python, as a shell starts it in the foreground: a background job ignores Ctrl-C and
    passes that on to its children."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        return subprocess.Popen([sys.executable, *map(str, arguments)], **more)
    finally:
        signal.signal(signal.SIGINT, before)


def started(*arguments, **more):
    """The Popen of a command, as a shell starts it in the foreground."""
    return python("-m", "meissner.cli", *arguments, **more)


def ended(seen, *arguments):
    """(exit code, lines of stdout, stderr) of a command that gets Ctrl-C once ``seen(lines)`` is true."""
    lines = []
    with started(*arguments, stdout=-1, stderr=-1, text=True) as child:
        try:
            while not seen(lines):
                text = child.stdout.readline()
                assert text, (lines, child.stderr.read())
                lines.append(text.removesuffix("\n"))
            child.send_signal(signal.SIGINT)
            out, err = child.communicate()
        finally:
            child.kill()
    return child.returncode, [*lines, *out.splitlines()], err
