"""Writes noisy frames of the built-in room as the raw files that svgf_host reads; replace it by your renderer."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np

from svgf_cl.io.synthetic import room_frames


def main(plan: Path, folder: Path, count: int) -> None:
    """Write the inputs of a plan for `count` frames: FOLDER/0001.color.raw and so on."""
    arrays = json.loads((plan / "plan.json").read_text(encoding="utf-8"))["arrays"]
    inputs = [array for array in arrays if not array["is_output"]]
    height, width = inputs[0]["shape"][:2]
    signals = 2 if any(array["name"] == "direct" for array in inputs) else 1
    folder.mkdir(parents=True, exist_ok=True)
    for number, frame in enumerate(room_frames((height, width), count, signals=signals), start=1):
        for array in inputs:
            values = getattr(frame, array["name"])
            if values is None:
                sys.exit(f"make_frames: the room has no {array['name']}; export without it")
            if array["name"] == "motion":
                values = values[..., : array["shape"][2]]
            raw = np.ascontiguousarray(values, np.dtype(array["type"]).newbyteorder("<"))
            (folder / f"{number:04d}.{array['name']}.raw").write_bytes(raw.tobytes())


if __name__ == "__main__":
    if len(sys.argv) != 4 or not sys.argv[3].isdecimal():
        sys.exit("usage: make_frames.py PLAN FRAMES COUNT")
    main(Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]))
