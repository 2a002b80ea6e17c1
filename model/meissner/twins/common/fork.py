"""Twin of rtl/common/msn_fork.sv: every word, once, to both followers."""


def fork(words):
    """What each of the two followers gets of ``words``, in order."""
    return list(words), list(words)
