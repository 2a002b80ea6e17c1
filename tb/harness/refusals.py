"""Parameters that cannot work: a block must not elaborate with them, and its twin must not be made; both name
the parameter. What else the sentence says is free."""

import re

import pytest

from harness.runner import refuses


def snake(name):
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name).lower()


def refused(twin, *cases, **given):
    """``twin`` must refuse each of ``cases``, arguments of which the first is the wrong one."""
    for case in cases:
        with pytest.raises(ValueError, match=rf"\b{next(iter(case))}\b"):
            twin(**given | case)


def refusals(block, twin, *cases, alone=(), **given):
    """A test: block and twin refuse ``cases``, parameters of the block of which the first is the wrong one.

    The twin has them in lower case, beside those ``given``. ``alone``: cases of the block alone.
    """

    def test():
        for case in (*cases, *alone):
            assert re.search(rf"\b{next(iter(case))}\b", refuses(block, case)), case
        refused(twin, *({snake(name): value for name, value in case.items()} for case in cases), **given)

    return test
