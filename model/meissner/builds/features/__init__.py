"""Features of a core with their own tables in a build's file, a module each: grip defines [grip].

A module has Keys, the table; PARAMETERS of rtl/msn_core.sv; ``config(keys, base)``, which returns the
feature's settings, with ``settings`` {register of the group of that name: value}; and ``check(base)``,
ValueError if the build ``base`` (meissner.builds.build.Config) does not suit it. If it limits the rate:
``clocks(base)`` from frame to frame, and TAKES, what takes them.
"""

from importlib import import_module
from pkgutil import iter_modules

FEATURES = {found.name: import_module(f"{__name__}.{found.name}") for found in iter_modules(__path__)}
