"""Numbers of the rope paper's tables, as printed."""

# Table III, in percent: accuracy, recall of 0 and 1, precision of 0 and 1.
_ROWS = {
    "A": ((91.3, 96.6, 77.2, 91.8, 89.4), (97.6, 98.4, 80.0, 99.1, 69.9)),
    "B": ((87.2, 87.6, 86.8, 89.3, 84.7), (96.0, 96.0, 96.7, 99.9, 51.6)),
    "C": ((81.4, 92.2, 52.8, 83.9, 71.3), (96.2, 97.3, 71.7, 98.7, 54.4)),
    "D": ((86.4, 95.4, 62.4, 87.1, 83.7), (96.7, 97.7, 75.0, 98.9, 59.2)),
    "E": ((91.3, 96.0, 78.7, 92.3, 88.1), (98.1, 98.6, 87.5, 99.5, 73.4)),
}
TABLE_3 = {
    (name, part): row for name, both in _ROWS.items() for part, row in zip(("validation", "test"), both)
}
# Table IV: time steps and milliseconds from t_s to the first alarm: ropes a to g by force control, then by
# speed control.
TABLE_4 = (
    *((-7.0, -175.0), (-12.7, -317.5), (-0.67, -16.8), (-4.67, -116.8), (-0.33, -8.23), (-0.33, -8.23)),
    *((-0.67, -16.8), (0.0, 0.0), (-4.50, -112.0), (-1.83, -45.8), (-1.33, -33.3), (-0.33, -8.3)),
    *((-0.33, -8.3), (-1.00, -25.0)),
)
TABLE_4_MEAN = (-65.1, 85.8)  # ms, mean and standard deviation of all trials
TABLE_1 = {"A27, 9 N": (29, -25.8), "A27, R shape, 9 N": (14, -57.3)}
