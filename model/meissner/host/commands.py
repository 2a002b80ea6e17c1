"""``meissner regs``, ``live``, ``log``, ``bridge`` and ``replay``."""

import re
import signal
import sys
import time
from argparse import Namespace
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from meissner import calibration, engines, files
from meissner.host.stream import beats
from meissner.terminal import plain

if TYPE_CHECKING:
    from meissner.arrays import Arrays
    from meissner.forest.file import Model
    from meissner.host import Core
    from meissner.host.view import View


LINE_S, PICTURE_S = 1.0, 0.1  # interval of lines in a pipe, of pictures on a terminal


def _tell(sentence: str) -> None:
    with suppress(OSError):  # a closed terminal must not end a log
        print(f"meissner: {plain(sentence)}", file=sys.stderr, flush=True)


def _connect(
    arguments: Namespace, registers: bool | None = None, say: Callable[[str], object] = _tell
) -> "Core":
    """The Core that the arguments name, with the units of a configuration if one is given."""
    from meissner import host
    from meissner.builds import config

    seconds, clk_khz = getattr(arguments, "seconds", None), getattr(arguments, "clk_khz", None)
    if seconds is not None and not 0 < seconds < float("inf"):
        raise ValueError(f"seconds = {seconds:g} must be a number above 0")
    if clk_khz is not None and not 1000 <= clk_khz <= 200_000:
        raise ValueError(f"clk-khz = {clk_khz} must lie in 1000 .. 200000, the kilohertz of a core's clock")
    known = baud = lines = model = None
    if arguments.calibration is not None:
        lines = calibration.load(arguments.calibration)
    if arguments.forest is not None:
        from meissner.forest import file

        model = file.read(arguments.forest)
    if lines is not None or model is not None:
        if registers is False:
            what = "calibration" if model is None else "forest"
            raise ValueError(f"--{what} is written over the registers: omit --listen")
        registers = True
    if arguments.config is not None:
        build = config.load(arguments.config)
        known, baud = build.units, build.link.baud
        if not build.link.registers:
            if registers:
                raise ValueError(
                    f"{arguments.config} is built without registers: it can only be listened to (live)"
                )
            registers = False
    if clk_khz is not None:
        known = replace(known or host.Units(), clk_khz=clk_khz)
    core = host.connect(arguments.port, known, registers, baud, say=say)
    if getattr(getattr(core.line, "pipe", None), "registers", True) is False:
        say(f"{arguments.port} is built without registers: it is only listened to")
    for name in ("clk_khz", "rows", "columns") if arguments.config is not None else ():
        told, own = getattr(known, name), getattr(core.units, name)
        if told != own:
            say(f"{arguments.config} does not match the core: its {name} is {told}, the core's is {own}")
    try:
        if lines is not None:
            _calibrate(core, lines, arguments.calibration, say)
        if model is not None:
            _plant(core, model, arguments.forest, say)
    except BaseException:
        core.close()
        raise
    return core


def _calibrate(core: "Core", lines: calibration.Calibration, path: str, say: Callable[[str], object]) -> None:
    from meissner.host.load import check, load

    check(core, lines)
    say(f"writing the calibration of {lines.dead.size} cells in {path} into the core, reading each back")
    load(core, lines)


def _plant(core: "Core", model: "Model", path: str, say: Callable[[str], object]) -> None:
    from meissner.host.forest import check, load

    check(core, model)
    say(f"writing the forest of {len(model.trees)} trees, {model.nodes} nodes, in {path} into the core")
    load(core, model)
    say("the core decides by this forest")


def _amount(text: str) -> tuple[str, float] | None:
    """(quantity, value) of "0.02V", "200mN" or "5ms"; None if ``text`` is none."""
    found = re.fullmatch(r"([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:e[-+]?[0-9]+)?)(m?)([VNs])", text)
    if found is None:
        return None
    number, milli, unit = found.groups()
    quantity = {"V": "volts", "N": "newtons", "s": "seconds"}[unit]
    return quantity, float(number) * (1e-3 if milli else 1)


def _wanted(core: "Core", given: list[str]) -> list[tuple[str, int | None]]:
    """[(name, value or None)] of the arguments, all checked; a group's name stands for all its registers."""
    from meissner.host import names

    wanted: list[tuple[str, int | None]] = []
    for text in given or ["core", *core.features]:
        name, equals, given_value = text.partition("=")
        inside = [known for known in core.names() if known.split(".")[0] == name]
        if equals:
            core.check(name)
            try:
                amount = _amount(given_value)
                value = core.units.code(name, *amount) if amount else int(given_value, 0)
            except ValueError as problem:
                why = (
                    str(problem)
                    if amount
                    else f"{given_value!r} is neither an integer nor volts, newtons or seconds"
                )
                raise ValueError(f"{text}: {why}") from None
            core.check(name, value)
            wanted.append((name, value))
        elif inside:
            wanted += [(known, None) for known in inside]
        else:
            names.place(name)
            core.check(name)
            wanted.append((name, None))
    return wanted


def regs(arguments: Namespace) -> None:
    with _connect(arguments, registers=True) as core:
        wanted = _wanted(core, arguments.names)
        for name, value in wanted:
            if value is not None:
                core[name] = value
        width = max(len(name) for name, _ in wanted)
        for name, _ in wanted:
            value = core[name]
            field = core.check(name).field
            print(f"{name:<{width}}  {value:<10} 0x{value & (field.most if field else 0xFFFFFFFF):x}")


def _on_page(arguments: Namespace) -> bool:
    return bool(arguments.web or arguments.web_port is not None)


def _port(arguments: Namespace) -> int:
    from meissner.host import web

    return web.PORT if arguments.web_port is None else int(arguments.web_port)


def live(arguments: Namespace) -> None:
    if _on_page(arguments):
        _live_web(arguments)
        return
    from meissner.host.view import View

    messages: list[str] = []
    listen = False if arguments.listen else None
    with _connect(arguments, listen, messages.append) as core, _stopping(core):
        core.ask_states()
        view = View(core)
        if sys.stdout.isatty():
            _live_picture(core, view, arguments.seconds, messages)
        else:
            _live_lines(core, view, arguments.seconds, messages)


def _live_web(arguments: Namespace) -> None:
    from meissner.host import web

    hear: list[Callable[[str], object]] = [_tell]

    def say(sentence: str) -> None:
        for each in hear:
            each(sentence)

    with _connect(arguments, False if arguments.listen else None, say) as core:
        source = web.OfCore(core, arguments.port)
        hear.append(source.say)
        with _stopping(source):
            web.serve(source, _port(arguments), arguments.seconds, _print)


@contextmanager
def shown(scene: Any, arguments: Namespace) -> Iterator[Callable[[Path], None]]:
    """A page that plays a scene while the block runs it; the function given links the report in a folder and
    returns at Ctrl-C."""
    from meissner.host import Core, simulated, web
    from meissner.host.line import Pipe

    pipe = simulated.of_scenes([scene], seed=arguments.seed)
    with Core(Pipe(pipe, scene.name), pipe.units, say=_tell) as core:
        source = web.OfCore(core, pipe.title)
        say = _tell if arguments.json else _print
        with web.beside(source, _port(arguments), say) as stay:

            def done(out: Path) -> None:
                say("the page stays, with a link to the report, until Ctrl-C")
                with _stopping(source):
                    stay((out / "report.html").read_bytes())

            yield done


def _print(sentence: str) -> None:
    print(plain(sentence), flush=True)


def _live_lines(core: "Core", view: "View", seconds: float | None, messages: list[str]) -> None:
    view.tick(time.monotonic())
    for item, beat in beats(core, seconds, LINE_S):
        line = view.add(item)
        if line:
            print(line, flush=True)
        while messages:
            _tell(messages.pop(0))
        if beat:
            view.tick(time.monotonic())
            print(view.line(), flush=True)
    for message in messages:
        _tell(message)
    view.tick(time.monotonic())
    print(view.line(), flush=True)


def _live_picture(core: "Core", view: "View", seconds: float | None, messages: list[str]) -> None:
    from rich.live import Live

    view.tick(time.monotonic())
    ticked = time.monotonic()
    with Live(view.picture(), auto_refresh=False) as shown:
        for item, beat in beats(core, seconds, PICTURE_S):
            view.add(item)
            while messages:
                view.messages.append(messages.pop(0))
            if beat:
                if time.monotonic() - ticked > LINE_S:
                    ticked = time.monotonic()
                    view.tick(ticked)
                shown.update(view.picture(), refresh=True)
        shown.update(view.picture(), refresh=True)


class Stoppable(Protocol):
    def stop(self) -> None:
        """End between two packets."""


@contextmanager
def _stopping(core: Stoppable) -> Iterator[None]:
    """Ctrl-C, SIGTERM or a closed terminal ends the stream between two packets, so that the file written
    is finished. A signal that the parent ignores, as nohup does, stays ignored."""

    def stop(*_: object) -> None:
        core.stop()
        with suppress(OSError, RuntimeError):  # the terminal is gone, or a write to it is under way
            _tell("stopped")

    signals = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    heard = [which for which in signals if signal.getsignal(which) != signal.SIG_IGN]
    before = {which: signal.signal(which, stop) for which in heard}
    try:
        yield
    finally:
        for which, handler in before.items():
            signal.signal(which, handler)


def log(arguments: Namespace) -> None:
    from meissner.host import Gap, log

    log.check_out(arguments.out)
    listen = False if arguments.listen else None
    with (
        _connect(arguments, listen) as core,
        _stopping(core),
        log.recording(arguments.out, core) as recording,
    ):
        core.ask_states()
        for item, beat in beats(core, arguments.seconds, log.FLUSH_S):
            if item is not None:
                recording.add(item)
            if isinstance(item, Gap):
                core.ask_states()
            if beat:
                recording.flush()
    counts = core.counts
    expected = f"{core.units.rows or 1}×{core.units.columns}"
    more = [
        (counts.images_unfit, f"images dropped because they do not have {expected} taxels"),
        (counts.unknown, "packets of unknown types"),
        (counts.unread, "packets dropped because this machine was too slow"),
        (counts.restarts, "restarts of the core"),
    ]
    print(
        f"{recording.packets} packets of {counts.bytes} bytes; {counts.lost} lost, {counts.damaged} damaged, "
        f"{counts.images_lost} images lost, {''.join(f'{count} {what}, ' for count, what in more if count)}"
        f"{counts.gaps} gaps ({counts.gap_s:.1f} s); {plain(arguments.out)}"
    )


def bridge_dds(arguments: Namespace) -> None:
    from meissner.host import dds_bridge

    with _connect(arguments, False if arguments.listen else None) as core, _stopping(core):
        dds_bridge.run(core, arguments.seconds, arguments.domain, _tell)


def bridge_foxglove(arguments: Namespace) -> None:
    from meissner.host import foxglove_bridge

    with _connect(arguments, False if arguments.listen else None) as core, _stopping(core):
        foxglove_bridge.run(core, arguments.seconds, arguments.listen_on, _tell)


def replay(arguments: Namespace) -> None:
    from meissner.host import log

    engines.load(arguments.engine)
    if arguments.out is None and not _on_page(arguments):
        raise ValueError("replay writes to --out OUT.npz, or shows the log on a page (--web)")
    found = log.read(arguments.log)
    if arguments.min_load is not None and arguments.min_load < 0:
        raise ValueError(f"min-load = {arguments.min_load} must not be negative")
    if arguments.out is not None and arguments.out.lower().endswith(".mcap"):
        _finish(arguments)
    elif arguments.out is not None:
        _compare(arguments, found)
    if _on_page(arguments):
        from meissner.host import web

        source = web.OfLog(found, arguments.log)
        with _stopping(source):
            web.serve(source, _port(arguments), None, _print)


def _finish(arguments: Namespace) -> None:
    from meissner.host import mcap_file

    if not arguments.log.lower().endswith(".mcap"):
        raise ValueError(f"{arguments.log} is no MCAP file, so --out cannot be one: name a .npz or .csv file")
    count = mcap_file.finish(arguments.log, arguments.out)
    print(f"{count} messages of {plain(arguments.log)}; {plain(arguments.out)}")


def _compare(arguments: Namespace, found: "Arrays") -> None:
    from meissner.host.replay import changes, differences, replay

    with files.results(arguments.out) as save:
        result = replay(found, arguments.engine, arguments.min_load)
        save(result)
    both, wrong, largest = differences(result)
    frames, rows, columns = found["image"].shape
    apart = ", ".join(f"{name} {value}" for name, value in largest.items())
    print(
        f"{frames} image{'s' * (frames > 1)} of {rows}×{columns} on engine {arguments.engine}; "
        f"{both} with the core's own centre of pressure, of which {wrong} differ"
        f"{f' (at most: {apart})' if wrong else ''}; "
        f"{'the log was not finished; ' if 'partial' in found else ''}{plain(arguments.out)}"
    )
    count, broken = changes(found)
    if count:
        print(f"{count} changes of channels' states, {broken} of them after others that are missing")
