"""Names that the command line's help shows, kept apart so that help imports nothing else."""

NAMES = ("float", "fixed", "rtl")
VERILATED = ("rtl", "gate")  # compared with fixed whenever they run; gate is rtl after synthesis
EVERY = (*NAMES, "gate")
PICTURE = "budget_cop4.png"  # of `meissner budget --cop4`
DISTRIBUTION = "meissner-touch"  # the name under which pip installs the package
