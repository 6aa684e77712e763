"""The filters, one file each, and the words in which they are declared."""

from svgf_cl.filters.accumulation import Accumulation
from svgf_cl.filters.eaw import Eaw
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.kalman import Kalman
from svgf_cl.filters.lbf import Lbf
from svgf_cl.filters.sbf import Sbf
from svgf_cl.filters.svgf import Settings

__all__ = ["DEFAULT", "FILTERS", "Accumulation", "Eaw", "Kalman", "Lbf", "Sbf", "Settings"]

# By the name that the command line and the oracles know them by.
FILTERS: dict[str, type[Filter]] = {each.name: each for each in (Kalman, Settings, Eaw, Sbf, Lbf, Accumulation)}

# What is used where nobody chooses: by PSNR no other is better on any scene that was tried (docs/results.md).
DEFAULT = Kalman
