"""The shipped network: its size, its finite weights, and what is said of how it was made."""

from __future__ import annotations

import json
from importlib import resources

import numpy as np

from svgf_cl.filters.lbf import FILE, HIDDEN, INPUTS, OUTPUTS, Network


def test_the_shipped_network_has_its_shapes() -> None:
    network = Network.shipped()
    assert network.first.shape == (HIDDEN, INPUTS)
    assert network.first_bias.shape == (HIDDEN,)
    assert network.second.shape == (OUTPUTS, HIDDEN)
    assert network.second_bias.shape == (OUTPUTS,)
    assert np.isfinite(network.flat()).all()


def test_the_kernel_reads_the_first_layer_input_by_input() -> None:
    network = Network.shipped()
    flat = network.flat()
    np.testing.assert_array_equal(flat[HIDDEN : 2 * HIDDEN], network.first[:, 1].astype(np.float32))
    np.testing.assert_array_equal(flat[-OUTPUTS:], network.second_bias.astype(np.float32))
    assert len(flat) == HIDDEN * (INPUTS + 1) + OUTPUTS * (HIDDEN + 1)


def test_the_file_says_what_made_it_and_how_good_it_is() -> None:
    about = json.loads((resources.files("svgf_cl.filters") / FILE).read_text(encoding="utf-8"))["about"]
    assert about["command"].startswith("python -m benchmarks.training")
    assert {"device", "svgf_cl", "date", "seconds of training"} <= set(about)
    for errors in about["error on held-out scenes"].values():
        assert errors["LBF"] < errors["accumulated"]
