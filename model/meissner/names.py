"""Names that the command line's help shows, apart from what they name: help imports nothing else."""

NAMES = ("float", "fixed", "rtl")
VERILATED = ("rtl", "gate")  # held against fixed whenever they run; gate is rtl after synthesis
EVERY = (*NAMES, "gate")
PICTURE = "budget_cop4.png"  # of `meissner budget --cop4`
