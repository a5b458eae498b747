"""The site: `make docs` builds it from this folder into build/site. What is special about it is in `extensions/`."""

from __future__ import annotations

import sys
from pathlib import Path

import ropewalk

sys.path.insert(0, str(Path(__file__).parent / "extensions"))
sys.path.insert(0, str(Path(__file__).parent))

project = "ropewalk"
author = "ropewalk developers"
copyright = author
version = release = ropewalk.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_design",
    "sphinx_copybutton",
    "mathml",
    "links",
    "gallery",
    "generated",
]
exclude_patterns = ["extensions", "images/*.md"]
nitpicky = True
# Types in signatures are words for readers, not links: the declarations are pydantic's, the rest numpy's and xarray's.
nitpick_ignore_regex = [("py:.*", ".*")]

myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 4
myst_dmath_allow_digits = False
myst_dmath_allow_space = False

autodoc_typehints = "none"
autodoc_member_order = "bysource"
add_module_names = False
default_role = "code"
highlight_language = "text"
smartquotes = False

html_theme = "furo"
html_math_renderer = "mathml"
html_title = f"ropewalk {version}"
html_static_path = ["extensions/static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
html_theme_options = {
    "light_css_variables": {"font-stack": "system-ui, -apple-system, 'Segoe UI', 'Liberation Sans', sans-serif"},
}
copybutton_prompt_text = r"\$ |>>> "
copybutton_prompt_is_regexp = True
