"""Run slang on SystemVerilog, as strict as other tools: python tools/make/slang.py ARGUMENTS OF SLANG.

PyPI offers slang only as a Python module. Prints the findings; the exit code is 1 if there are any.
"""

import sys

from pyslang.driver import Driver


def main():
    driver = Driver()
    driver.addStandardArgs()
    # slang splits the joined line again: quote each argument, since sized constants contain a quote.
    if not driver.parseCommandLine(" ".join(f'"{argument}"' for argument in ("slang", *sys.argv[1:]))):
        return 2
    fine = driver.processOptions() and driver.parseAllSources() and driver.runFullCompilation(True)
    return 0 if fine else 1


if __name__ == "__main__":
    sys.exit(main())
