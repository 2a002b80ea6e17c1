"""Twins of rtl/sensor."""
