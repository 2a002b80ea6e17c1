"""Test the proofs: Yosys's `mutate` breaks a block inside its harness, and the proof should fail.

All mutants of a block are in one SMT-LIB file; a constraint chooses one. Only cells of the block that a
property depends on are broken; faults in logic that no property reads are left to other kinds of evidence.

    mutate(proof, parameters, count)    {"of", "found", "broken", "equivalent": n, "passed": [line, ...]}

``found``: a counterexample from reset; ``broken``: the proof fails, but no run from reset within its depth
shows a violation; ``equivalent``: a solver shows that the mutant changes no register, and no output while its
`valid` is 1, in any state of the proof's invariant and for any inputs; ``passed``: none of these. The
invariant holds after the first reset, which the harness's signal `started` marks.
"""

import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from meissner.builds import yowasp
from verify import formal
from verify.formal import ROOT

BITS = 10
SEED = 1
LIMIT_S = 60  # CPU time to show one mutant equivalent


def broken_here(proof, line):
    """Whether mutant ``line`` changes a cell of the block. Inner blocks with their own proofs are broken
    there; a cell of `setundef` belongs to no block: it makes an undriven signal free."""
    *_, source = "", *re.findall(r"-src (\S+):", line)  # the last one; the others are the wires'
    others = {other.block for other in formal.proofs().values()} - {proof.block}
    inside = source.startswith("rtl/") and Path(source).stem.removeprefix("msn_") not in others
    return inside and "$setundef" not in line


def listed(proof, parameters, stem, count):
    """Yosys commands for ``count`` mutants of the block's own cells, evenly out of those that Yosys lists."""
    script = f"{formal.read(proof, parameters)}; opt_clean; write_rtlil {stem}.il; "
    script += f"mutate -list {8 * count} -seed {SEED} -o {stem}.mut"
    yowasp.yosys(script, f"{stem}.log")
    lines = (ROOT / f"{stem}.mut").read_text().splitlines()
    own = list(dict.fromkeys(line for line in lines if broken_here(proof, line)))
    return own[:: max(1, len(own) // count)][:count]


def verdict(proof, stem, number):
    """The proof's verdict on mutant ``number``; 0: the unchanged block."""
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
            holds = False  # no answer counts as a failed proof
            tag = "induction"
        if not holds:
            return "found" if tag == "base" else "broken"
    return "passed"


def question(text, top, number):
    """SMT-LIB: can two copies in one state, one with mutant ``number``, differ in outputs or next state?"""
    state = re.findall(rf"\(declare-fun (\|{top}#\d+(?:#0)?\|) \(\|{top}_s\|\)", text)  # #0: memories
    transition = re.search(rf"\(define-fun \|{top}_t\| .*?\n\)", text, re.S)[0]
    sources = re.findall(rf"\(= (.*) \(\|{top}#\d+(?:#0)?\| next_state\)\)", transition)
    outputs = re.findall(r"; yosys-smt2-wire (\w+_o) (\d+)", text)
    chosen = re.search(rf"\(define-fun \|{top}_n mutsel\| .*?(\|{top}#\d+\|)", text)[1]

    def value(name, copy):
        """The value of a wire in a copy."""
        return f"(|{top}_n {name}| {copy})"

    names = {name for name, _ in outputs}
    differ = [f"(not (= {s.replace(' state)', ' a)')} {s.replace(' state)', ' b)')}))" for s in sources]
    for name in sorted(names):
        one = f"(not (= {value(name, 'a')} {value(name, 'b')}))"
        valid = f"{name.split('_')[0]}_valid_o"
        if valid in names and name != valid and not name.endswith("ready_o"):
            one = f"(and {value(valid, 'a')} {one})"
        if "yosys-smt2-input rst_i" in text:
            one = f"(and (not {value('rst_i', 'a')}) {one})"  # outputs do not count during reset
        differ.append(one)
    same = [f"(assert (= ({name} a) ({name} b)))" for name in state if name != chosen]
    if "yosys-smt2-wire started 1" in text:
        same.append(f"(assert {value('started', 'a')})")  # the invariant holds only after the first reset
    return "\n".join(
        [
            "(set-logic QF_AUFBV)",
            text,
            f"(declare-fun a () |{top}_s|)\n(declare-fun b () |{top}_s|)",
            *same,
            f"(assert (|{top}_a| a))\n(assert (|{top}_u| a))\n(assert (|{top}_u| b))",
            f"(assert (= ({chosen} a) #b{0:0{BITS}b}))\n(assert (= ({chosen} b) #b{number:0{BITS}b}))",
            f"(assert (or {' '.join(differ)}))\n(check-sat)",
        ]
    )


def equivalent(proof, stem, number):
    """Whether a solver shows that mutant ``number`` makes no difference; False if it gives no answer."""
    path = ROOT / f"{stem}.{number}.smt2"
    path.write_text(question((ROOT / f"{stem}.smt2").read_text(), f"formal_{proof.name}", number))
    log = f"{stem}.{number}.equivalent.log"
    try:
        return yowasp.tool("yices-smt2", [str(path.relative_to(ROOT))], log, LIMIT_S).strip() == "unsat"
    except yowasp.ToolError:
        return False


def mutate(proof, parameters, count, jobs=2):
    """Break the block of ``proof`` at ``parameters`` in ``count`` places; see the module's docstring."""
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
    for place, said in enumerate(verdicts):
        if said == "passed" and proof.k and equivalent(proof, stem, place + 1):
            verdicts[place] = "equivalent"
    passed = [line for line, said in zip(lines, verdicts) if said == "passed"]
    brief = [
        re.sub(r"-(ctrlbit|wirebit|module|wire) \S+ ?", "", line.removeprefix("mutate ")) for line in passed
    ]
    return {
        "of": len(lines),
        "found": verdicts.count("found"),
        "broken": verdicts.count("broken"),
        "equivalent": verdicts.count("equivalent"),
        "passed": brief,
    }
