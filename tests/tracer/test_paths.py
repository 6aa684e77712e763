from __future__ import annotations

import numpy as np
import pytest

from svgf_cl.frame import CHANNELS
from svgf_cl_tracer.paths import Features, Paths, Radiance, ShadowRays


@pytest.mark.parametrize("kind", [Paths, ShadowRays])
def test_the_first_rays_of_a_batch_are_the_batchs_own(kind: type[Paths] | type[ShadowRays]) -> None:
    rays = kind.empty(5)
    part = rays.first(2)
    assert isinstance(part, kind)
    for values, all_values in zip(part, rays, strict=True):
        assert len(values) == 2
        assert len(all_values) == 5
        assert np.shares_memory(values, all_values)


@pytest.mark.parametrize("kind", [Features, Radiance])
def test_part_of_an_image_is_written_where_it_stays(kind: type[Features] | type[Radiance]) -> None:
    image = kind.empty(6)
    for values in image:
        values[:] = 0
    for values in image.part(slice(2, 4)):
        values[:] = 1
    for values in image:
        np.testing.assert_array_equal(values.reshape(6, -1).max(1), (0, 0, 1, 1, 0, 0))


def test_together_they_are_the_fields_of_a_frame() -> None:
    fields = Features.empty(3)._asdict() | Radiance.empty(3)._asdict()
    assert set(fields) == set(CHANNELS)
    for name, values in fields.items():
        assert (values.shape[1:] or (0,))[0] in CHANNELS[name]
        assert values.dtype == (np.uint32 if name == "id" else np.float32)
