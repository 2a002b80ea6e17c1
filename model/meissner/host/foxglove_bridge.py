"""A core's stream for Foxglove and Lichtblick: a websocket server of foxglove-sdk (docs/ros2.md)."""

from collections.abc import Callable
from queue import Empty, SimpleQueue
from typing import Any

from meissner.builds.toolchain import ROOT
from meissner.host.core import Core
from meissner.host.ros import TOPICS, definition, full_name, serialised
from meissner.host.stream import set_thresholds, stream, thresholds

LAYOUT = ROOT / "ros2/foxglove_layout.json"
ANSWER_S = 5.0  # that a client's question may wait for the core


def address(text: str) -> tuple[str, int]:
    """(host, port) of "HOST:PORT"."""
    host, _, port = text.rpartition(":")
    if not host or not port.isdecimal() or not 0 <= int(port) <= 65535:
        raise ValueError(f"listen-on = {text!r} must be HOST:PORT, as 127.0.0.1:8765")
    return host.strip("[]"), int(port)


def run(core: Core, seconds: float | None, listen_on: str, say: Callable[[str], object]) -> None:
    """Serve the stream until the line ends, or for ``seconds``.

    The server calls from threads of its own, and the host library has none: questions about parameters wait
    in a queue, which is emptied between two packets.
    """
    host, port = address(listen_on)
    try:
        import foxglove
        from foxglove.websocket import Capability, Parameter, ServerListener, StatusLevel
    except ImportError:
        raise ValueError(
            "the bridge to Foxglove needs foxglove-sdk: pip install 'meissner-touch[foxglove]'"
        ) from None
    questions: SimpleQueue[tuple[Callable[[], list[Any]], SimpleQueue[list[Any]]]] = SimpleQueue()

    def ask(question: Callable[[], list[Any]]) -> list[Any]:
        answer: SimpleQueue[list[Any]] = SimpleQueue()
        questions.put((question, answer))
        try:
            return answer.get(timeout=ANSWER_S)
        except Empty:
            return []

    def values(names: list[str]) -> list[Any]:
        try:
            with core.impatient():
                known = [name for name in thresholds(core) if not names or name in names]
                return [Parameter(name, value=core[name]) for name in known]
        except OSError as problem:
            refuse(problem)
            return []

    def change(wanted: dict[str, Any]) -> list[Any]:
        try:
            set_thresholds(core, wanted)
        except (ValueError, OSError) as problem:
            refuse(problem)
        return values(list(wanted))

    def refuse(problem: Exception) -> None:
        say(str(problem))
        server.publish_status(str(problem), StatusLevel.Warning)

    class Listener(ServerListener):
        def on_get_parameters(self, client: Any, param_names: list[str], request_id: Any = None) -> list[Any]:
            return ask(lambda: values(param_names))

        def on_set_parameters(self, client: Any, parameters: list[Any], request_id: Any = None) -> list[Any]:
            return ask(lambda: change({one.name: one.get_value() for one in parameters}))

    context = foxglove.Context()
    channels = {}
    for topic, kind in TOPICS.items():
        schema = foxglove.Schema(name=full_name(kind), encoding="ros2msg", data=definition(kind).encode())
        channels[topic] = foxglove.Channel(topic, schema=schema, message_encoding="cdr", context=context)
    try:
        server = foxglove.start_server(
            name="meissner",
            host=host,
            port=port,
            capabilities=[Capability.Parameters],
            server_listener=Listener(),
            context=context,
        )
    except (OSError, RuntimeError) as problem:
        raise OSError(f"{listen_on} cannot be listened on: {problem}") from None
    say(f"Foxglove or Lichtblick: open ws://{host}:{server.port}, import the layout {LAYOUT}; Ctrl-C ends")
    try:
        for found in stream(core, seconds):
            if found is not None:
                stamp, topic, message = found
                channels[topic].log(serialised(TOPICS[topic], message), log_time=stamp)
                continue
            while not questions.empty():
                question, answer = questions.get()
                answer.put(question())
    finally:
        server.stop()
