"""Meissner: an open FPGA core for touch, its bit-exact twins and the physics it is judged on."""

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("meissner")
except PackageNotFoundError:  # used from a source tree that was not installed
    __version__ = "0+source"
