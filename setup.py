"""What pyproject.toml cannot say cleanly: which folders are packages, and how README.md looks on a package index.

kernels/ is installed inside the package, as svgf_cl.kernels; the tracer lies in a folder of its own. A package index
has none of the files that README.md links to, so there the links lead to the repository, as it is at this release.
"""

import re
from pathlib import Path

from setuptools import find_packages, setup

ROOT = Path(__file__).parent


def declared(pattern: str, file: str) -> str:
    """What a file declares, by the only place where `pattern` matches."""
    (found,) = re.findall(pattern, (ROOT / file).read_text(encoding="utf-8"), re.MULTILINE)
    return str(found)


def readme() -> str:
    """README.md with absolute links."""
    repository = declared(r'^Repository = "(.+)"$', "pyproject.toml")
    release = "v" + declared(r'^__version__ = "(.+)"$', "svgf_cl/__init__.py")
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    text = re.sub(r"(!\[[^\]]*\]\()(?!https?:)", rf"\1{repository}/raw/{release}/", text)
    return re.sub(r"(\]\()(?!https?:|#)", rf"\1{repository}/blob/{release}/", text)


setup(
    long_description=readme(),
    long_description_content_type="text/markdown",
    packages=[
        *find_packages(include=["svgf_cl", "svgf_cl.*"]),
        "svgf_cl.kernels",
        *find_packages(where="tracer"),
    ],
    package_dir={"svgf_cl.kernels": "kernels", "svgf_cl_tracer": "tracer/svgf_cl_tracer"},
    package_data={
        "svgf_cl.kernels": ["*.cl", "*.clh"],
        "svgf_cl.bench": ["*.cl", "*.html"],
        "svgf_cl.export": ["*.json"],
        "svgf_cl.compare": ["*.html", "*.css", "*.js"],
        "svgf_cl.filters": ["*.json"],
        "svgf_cl.view": ["*.html", "*.css", "*.js"],
    },
)
