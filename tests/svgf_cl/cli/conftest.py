from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from svgf_cl.io.frames import frame_path, write_frame
from svgf_cl.io.pictures import write_picture
from svgf_cl.io.synthetic import room_frames


@pytest.fixture(scope="session")
def rendered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three frames of the room and what they converge to; not to be changed."""
    folder = tmp_path_factory.mktemp("rendered")
    for number, frame in enumerate(room_frames((18, 32), 3, signals=2)):
        write_frame(frame_path(folder, number), frame)
        write_picture(frame_path(folder, number, "reference"), np.asarray(frame.albedo))
    return folder
