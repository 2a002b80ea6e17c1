"""Fuzz every reader of lines and files with mutated and generated input: packet decoders, recordings,
configurations, calibrations, logs.

    python tools/fuzz.py [--cases N] [--seed N] [--first N] [--record] [TARGET ...]     default: all

Runs a million cases on each decoder, and on each other reader as many as take a minute or two. Prints a line
per target. Stops with an error at the first case that crashes, hangs, yields a packet that was not sent, or
is refused with anything but one sentence; `--first N --cases 1` repeats it. Seed inputs are in tb/corpus.
"""

import argparse
import sys
import time
import warnings

from verify import fuzz, readers, record


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    targets = [*fuzz.TARGETS, fuzz.C_NAME]
    parser.add_argument("targets", nargs="*", metavar="TARGET", help=", ".join(targets))
    parser.add_argument("--cases", type=int, help="default: as many as run in a minute or two")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--record", action="store_true", help="into docs/trust/fuzz.json")
    given = parser.parse_args()
    unknown = sorted(set(given.targets) - set(targets))
    if unknown:
        sys.exit(f"fuzz: there is no target {', '.join(unknown)}; there are {', '.join(targets)}")
    if given.cases is not None and given.cases < 1:
        sys.exit("fuzz: no case is no test")
    warnings.simplefilter("ignore")  # NumPy warns about odd headers
    for target in given.targets or targets:
        begin, how = time.monotonic(), ""
        of = readers.digest(target)  # before the run: files may change meanwhile
        cases = given.cases or fuzz.CASES.get(target, 1_000_000)
        try:
            if target == fuzz.C_NAME:
                how = fuzz.run_c(cases, given.seed)
            else:
                how = f"the slowest {1e3 * fuzz.run(target, cases, given.seed, given.first):.0f} ms"
        except fuzz.Failed as failed:
            again = f"python tools/fuzz.py {target} --seed {given.seed}"
            sys.exit(f"{failed}\nagain: {again} --cases 1 --first N, or --cases {cases}")
        took = time.monotonic() - begin
        print(f"{target:15} {cases:8} cases in {took:.0f} s, {how}", flush=True)
        if given.record:
            facts = {"of": of, "cases": cases, "crashes": 0, "hangs": 0, "false": 0}
            record.merge("fuzz", "make fuzz", {target: facts}, fuzz.summary, fuzz.total)


if __name__ == "__main__":
    main()
