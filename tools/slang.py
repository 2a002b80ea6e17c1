"""slang on SystemVerilog, as strict as other vendors' tools: python tools/slang.py ARGUMENTS OF SLANG.

PyPI has slang as a Python module only. Prints what it finds; the exit code is 1 if that is anything.
"""

import sys

from pyslang.driver import Driver


def main():
    driver = Driver()
    driver.addStandardArgs()
    # slang splits the line again: each argument is quoted, as a sized constant has a quote of its own.
    if not driver.parseCommandLine(" ".join(f'"{argument}"' for argument in ("slang", *sys.argv[1:]))):
        return 2
    fine = driver.processOptions() and driver.parseAllSources() and driver.runFullCompilation(True)
    return 0 if fine else 1


if __name__ == "__main__":
    sys.exit(main())
