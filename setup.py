"""The one thing pyproject.toml cannot say cleanly: kernels/ is installed inside the package, as svgf_cl.kernels."""

from setuptools import find_packages, setup

setup(
    packages=[*find_packages(include=["svgf_cl", "svgf_cl.*", "tracer", "tracer.*"]), "svgf_cl.kernels"],
    package_dir={"svgf_cl.kernels": "kernels"},
    package_data={"svgf_cl.kernels": ["*.cl", "*.clh"], "svgf_cl.bench": ["*.cl", "*.html"]},
)
