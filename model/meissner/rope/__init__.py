"""Slip of a rope in a fingertip of 3×3 sensors, by differences of frames and a forest (docs/rope.md)."""
