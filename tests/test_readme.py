"""What README shows works as it stands there."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

README = Path(__file__).parents[1] / "README.md"


def test_the_python_example_runs() -> None:
    (example,) = re.findall(r"^```python\n(.*?)^```", README.read_text(), re.DOTALL | re.MULTILINE)
    ran = subprocess.run(
        [sys.executable, "-c", example], cwd=README.parent, capture_output=True, text=True, timeout=300
    )
    assert ran.returncode == 0, ran.stderr
    before, after = map(float, re.match(r"([\d.]+) -> ([\d.]+) \{", ran.stdout).groups())
    assert after < before
