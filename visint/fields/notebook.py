"""Evidence and maps in a notebook: a layer above makes the pictures, and is looked up when asked for."""

from __future__ import annotations

import importlib
from typing import Any

__all__ = ["html_of"]

_PAINTER = "visint.results.report.notebook"


def html_of(value: Any) -> str:
    """``value`` as HTML.

    The fields know nothing of pictures: the painter is named here and not imported, as a plugin is.
    """
    return str(importlib.import_module(_PAINTER).html_of(value))
