"""The limits of tb/limits.toml, the one file that says what the nightly checks must reach."""

import tomllib

from meissner.builds import toolchain

FILE = toolchain.ROOT / "tb/limits.toml"


class Limits:
    """``table``: the contents of the file; ValueError, with one sentence, if an exception has no reason."""

    def __init__(self, table=None):
        self.table = tomllib.loads(FILE.read_text("utf-8")) if table is None else table
        for kind, entry in self.table.items():
            for name, rows in entry.items():
                for row in rows if isinstance(rows, list) else ():
                    if not row.get("reason", "").strip():
                        raise ValueError(f"{FILE.name}: a row of {kind}.{name} has no reason: {row}")

    def open(self, block):
        """The kinds of netlist proof that may be open for a block."""
        rows = [row for row in self.table["netlists"]["open"] if block in row["blocks"]]
        return sorted({row["proof"] for row in rows})

    def waived(self, block):
        """How many coverage points of a block may be waived."""
        return self.table["coverage"]["waived"].get(block, 0)

    def killed(self):
        """The share of the mutants that are not equivalent which the tests must kill."""
        return self.table["mutants"]["killed"]

    def equivalent(self, block):
        """The (source line, change) of the mutants that a person has shown to be equivalent."""
        rows = self.table["mutants"]["equivalent"]
        return {(row["text"], row["change"]) for row in rows if row["block"] == block}

    def undetected(self, block, where):
        """Whether an undetected upset of the state bit ``where``, "register.bit", is a named exception."""
        register, _, bit = where.rpartition(".")
        if not bit.isdecimal():  # a register of one bit has no number
            register, bit = where, "0"
        return any(
            (row["block"], row["register"]) == (block, register) and str(row["bit"]) in ("any", bit)
            for row in self.table["faults"]["undetected"]
        )
