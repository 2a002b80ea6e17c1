"""A stand-in for rclpy, since ROS is not installed: message classes from the definitions that rosbags holds
and from ros2/meissner_msgs, checked as rclpy's generated classes check them; a node that keeps what is
published.

It knows what the node uses, and nothing of executors, discovery or QoS.
"""

import array
import sys
from types import ModuleType, SimpleNamespace
from typing import ClassVar

from meissner.builds.toolchain import ROOT

INTEGERS = {f"{sign}int{bits}": bits for sign in ("", "u") for bits in (8, 16, 32, 64)}


def typestore():
    """rosbags' newest definitions and those of meissner_msgs."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.LATEST)
    for path in sorted((ROOT / "ros2/meissner_msgs/msg").glob("*.msg")):
        store.register(get_types_from_msg(path.read_text("utf-8"), f"meissner_msgs/msg/{path.stem}"))
    return store


def checked(store, node, value, where):
    """AssertionError unless ``value`` may stand in a field of that type; see rosidl_generator_py."""
    kind, inside = node
    name = inside if kind.name == "NAME" else inside[0]
    if kind.name == "BASE" and name in INTEGERS:
        low = -(1 << INTEGERS[name] - 1) if name[0] == "i" else 0
        fits = type(value) is int and low <= value < low + (1 << INTEGERS[name])
    elif kind.name == "BASE":
        takes = {"bool": bool, "float64": float, "float32": float, "string": str}
        takes |= {"octet": bytes, "byte": bytes}
        fits = type(value) is takes[name] and (type(value) is not bytes or len(value) == 1)
    elif kind.name == "NAME":
        fits = getattr(value, "KIND", None) == name
    else:
        element = inside[0]
        if element == (element[0], ("uint8", 0)):
            fits = isinstance(value, array.array) and value.typecode == "B"
        else:
            fits = isinstance(value, list)
            for one in value:
                checked(store, element, one, where)
    assert fits, (where, node, value)


def message_class(store, name):
    """The class of "package/msg/Type"."""
    constants, members = store.fielddefs[name]
    types = dict(members)

    class Message:
        KIND = name

        def __init__(self, **given):
            assert given.keys() <= types.keys(), (name, given.keys() - types.keys())
            assert given.keys() >= types.keys(), (name, types.keys() - given.keys())  # nothing is forgotten
            for key, value in given.items():
                setattr(self, key, value)

        def __setattr__(self, key, value):
            checked(store, types[key], value, f"{name}.{key}")
            object.__setattr__(self, key, value)

    for constant, _, value in constants:
        setattr(Message, constant, value)
    return Message


def plain(store, message):
    """The message as rosbags' own class, which can be serialised."""
    given = {}
    for key, node in store.fielddefs[message.KIND][1]:
        value = getattr(message, key)
        if node[0].name == "NAME":
            value = plain(store, value)
        elif isinstance(value, array.array):
            import numpy as np

            value = np.array(value, np.uint8)
        elif isinstance(value, list):
            value = [plain(store, one) for one in value]
        elif isinstance(value, bytes):
            value = value[0]
        given[key] = value
    return store.types[message.KIND](**given)


class Node:
    """``overrides``: parameters as a launch file gives them."""

    overrides: ClassVar = {}

    def __init__(self, name):
        self.name, self.published, self.said, self.parameters = name, [], [], {}
        self.callbacks = []

    def get_logger(self):
        return SimpleNamespace(warning=self.said.append)

    def declare_parameter(self, name, value, descriptor):
        assert name not in self.parameters
        value = self.overrides.get(name, value)
        for limits in getattr(descriptor, "integer_range", []):
            assert type(value) is int and limits.from_value <= value <= limits.to_value, (name, value)
        self.parameters[name] = SimpleNamespace(name=name, value=value)
        return self.parameters[name]

    def add_on_set_parameters_callback(self, callback):
        self.callbacks.append(callback)

    def set_parameters(self, **given):
        """As a client sets them, all or none."""
        new = [SimpleNamespace(name=name.replace("__", "."), value=value) for name, value in given.items()]
        result = self.callbacks[0](new)
        if result.successful:
            self.parameters |= {one.name: one for one in new}
        return result

    def create_publisher(self, kind, topic, qos):
        assert isinstance(qos, int) and qos > 0 and isinstance(topic, str)

        def publish(message):
            assert type(message) is kind
            self.published.append((topic, message))

        return SimpleNamespace(publish=publish)

    def destroy_node(self):
        pass


def install(monkeypatch, store):
    """Put the stand-in where the node imports rclpy and message packages from; returns rclpy."""

    def module(name, **content):
        made = ModuleType(name)
        vars(made).update(content)
        monkeypatch.setitem(sys.modules, name, made)
        return made

    packages = {}
    for name in store.fielddefs:
        package, _, short = name.split("/")
        packages.setdefault(package, {})[short] = message_class(store, name)
    for package, classes in packages.items():
        module(package)
        module(f"{package}.msg", **classes)
    loose = ("IntegerRange", "ParameterDescriptor", "SetParametersResult")  # their fields have defaults
    vars(sys.modules["rcl_interfaces.msg"]).update(dict.fromkeys(loose, SimpleNamespace))
    rclpy = module("rclpy", ok=lambda: True, spin_once=lambda node, timeout_sec: None)
    rclpy.init, rclpy.try_shutdown = lambda args=None: None, lambda: None
    module("rclpy.node", Node=Node)
    module("rclpy.executors", ExternalShutdownException=type("ExternalShutdownException", (Exception,), {}))
    monkeypatch.setattr(Node, "overrides", {})
    return rclpy
