from __future__ import annotations

from pathlib import Path

import pytest

from svgf_cl.cli import main
from svgf_cl_tracer import BUILTIN


def test_a_builtin_scene_comes_with_the_frames_that_show_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        main(["render", "switch", "--size", "4x3", "-o", str(tmp_path)])
    assert not left.value.code
    assert len(list(tmp_path.glob("frame.*.exr"))) == BUILTIN["switch"].frames == 48
    assert "48 frames" in capsys.readouterr().out
