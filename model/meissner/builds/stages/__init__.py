"""Stages of a core with tables of their own in a build's file: the module grip here says what [grip] is.

A module has DEFAULTS, the table's keys; PARAMETERS, of rtl/msn_core.sv; ``config(at, given, base)``, the
stage's settings of the checked table, with ``settings`` {register of the group of that name: value}; and
``check(base)``, ValueError where the build ``base`` (meissner.builds.build.Config) does not go with it.
"""

from importlib import import_module
from pkgutil import iter_modules

STAGES = {found.name: import_module(f"{__name__}.{found.name}") for found in iter_modules(__path__)}
