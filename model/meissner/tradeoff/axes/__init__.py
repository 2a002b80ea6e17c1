"""The axes: a module per subject with ``AXES``, a tuple of meissner.tradeoff.axis.Axis; none is listed."""
