"""A rope in the grip of a fingertip of 3×3 sensors (docs/rope.md)."""
