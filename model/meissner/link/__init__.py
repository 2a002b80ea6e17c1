"""Twins of rtl/link."""
