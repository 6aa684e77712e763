"""Float64 oracle of what a-trous wavelet filters share: their splines."""

# By radius: of B3, and linear.
SPLINES = {2: {-2: 1 / 16, -1: 1 / 4, 0: 3 / 8, 1: 1 / 4, 2: 1 / 16}, 1: {-1: 1 / 4, 0: 1 / 2, 1: 1 / 4}}
