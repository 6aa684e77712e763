"""The configuration of Sphinx, which `python -m scripts.site` runs."""

from datetime import date

from svgf_cl import __version__

project = "svgf_cl"
author = "The svgf_cl authors"
copyright = f"{date.today().year}, {author}"
version = release = __version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
root_doc = "index"
html_theme = "furo"
html_title = f"svgf_cl {__version__}"
html_copy_source = False

# Pages are written for the forge, so anchors of headings and code without a language follow its rules.
myst_heading_anchors = 4
highlight_language = "text"
smartquotes = False  # they would turn the two dashes of an option into one

# Docstrings are numpydoc, where a name in backquotes is code.
default_role = "code"
napoleon_google_docstring = False
autodoc_typehints_format = "short"
autodoc_member_order = "bysource"
maximum_signature_line_length = 100
