"""Published values of the Optacon-II paper, by the section that prints them."""

# 4.1: the 29 frequencies.
FREQUENCIES = (
    1,
    5,
    9,
    10,
    12,
    14,
    15,
    16,
    18,
    20,
    30,
    40,
    45,
    50,
    60,
    70,
    75,
    80,
    90,
    100,
    120,
    140,
    150,
    160,
)
FREQUENCIES += (180, 200, 230, 250, 300)
FREE_V, FREE_HZ, FREE_DB, APART_DB, CORRELATION = 30.0, 230.0, 22.2, 0.2, 0.996  # 4.2
VOLTS = (10.0, 30.0, 50.0)  # 5.1
LOWEST_HZ = 150.0  # 5.2: of every voltage
SHALLOW_V, SHALLOW_HZ = 30.0, 20.0  # 5.2: SA-I and FA-I are reached from this voltage, up to this frequency
DEEP_HZ = 120.0  # 5.2: FA-II is above its plotted curve from here on
BURST_S, OUT_UM, OUT_DB, RIPPLE_UM, RIPPLE_DB, FELT_HZ = 0.4, 33.0, 30.0, 0.8, -2.0, 2.5  # 6.2
CHARACTERS_MIN, WORDS_MIN, LETTERS = 150.0, 30.0, 5  # appendix: letters of a word
PIN, STEPS = (3, 5), (2, 4)  # figure 13: row and column of a pin, and the steps in which it is on
