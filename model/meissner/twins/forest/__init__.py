"""Twins of rtl/forest."""
