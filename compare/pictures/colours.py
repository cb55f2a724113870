"""The colours of growth: the same on paper and on the explorer's page."""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
from matplotlib.colors import ListedColormap, to_hex

# Part of matplotlib's "Blues" that stands for growth. The lighter half is left out: a cell that grows slowly must not
# look like the white of a stable one. Its first colour has a contrast of 3 to white. Blue only, so that the orange
# curves stay visible on every shade.
GROWTH_PART = (0.58, 1.0)
# Shades of the map.
GROWTH_SHADES = 256
# What is neither stable nor unstable.
UNDECIDED_GREY = "#bbbbbb"
# Where there is no system.
REFUSED_GREY = "#eeeeee"

GROWTH_MAP = ListedColormap(mpl.colormaps["Blues"](np.linspace(*GROWTH_PART, GROWTH_SHADES)), name="growth")
GROWTH_PALETTE = tuple(to_hex(colour) for colour in GROWTH_MAP(np.arange(GROWTH_SHADES)))
