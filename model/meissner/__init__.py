"""Meissner: an open FPGA core for touch, its bit-exact twins and the physics it is judged on."""


def __getattr__(name):
    """``__version__``, looked up when it is asked for: importlib.metadata takes 40 ms of every start."""
    if name != "__version__":
        raise AttributeError(f"module 'meissner' has no attribute {name!r}")
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("meissner")
    except PackageNotFoundError:  # used from a source tree that was not installed
        return "0+source"
