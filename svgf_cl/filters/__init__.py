"""The filters, one file each, and the classes that declare them."""

from svgf_cl.filters.accumulation import Accumulation
from svgf_cl.filters.eaw import Eaw
from svgf_cl.filters.filter import Filter
from svgf_cl.filters.kalman import Kalman
from svgf_cl.filters.lbf import Lbf
from svgf_cl.filters.sbf import Sbf
from svgf_cl.filters.svgf import Settings

__all__ = ["DEFAULT", "FILTERS", "Accumulation", "Eaw", "Kalman", "Lbf", "Sbf", "Settings"]

# The command line and the oracles look filters up by these names.
FILTERS: dict[str, type[Filter]] = {each.name: each for each in (Kalman, Settings, Eaw, Sbf, Lbf, Accumulation)}

# Used where nobody chooses a filter. On every scene that was tried it has the best PSNR of all filters
# (docs/results.md).
DEFAULT = Kalman
