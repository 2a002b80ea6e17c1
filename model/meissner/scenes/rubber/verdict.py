"""The sentence about a run of a slip scene."""

from meissner.scenes.verdict import slips as answer

__all__ = ["answer"]
