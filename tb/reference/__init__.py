"""What blocks compute, written a second time: plain loops from docs/ and the formulas, nothing of the twins.

Tests hold both against them: the RTL and its twin. docs/references.md says which reference is whose.
"""
