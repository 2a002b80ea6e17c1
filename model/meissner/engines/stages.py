"""An engine with the core's features that a scene names: no other stage is built or loaded."""

from meissner.engines import load
from meissner.engines.features import FEATURES, of

# {function of an engine: its feature}
STAGES = {
    **dict.fromkeys(("watch", "watch_pins", "windows"), "slip"),
    **{"cop": "cop", "cop4": "cop4", "cop_slip": "cop_slip", "demodulate": "demod", "calibrate": "calibrate"},
    **{name: name for name in FEATURES},
}


def need(features, name):
    """Raise ValueError unless ``name`` is among the core's ``features``."""
    if name not in features:
        raise ValueError(
            f"the core is built without {name}: features lists {', '.join(features) or 'nothing'}"
        )


def function(engine, name, *otherwise):
    """An engine's function for a stage; without one, ``otherwise`` or AttributeError."""
    found = load(engine)  # refuses an engine that cannot run here
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
