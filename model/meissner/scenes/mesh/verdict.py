"""The sentence about a run of a four-wire sensor."""

from meissner.scenes.verdict import position_and_load as answer

__all__ = ["answer"]
