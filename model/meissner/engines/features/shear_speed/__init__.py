"""Shear speed (docs/shear_speed.md)."""

TOP, BLOCKS = "msn_shear_speeds", ("msn_shear_speed", "msn_log2", "msn_exp2")
