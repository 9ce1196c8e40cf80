"""What ships with a package is found without importing it."""

from __future__ import annotations

import sys

import pytest

import visint.io


def test_texts_and_bytes_inside_a_package():
    """By package and path."""
    text = visint.io.resource_text("visint.io", "limits.py")
    assert "LIMITS" in text
    assert visint.io.resource_bytes("visint", "io", "limits.py").decode() == text
    with pytest.raises(FileNotFoundError):
        visint.io.resource_text("visint.io", "absent.css")


def test_folders_of_data(tmp_path, monkeypatch):
    """Of an installed folder, of one inside a package that is not imported, or of none."""
    inner = tmp_path / "stranger_package" / "graphs"
    inner.mkdir(parents=True)
    (inner.parent / "__init__.py").write_text("raise RuntimeError('imported')")
    monkeypatch.syspath_prepend(tmp_path)
    assert visint.io.shipped_folder("stranger_package.graphs") == inner
    assert visint.io.shipped_folder("stranger_package") == inner.parent
    assert visint.io.shipped_folder("stranger_package.absent") is None
    assert visint.io.shipped_folder("no_such_package_here") is None
    assert "stranger_package" not in sys.modules


def test_a_checkout_stands_in_for_what_is_not_installed():
    """The folder beside the package's own, if it is there."""
    folder = visint.io.shipped_folder("no_such_package_here", "visint")
    assert folder is not None
    assert (folder / "io" / "resources.py").is_file()
    assert visint.io.shipped_folder("no_such_package_here", "absent") is None
