"""The sentence about a run of an array of forces."""

from meissner.scenes.verdict import position_and_load as answer

__all__ = ["answer"]
