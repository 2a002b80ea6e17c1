"""What the twins of every stage share: the checks of their parameters, and the base of those with a state."""

LANES = range(1, 9)  # columns of a beat
LOAD_BITS = 16  # of four electrodes


def index_width(count):
    """msn_pkg::index_width: bits of an index 0 .. ``count`` - 1, at least one."""
    return max((count - 1).bit_length(), 1)


def within(**values):
    """ValueError unless each value lies within its limits: name=(value, lowest, highest), None for no end."""
    for name, (value, low, high) in values.items():
        if not (low <= value if high is None else low <= value <= high):
            limits = f"be at least {low}" if high is None else f"lie in {low} .. {high}"
            raise ValueError(f"{name} = {value} must {limits}")


def fits(settings, **limits):
    """``within`` for attributes of ``settings``: name=(lowest, highest)."""
    within(**{name: (getattr(settings, name), *ends) for name, ends in limits.items()})


def one_of(allowed, **values):
    """ValueError unless each of ``values`` is one of ``allowed``."""
    for name, value in values.items():
        if value not in allowed:
            raise ValueError(f"{name} = {value!r} must be one of {', '.join(map(str, allowed))}")


class Stream:
    """A twin with a state: ``reset`` begins, ``next`` continues where the last call ended."""

    def process(self, *given, **named):
        """``reset`` and then ``next``: everything in one call."""
        self.reset()
        return self.next(*given, **named)
