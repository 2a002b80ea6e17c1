"""What blocks compute, written a second time as plain loops from docs/ and the formulas, without the twins.

Tests compare both the RTL and its twin with them.
"""
