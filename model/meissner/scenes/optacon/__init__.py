"""A display of tactile pins under a fingertip, as published of the Optacon-II (docs/papers/optacon.md)."""
