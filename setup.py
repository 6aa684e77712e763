"""What pyproject.toml cannot say cleanly: which folders are packages.

kernels/ is installed inside the package, as svgf_cl.kernels; the tracer lies in a folder of its own.
"""

from setuptools import find_packages, setup

setup(
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
        "svgf_cl.view": ["*.html", "*.css", "*.js"],
    },
)
