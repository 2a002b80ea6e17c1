"""Twins of rtl/cop."""
