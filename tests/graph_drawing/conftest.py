"""The graphs and readers of coordinates that the tests of this folder share, as the module ``shapes``."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

if "shapes" not in sys.modules:
    found = importlib.util.spec_from_file_location("shapes", Path(__file__).with_name("shapes.py"))
    assert found is not None
    assert found.loader is not None
    sys.modules["shapes"] = importlib.util.module_from_spec(found)
    found.loader.exec_module(sys.modules["shapes"])
