"""Sphinx configuration. Reference pages are generated here from the code, so they cannot drift."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from reference_pages import write_all

import visint

write_all(Path(__file__).parent / "reference" / "generated")

project = "visint"
author = "the visint authors"
release = visint.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 3
html_theme = "furo"
html_title = "visint"
exclude_patterns = ["_build"]
suppress_warnings = ["myst.xref_missing"]
