"""Twins of rtl/slip."""
