"""The constants of the four-electrode equations, in the form of the hardware's registers."""


def position_constant(across: int, along: int, r: float, R0: float) -> float:
    """C in x = C (E1-E3) / (2V0-E1-E3): ``along`` taxels between the electrodes, ``across`` perpendicular.

    No unit; r and R0 in ohms. Exact (Kirchhoff's law only), eq. 16-19. One taxel along gives 0, so x = 0.
    """
    if along == 1:
        return 0.0
    return (2 * across * (R0 / r) + (along + 1)) / (along - 1)


def cop_constants(m: int, n: int, r: float, R0: float, V0: float, k: float) -> tuple[float, float, float]:
    """Cx, Cy, Kf for an m x n mesh; r, R0 in ohms, k in newton ohms; V0 cancels. Eq. 16-19 and 29.

    x = Cx (E1-E3) / (2V0-E1-E3),  y = Cy (E2-E4) / (2V0+E2+E4): no unit;
    load = Kf (2V0-E1-E3) / (E1+E3-E2-E4) with Kf = 2k/R0, newtons.
    """
    return position_constant(m, n, r, R0), position_constant(n, m, r, R0), 2 * k / R0
