"""Points as NAME=VALUE words of the command line."""

import shlex


def text_of(point):
    """A point as the arguments of `--point`, such as ``bits=12 rate_hz=10000``."""
    return shlex.join(f"{key}={value}" for key, value in point.items())


def command_of(axis, point):
    """The command that measures a point again."""
    return f"meissner tradeoff --axis {axis.name} --point {text_of(point)}"


def point_of(axis, parts):
    """The point of NAME=VALUE words; the shipped point gives the others. ValueError in one sentence."""
    usual = {key: both[0] for key, both in axis.runs.items()}
    first = {key: values[0] for key, values in axis.values.items()}
    point = first | axis.shipped | usual
    for part in parts:
        key, equals, value = (each.strip() for each in part.partition("="))
        if not equals:
            raise ValueError(f"--point: '{part}' must be NAME=VALUE; the names are: {', '.join(point)}")
        if key not in point:
            raise ValueError(f"--point: {axis.name} has no '{key}'; the names are: {', '.join(point)}")
        point[key] = _value(key, value, point[key], axis.values.get(key, ()))
    for key in axis.runs:
        if not 1 <= point[key] <= 10**8:
            raise ValueError(f"--point: {key} = {point[key]} must lie in 1 .. 100000000")
    if not axis.legal(point):
        raise ValueError(f"--point: {text_of(point)} is not a point of {axis.name}: {axis.about}")
    return point


def _value(key, text, usual, values):
    """``text`` converted to the type of ``usual``; a string must be one of ``values``."""
    if isinstance(usual, str):
        if text not in values:
            raise ValueError(f"--point: {key} = '{text}' must be one of: {', '.join(map(str, values))}")
        return text
    try:
        value = float(text) if isinstance(usual, float) else int(text)
    except ValueError:
        kind = "a number" if isinstance(usual, float) else "a whole number"
        raise ValueError(f"--point: {key} = '{text}' must be {kind}") from None
    if not 0 <= value < 1e12:
        raise ValueError(f"--point: {key} = {text} must lie in 0 .. 1e12")
    return value
