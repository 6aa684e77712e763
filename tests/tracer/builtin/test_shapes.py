from __future__ import annotations

import numpy as np
import pytest

from svgf_cl_tracer.builtin import shapes
from svgf_cl_tracer.geometry import Instance
from svgf_cl_tracer.materials import Material

MATT = Material()


def face_normals(instance: Instance) -> np.ndarray:
    a, b, c = np.moveaxis(np.asarray(instance.corners, float), 1, 0)
    return np.cross(b - a, c - a)


def volume(instance: Instance) -> float:
    """Positive where the fronts look outwards."""
    a, b, c = np.moveaxis(np.asarray(instance.corners, float), 1, 0)
    return float(np.einsum("tx,tx->", a, np.cross(b, c)) / 6.0)


def test_a_quad_looks_to_right_x_up_and_repeats_its_texture() -> None:
    quad = shapes.quad((1, 0, 0), (2, 0, 0), (0, 3, 0), MATT, repeat=(4, 5))
    np.testing.assert_allclose(face_normals(quad), [(0, 0, 6)] * 2)
    np.testing.assert_allclose(quad.uv.max((0, 1)), (4, 5))


def test_a_panel_looks_at_its_target() -> None:
    panel = shapes.panel((1.0, 3.0, 2.0), (0.0, 0.0, 0.0), (0.5, 2.0), MATT)
    np.testing.assert_allclose(panel.corners.reshape(-1, 3).min(0) + panel.corners.reshape(-1, 3).max(0), (2, 6, 4))
    normal = face_normals(panel).sum(0) / 2.0
    np.testing.assert_allclose(np.linalg.norm(normal), 1.0)  # its area
    np.testing.assert_allclose(normal, -np.array((1.0, 3.0, 2.0)) / np.sqrt(14.0), atol=1e-12)


@pytest.mark.parametrize(
    ("shape", "expected"),
    [
        (shapes.ball(2.0, (5, 1, -3), MATT), 4.0 / 3.0 * np.pi * 8.0),
        (shapes.ring(2.0, 0.5, (5, 1, -3), MATT), 2.0 * np.pi**2 * 2.0 * 0.25),
        (shapes.lathe([(0, 0), (1, 0), (1, 2), (0, 2)], MATT, (5, 1, -3)), 2.0 * np.pi),
        (shapes.merged([shapes.rod((0, 0, 0), (0, 3, 4), 0.1), shapes.box((1, 2, 3))], MATT), 6.0 + 0.05 * np.pi),
    ],
    ids=["ball", "ring", "lathe", "merged"],
)
def test_a_solid_is_closed_and_faces_outwards(shape: Instance, expected: float) -> None:
    assert volume(shape) == pytest.approx(expected, rel=0.03)


def test_a_lathe_stands_on_its_foot_and_keeps_sharp_edges() -> None:
    cylinder = shapes.lathe([(0, 0), (1, 0), (1, 2), (0, 2)], MATT, (5, 1, -3))
    np.testing.assert_allclose(cylinder.corners.reshape(-1, 3).min(0), (4, 1, -4), atol=1e-9)
    flat = np.abs(cylinder.normals[..., 1]) > 0.5
    np.testing.assert_allclose(np.abs(cylinder.normals[flat]), [(0, 1, 0)] * flat.sum(), atol=1e-6)
    np.testing.assert_allclose(cylinder.normals[~flat][:, 1], 0.0, atol=1e-6)


def test_a_curve_passes_through_its_points_and_not_beyond() -> None:
    points = [(0.0, 0.0), (1.0, 0.2), (0.3, 1.0), (0.0, 1.5)]
    fine = np.array(shapes.curve(points, 6))
    np.testing.assert_allclose(fine[::6], points, atol=1e-12)
    np.testing.assert_allclose(fine.max(0), (1.0, 1.5))
    assert fine.min() >= 0.0


def test_a_band_lies_between_two_lines() -> None:
    line = np.array([(0, 0, 0), (1, 0, 0), (3, 0, 0)], float)
    a, b, c = shapes.band(line, line + np.array((0, 2, 0))).transpose(1, 0, 2)
    np.testing.assert_allclose(np.cross(b - a, c - a)[:, 2].sum(), 2.0 * 6.0)


def test_an_orbit_looks_at_its_centre_from_a_circle() -> None:
    front, side = shapes.orbit((1.0, 2.0, 3.0), 4.0, 0.5, (0.0, 90.0), 40.0)
    assert front.position == pytest.approx((1.0, 2.5, 7.0))
    assert side.position == pytest.approx((5.0, 2.5, 3.0))
    assert front.look_at == side.look_at == (1.0, 2.0, 3.0)
