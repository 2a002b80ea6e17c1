"""Twins of rtl/frontend."""
