"""An engine with the core's features that a scene names: another stage is neither built nor loaded."""

from meissner.engines import load
from meissner.engines.features import FEATURES, of

# {function of an engine: the feature that it is}
STAGES = {
    **dict.fromkeys(("watch", "watch_pins", "windows"), "slip"),
    **{"cop": "cop", "cop4": "cop4", "cop_slip": "cop_slip", "demodulate": "demod", "calibrate": "calibrate"},
    **{name: name for name in FEATURES},
}


def need(features, name):
    """ValueError unless a core with these ``features`` has that one."""
    if name not in features:
        raise ValueError(
            f"the core is built without {name}: features names {', '.join(features) or 'nothing'}"
        )


def function(engine, name, *otherwise):
    """That of an engine for a stage; ``otherwise``, or AttributeError, where it has none."""
    found = load(engine)  # refuses what cannot run here
    if name in FEATURES:
        return of(name)[engine]
    return getattr(found, name, *otherwise)


class Stages:
    """The functions of an engine (meissner.engines.protocol) that belong to ``features``."""

    def __init__(self, engine, features):
        self._engine, self._features = engine, features

    def __getattr__(self, name):
        if name not in STAGES:
            raise AttributeError(name)
        need(self._features, STAGES[name])
        return function(self._engine, name)
