"""Extremes of rtl/forest/msn_forest_features.sv: steps from one end of the samples' range to the other."""

from itertools import product

from extremes.rows import row
from meissner.twins.forest.forest_features import ForestFeatures


@row("forest_features", {"": "0"})
def forest_features(see):
    for bits in (2, 17):
        ends = (-(2 ** (bits - 1)), -1, 0, 2 ** (bits - 1) - 1)
        for three in product(ends, repeat=3):
            found = ForestFeatures(1, 2, bits).next([list(three)])
            see.same(found.tolist(), [[three[1] - three[0], three[2] - three[1]]], (bits, three))
    assert ForestFeatures(4096, 256).next([[0]] * 4096).shape == (0, 256 * 4096)
    for channels, window, bits in ((0, 1, 17), (4097, 1, 17), (1, 0, 17), (1, 257, 17), (1, 1, 1)):
        see.refused(ForestFeatures, channels, window, bits)
