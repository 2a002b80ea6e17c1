"""The node: a core's packets on topics, its thresholds as parameters, its state on /diagnostics.

What is in a message is decided in meissner.host.ros, of the Python package ``meissner``.
"""

import array
import sys
from importlib import import_module

import rclpy
from rcl_interfaces.msg import IntegerRange, ParameterDescriptor, SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

from meissner import host
from meissner.builds import config
from meissner.host.ros import FRAME_ID, TOPICS, made
from meissner.host.stream import set_thresholds, stream, thresholds

DEPTH = 10  # messages kept for a subscriber that is slow; reliable, so that every subscriber fits


def message_class(kind):
    """The class of a message ("package/Type")."""
    package, name = kind.split("/")
    return getattr(import_module(f"{package}.msg"), name)


def name_of(topic):
    """Relative to the node's namespace, but for /diagnostics, which is one for the whole robot."""
    return topic if topic == "/diagnostics" else topic.removeprefix("/")


def leaf(kind, value):
    """A value of a basic type as rclpy takes it."""
    if kind == "byte":
        return bytes([value])
    return array.array("B", value) if kind == "uint8[]" else value


class TactileNode(Node):
    def __init__(self, **more):
        super().__init__("meissner", **more)
        told = {
            name: self.declare_parameter(name, default, ParameterDescriptor(description=what)).value
            for name, default, what in (
                ("port", "/dev/ttyUSB0", "the line to the core, as for meissner live"),
                ("config", "", "the core's configuration, for physical units: a name or a TOML file"),
                ("calibration", "", "a file of meissner calibrate to write into the core first"),
                ("listen", False, "do not read registers (a core without them)"),
                ("frame_id", FRAME_ID, "the frame of every message"),
            )
        }
        self._frame_id = told["frame_id"]
        build = config.load(told["config"]) if told["config"] else None
        registers = False if told["listen"] or (build and not build.link.registers) else None
        self.core = host.connect(
            told["port"],
            build.units if build else None,
            registers,
            build.link.baud if build else None,
            say=self.get_logger().warning,
        )
        try:
            if told["calibration"]:
                from meissner import calibration
                from meissner.host.load import load

                load(self.core, calibration.load(told["calibration"]))
            self._declare_thresholds()
        except BaseException:
            self.core.close()
            raise
        self._publishers_of = {
            topic: self.create_publisher(message_class(kind), name_of(topic), DEPTH)
            for topic, kind in TOPICS.items()
        }

    def _declare_thresholds(self):
        """The core's own values, unless a launch file has others, which are written into the core."""
        given = {}
        for name in thresholds(self.core):
            least, most = self.core.check(name).ends(self.core.build)
            about = ParameterDescriptor(
                description=f"register {name} of the core, in codes (docs/registers.md)",
                integer_range=[IntegerRange(from_value=least, to_value=most, step=1)],
            )
            now = self.core[name]
            value = self.declare_parameter(name, now, about).value
            if value != now:
                given[name] = value
        set_thresholds(self.core, given)
        self.add_on_set_parameters_callback(self._set)

    def _set(self, parameters):
        """Write thresholds into the core and read them back; refuse what else would need a restart."""
        try:
            names = thresholds(self.core)
            for one in parameters:
                if one.name in ("port", "config", "calibration", "listen", "frame_id"):
                    raise ValueError(f"{one.name} is read when the node starts")
            set_thresholds(self.core, {one.name: one.value for one in parameters if one.name in names})
        except (ValueError, OSError) as problem:
            return SetParametersResult(successful=False, reason=str(problem))
        return SetParametersResult(successful=True)

    def run(self, seconds=None):
        """Publish until ROS shuts down, or the line (a file) ends."""
        for found in stream(self.core, seconds, self._frame_id):
            if found is None:
                rclpy.spin_once(self, timeout_sec=0)
                if not rclpy.ok():
                    return
            else:
                _, topic, message = found
                ready = made(TOPICS[topic], message, message_class, leaf)
                self._publishers_of[topic].publish(ready)


def main(args=None):
    rclpy.init(args=args)
    try:
        node = TactileNode()
        try:
            node.run()
        finally:
            node.core.close()
            node.destroy_node()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except (ValueError, OSError) as problem:
        print(f"meissner: {problem}", file=sys.stderr)
        return 2
    finally:
        rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
