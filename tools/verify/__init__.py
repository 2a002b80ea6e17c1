"""Tools of the evidence: proofs, mutants, coverage, faults, fuzz."""
