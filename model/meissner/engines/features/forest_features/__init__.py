"""Features of a forest: differences of successive frames, in a window (docs/rope.md)."""

TOP, BLOCKS = "msn_forest_features", ("msn_delay", "msn_ram")
