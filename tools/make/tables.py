"""Write rtl/common/msn_{log2,exp2}_pkg.sv, the tables of msn_log2 and msn_exp2, from their twins."""

from meissner.builds import toolchain
from meissner.twins.common import exp2, log2

WIDTH = log2.ENTRY_BITS + 1  # the last entry is 1.0
HEAD = """// SPDX-License-Identifier: Apache-2.0
//
// Table of msn_{name} at 1/256, a fraction of 28 bits, to nearest; entry 0 lowest.
//
//   Entries[i] = {formula}, i = 0 .. 256
//
// Written by `python tools/make/tables.py` from integers: no tool computes a logarithm of its own.
// Model: model/meissner/twins/common/{name}.py

package msn_{name}_pkg;

  // Builds without msn_{name} read this file, too.
  // verilator lint_off UNUSEDPARAM
  localparam logic [257*{width}-1:0] Entries = {{
{entries}
  }};
  // verilator lint_on UNUSEDPARAM

endpackage
"""


def package(name, formula, entries):
    """The text of a package; the last entry first, six per line."""
    words = [f"{WIDTH}'h{entry:08x}" for entry in reversed(entries)]
    lines = [", ".join(words[at : at + 6]) for at in range(0, len(words), 6)]
    body = ",\n".join(f"    {line}" for line in lines)
    return HEAD.format(name=name, formula=formula, width=WIDTH, entries=body)


def packages():
    """{path: text} of both packages."""
    texts = {
        "log2": package("log2", "log2(1 + i/256)", log2.finest()),
        "exp2": package("exp2", "2^(i/256) - 1", exp2.finest()),
    }
    return {toolchain.ROOT / f"rtl/common/msn_{name}_pkg.sv": text for name, text in texts.items()}


if __name__ == "__main__":
    for path, text in packages().items():
        path.write_text(text, "utf-8")
