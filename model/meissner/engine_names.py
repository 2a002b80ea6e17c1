"""The engines by name, apart from meissner.engines so that the command line's help imports nothing else."""

NAMES = ("float", "fixed", "rtl")
VERILATED = ("rtl", "gate")  # held against fixed whenever they run; gate is rtl after synthesis
EVERY = (*NAMES, "gate")
