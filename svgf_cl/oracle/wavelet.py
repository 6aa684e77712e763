"""Float64 oracle of the a-trous wavelet filters: their splines."""

# By radius: linear for 1, cubic (B3) for 2.
SPLINES = {2: {-2: 1 / 16, -1: 1 / 4, 0: 3 / 8, 1: 1 / 4, 2: 1 / 16}, 1: {-1: 1 / 4, 0: 1 / 2, 1: 1 / 4}}
