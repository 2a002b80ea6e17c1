"""Twins of rtl/common."""
