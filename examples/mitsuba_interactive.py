"""Denoises frames of Mitsuba 3 while it renders: each frame goes to the denoiser as arrays, without a file.

It needs `pip install mitsuba` in addition to svgf_cl. The camera moves through Mitsuba's own Cornell box.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import mitsuba as mi
import numpy as np
import numpy.typing as npt

from svgf_cl import Camera, Denoiser, Frame, Kalman, motion_from_cameras
from svgf_cl.compare.metrics import psnr
from svgf_cl.io.display import display, to_bytes, write_image

mi.set_variant("scalar_rgb")  # runs everywhere; llvm_ad_rgb and cuda_ad_rgb are faster

SIZE = 256
FRAMES = 16
REFERENCE_SAMPLES = 64
FOV = 39.3  # degrees

Array = npt.NDArray[np.float32]


def main(folder: Path) -> None:
    """Render and denoise some frames; write the last one, noisy and denoised, and print the errors of both."""
    scene = mi.load_dict(description())
    # Rays go through random points of their pixels; `taa` turns this into smooth edges.
    with Denoiser((SIZE, SIZE), settings=Kalman(taa=True)) as den:
        for frame in frames(scene):
            clean = den.denoise(frame)  # (H, W, 3) float32, linear radiance: display it here

    truth = display(layers(scene, REFERENCE_SAMPLES, seed=FRAMES)["beauty"])
    print(f"PSNR of the last frame: noisy {psnr(display(frame.color), truth):.1f} dB, ", end="")
    print(f"denoised {psnr(display(clean), truth):.1f} dB")
    folder.mkdir(parents=True, exist_ok=True)
    write_image(folder / "mitsuba_interactive.png", to_bytes(np.hstack([frame.color, clean])))


def description() -> dict[str, object]:
    """Mitsuba's Cornell box, with the additional outputs that the denoiser needs."""
    box: dict[str, object] = mi.cornell_box()
    box["integrator"] = {
        "type": "aov",
        "aovs": "albedo:albedo,normal:sh_normal,position:position",
        "beauty": {"type": "path", "max_depth": 8},
    }
    # A box filter as wide as a pixel. With any other filter a sample contributes to several pixels, so noise becomes
    # blotches, and positions are mixed across edges.
    film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "pixel_format": "rgb", "rfilter": {"type": "box"}}
    box["sensor"] = {"type": "perspective", "fov": FOV, "fov_axis": "smaller", "to_world": to_world(0), "film": film}
    return box


def frames(scene: mi.Scene) -> Iterator[Frame]:
    """Render the frames, each with one sample per pixel."""
    parameters, previous = mi.traverse(scene), None
    for number in range(FRAMES):
        parameters["sensor.to_world"] = mi.Transform4f(to_world(number))
        parameters.update()
        camera = Camera.from_fov(to_world(number).matrix.numpy(), FOV, (SIZE, SIZE), "smaller", axes="mitsuba")
        yield as_frame(layers(scene, samples=1, seed=number), camera, previous or camera)
        previous = camera


def as_frame(layer: dict[str, Array], camera: Camera, previous: Camera) -> Frame:
    """Make a frame from Mitsuba's layers. Mitsuba has no motion vectors, so motion is computed from the cameras."""
    hit = np.any(layer["normal"], axis=-1)
    depth = np.where(hit, camera.depth_at(layer["position"]), np.inf)
    return Frame.of(
        color=layer["beauty"],
        albedo=layer["albedo"],
        normal=layer["normal"],
        depth=depth,
        motion=motion_from_cameras(camera, previous, depth=depth, position=layer["position"]),
    )


def layers(scene: mi.Scene, samples: int, seed: int) -> dict[str, Array]:
    """Render a frame, and return its layers (H, W, 3) by name.

    Noise must differ between frames, so the seed must, too.
    """
    rendered = np.array(mi.render(scene, spp=samples, seed=seed))
    found: dict[str, list[Array]] = {}
    channels = [name for name in scene.integrator().aov_names() if name != "beauty.A"]  # the film has no alpha
    for channel, plane in zip(channels, np.moveaxis(rendered, -1, 0), strict=True):
        found.setdefault(channel.rpartition(".")[0], []).append(plane)
    return {name: np.stack(planes, axis=-1) for name, planes in found.items()}


def to_world(number: int) -> mi.ScalarTransform4f:
    """The camera of a frame: it moves to the right, and looks at the middle of the box."""
    return mi.ScalarTransform4f().look_at([-0.5 + 0.06 * number, 0.1, 3.9], [0, 0, 0], [0, 1, 0])


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out/examples"))
