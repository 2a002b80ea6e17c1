"""Do the proofs see a fault? Yosys's `mutate` breaks a block inside its harness, one mutant at a time.

All mutants of a block are in one SMT-LIB file; a constraint chooses one. Only cells that a property depends on are
broken, and only the block's: a fault in what no property reads is the affair of other evidence.

    mutate(proof, parameters, count)    {"found": n, "broken": n, "passed": [line, ...]}

``found``: a counterexample from reset; ``broken``: the proof fails, but no run from reset within its depth shows
why; ``passed``: the proof holds in spite of the mutant, with its source line: it may be equivalent, or a hole.
"""

import re
from concurrent.futures import ThreadPoolExecutor

from meissner import yowasp
from meissner.trust import formal
from meissner.trust.formal import ROOT

BITS = 10
SEED = 1


def listed(proof, parameters, stem, count):
    """Yosys's commands of ``count`` mutants of the block's own cells, evenly over those it lists."""
    script = f"{formal.read(proof, parameters)}; opt_clean; write_rtlil {stem}.il; "
    script += f"mutate -list {8 * count} -seed {SEED} -o {stem}.mut"
    yowasp.yosys(script, f"{stem}.log")
    lines = (ROOT / f"{stem}.mut").read_text().splitlines()
    own = list(dict.fromkeys(line for line in lines if re.search(r"-src rtl/", line)))
    return own[:: max(1, len(own) // count)][:count]


def verdict(proof, stem, number):
    """What the proof says of mutant ``number``; 0: none."""
    constraint = f"{stem}.{number}.smtc"
    chosen = f"(= [mutsel] #b{number:0{BITS}b})"
    (ROOT / constraint).write_text(f"always\nassume {chosen}\n")
    for tag, options, _ in formal.steps(proof):
        options = [*options, "--smtc", constraint, "--noinfo"]
        try:
            holds, _ = formal.smtbmc(stem, f"{tag}.{number}", proof.solvers[0], options, proof.limit_s)
        except yowasp.ToolError as error:
            if "no answer" not in str(error):
                raise
            holds = False  # a proof without an answer has failed
            tag = "induction"
        if not holds:
            return "found" if tag == "base" else "broken"
    return "passed"


def mutate(proof, parameters, count, jobs=2):
    """Break the block of ``proof`` at ``parameters`` in ``count`` places; see the module's text."""
    stem = f"{formal.OUT}/{proof.name}.mutants"
    lines = listed(proof, parameters, stem, count)
    applied = [
        f"{line.replace('mutate ', f'mutate -ctrl mutsel {BITS} {number} ', 1)}"
        for number, line in enumerate(lines, 1)
    ]
    script = [f"read_rtlil {stem}.il", *applied, *formal.lower(proof, stem).split("; ")]
    (ROOT / f"{stem}.ys").write_text("\n".join(script) + "\n")
    yowasp.yosys(f"script {stem}.ys", f"{stem}.log")
    if verdict(proof, stem, 0) != "passed":
        raise yowasp.ToolError(f"{proof.name} does not hold without a mutant")
    with ThreadPoolExecutor(jobs) as pool:
        verdicts = list(pool.map(lambda n: verdict(proof, stem, n), range(1, len(lines) + 1)))
    passed = [line for line, said in zip(lines, verdicts) if said == "passed"]
    brief = [
        re.sub(r"-(ctrlbit|wirebit|module|wire) \S+ ?", "", line.removeprefix("mutate ")) for line in passed
    ]
    return {
        "mutants": len(lines),
        "found": verdicts.count("found"),
        "broken": verdicts.count("broken"),
        "passed": brief,
    }
