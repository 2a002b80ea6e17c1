"""The published four-wire resistor mesh: circuit, solvers, constants and the correction of its load."""

from meissner.physics.mesh.constants import cop_constants, position_constant
from meissner.physics.mesh.mesh import Mesh
from meissner.physics.mesh.solution import Bound, Solution

__all__ = ["Bound", "Mesh", "Solution", "cop_constants", "position_constant"]
