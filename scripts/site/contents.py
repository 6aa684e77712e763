"""The pages of the site, their order, and their places in the repository."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).parents[2]

# Pages outside docs/, by their path in the repository, and their path on the site. Pages in docs/ keep their paths.
OUTSIDE = {
    "README.md": "index.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    "SECURITY.md": "security.md",
    "examples/README.md": "examples.md",
    "examples/c_host/README.md": "c_host.md",
    "tracer/README.md": "tracer.md",
}

# The navigation: pages by the title of their section. The build fails if a page is missing here, or no longer exists.
SECTIONS = {
    "Start": ("installation.md",),
    "Use from Python": ("conventions.md", "api.rst", "settings.md", "examples.md"),
    "Use without Python": ("export.md", "c_host.md"),
    "Use on frames of your renderer": (
        "command_line.md",
        "renderers/README.md",
        "renderers/blender.md",
        "renderers/mitsuba.md",
        "renderers/pbrt.md",
        "renderers/arnold.md",
        "renderers/vray.md",
        "renderers/other.md",
        "checking_inputs.md",
        "files.md",
        "farm.md",
        "view.md",
    ),
    "How it works": ("algorithm.md", "lbf.md", "extending.md"),
    "Performance and accuracy": ("results.md", "comparing.md", "benchmarks.md", "accuracy.md", "gpu.md"),
    "Scenes and the tracer": ("tracer.md", "builtin_scenes.md", "scenes.md", "scene_description.md", "references.md"),
    "Project": ("changelog.md", "contributing.md", "security.md"),
}


def page_of(path: str) -> str | None:
    """The page of the site for a file of the repository, relative to the site's root; None if there is none."""
    if path in OUTSIDE:
        return OUTSIDE[path]
    folder, _, rest = path.partition("/")
    return rest if folder == "docs" and rest.endswith(".md") else None


def sources() -> dict[str, Path]:
    """The pages of the site that are files of the repository, by their paths on the site."""
    files = [ROOT / name for name in OUTSIDE] + sorted((ROOT / "docs").rglob("*.md"))
    pages = {page_of(file.relative_to(ROOT).as_posix()): file for file in files}
    return {page: file for page, file in pages.items() if page is not None}


def navigation() -> str:
    """The table of contents at the end of the start page."""
    blocks = []
    for title, pages in SECTIONS.items():
        names = "\n".join(page.rpartition(".")[0] for page in pages)
        blocks.append(f"```{{toctree}}\n:hidden:\n:caption: {title}\n\n{names}\n```\n")
    return "\n" + "\n".join(blocks)
