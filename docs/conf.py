"""Sphinx configuration. Reference pages are generated here from the code, so they cannot drift."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from gallery_pages import write_gallery
from link_check import broken_links
from reference_pages import write_all
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError

import visint

GENERATED = Path(__file__).parent / "reference" / "generated"
write_all(GENERATED)
write_gallery(GENERATED)

project = "visint"
author = "the visint authors"
release = visint.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 3
html_theme = "furo"
html_title = "visint"
exclude_patterns = ["_build"]


def _check_links(app: Sphinx, error: Exception | None) -> None:
    """The build fails if a link inside the site leads nowhere."""
    if error is None and app.builder.name == "html" and (broken := broken_links(Path(app.outdir))):
        raise ExtensionError("links that lead nowhere:\n" + "\n".join(broken))


def setup(app: Sphinx) -> None:
    """Called by Sphinx."""
    app.connect("build-finished", _check_links)
