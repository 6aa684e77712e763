"""What the kernels and the oracle both state, each for itself so that neither copies the other's mistake, is equal."""

from __future__ import annotations

import re
from importlib import resources

import numpy as np
import pytest

from svgf_cl.device import programs
from svgf_cl.filters.formats import HALF_MAX
from svgf_cl.filters.temporal import UNKNOWN
from svgf_cl.oracle import albedo, bilateral, kalman, lbf, sbf, spatial, temporal, wavelet

# By the kernels' name. Where there are two values the second is that of 16-bit floats (HALF_HISTORY), or of 3x3 taps.
EXPECTED = {
    "MIN_ALBEDO": (albedo.ALBEDO_FLOOR,),
    "MIN_CHANNEL": (albedo.CHANNEL_FLOOR,),
    "DARK": (albedo.DARK,),
    "STEPS": (albedo.OCTAVE,),
    "OTHERS": (temporal.OTHERS_WEIGHT,),
    "MAX_CHANNEL": (temporal.CHANNEL_MAX,),
    "MIN_DEPTH": (temporal.DEPTH_RANGE[0],),
    "MAX_DEPTH": (temporal.DEPTH_RANGE[1],),
    "MIN_NORMAL2": (temporal.NORMAL_FLOOR,),
    "MAX_LIGHT": (temporal.ILLUMINATION_MAX[False],),  # in 16 bits the host gives it
    "MAX_LENGTH": (temporal.LENGTH_MAX[False], temporal.LENGTH_MAX[True]),
    "FAR": (temporal.MOTION_MAX,),
    "ENOUGH": (temporal.HISTORY_WEIGHT,),
    "LONG_HISTORY": (spatial.LONG_HISTORY,),
    "NEARLY_LONG": (spatial.NEARLY_LONG,),
    "RELATIVE_TOLERANCE": (spatial.LUMINANCE_TOLERANCE[0],),
    "LEAST_TOLERANCE": (spatial.LUMINANCE_TOLERANCE[1],),
    "MOST_OF_A_FRAME": (sbf.MOST_OF_A_FRAME,),
    "HALFWAY_NOISE": (lbf.HALFWAY["noise"],),
    "BLACK": (lbf.BLACK,),
    "LEAST_POWER": (lbf.EXPONENTS[0],),
    "GREATEST_POWER": (lbf.EXPONENTS[1],),
    "NORMAL_FLOOR": (bilateral.NORMAL_FLOOR,),
    "NORMAL_MOST": (bilateral.NORMAL_MOST,),
    "MIDDLE": (wavelet.SPLINES[2][0], wavelet.SPLINES[1][0]),
    "NOTHING_KNOWN": (kalman.NOTHING_KNOWN,),
    "RESIDUAL_GAIN": (kalman.RESIDUAL_GAIN,),
    "LEAST_SPREAD": (kalman.LEAST_SPREAD,),
    "CORRELATED_2": (kalman.CORRELATED[2],),
    "CORRELATED_3": (kalman.CORRELATED[3],),
    "CORRELATED_4": (kalman.CORRELATED[4],),
    "DOUBT_OF_CHANGE": (kalman.DOUBT_OF_CHANGE,),
    "RELATIVE_DOUBT": (kalman.RELATIVE_DOUBT,),
    "MOST_DOUBT": (kalman.MOST_DOUBT,),
    "ENOUGH_AROUND": (kalman.ENOUGH_AROUND,),
    "SHORT_HISTORY": (kalman.SHORT_HISTORY,),
    "SHARE_OF_VARIANCE": (kalman.SHARE_OF_VARIANCE,),
    "CALIBRATION": (kalman.CALIBRATION,),
    "TINY": (kalman.LEAST_DIVISOR,),
    "NEARER": (temporal.NEARER,),
}


def stated(name: str) -> set[np.float32]:
    """Every value that a kernel gives a name with `#define`, but those that are names themselves."""
    files = [file for file in resources.files("svgf_cl.kernels").iterdir() if file.name.endswith((".cl", ".clh"))]
    text = "\n".join(file.read_text(encoding="utf-8") for file in files)
    return {np.float32(value) for value in re.findall(rf"^#define {name} ([-+.\de]+)f?\b", text, re.MULTILINE)}


@pytest.mark.parametrize("name", EXPECTED)
def test_kernels_and_oracle_state_the_same(name: str) -> None:
    assert stated(name) == {np.float32(value) for value in EXPECTED[name]}


def test_unknown_history_of_antialiasing_is_below_all_that_is_known() -> None:
    (known,) = re.findall(r"^#define KNOWN .(\S+)f.", programs.source("taa"), re.MULTILINE)
    assert UNKNOWN < float(known) < 0


def test_light_in_16_bits_ends_where_its_format_does() -> None:
    assert temporal.ILLUMINATION_MAX[True] == HALF_MAX
