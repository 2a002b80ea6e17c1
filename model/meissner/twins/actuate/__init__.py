"""Twins of rtl/actuate."""
