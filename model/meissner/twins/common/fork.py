"""Twin of rtl/common/msn_fork.sv: every word goes once to each of two followers."""


def fork(words):
    """The words that each of the two followers gets, in order."""
    return list(words), list(words)
