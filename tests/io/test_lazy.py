"""Importing visint.io loads nothing heavy; its public names are one table."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import visint.io

HEAVY = {"cv2", "scipy", "numba", "networkx"}
SOURCES = sorted(set(Path(visint.io.__file__).parent.glob("[!_]*.py")) | {Path(visint.io.__file__)})


def loaded_by(program):
    code = f"{program}\nimport sys; print(*(set(sys.modules) & {HEAVY | {'numpy', 'pydantic'}!r}))"
    return set(
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    )


def test_import_is_light():
    """Neither numpy nor OpenCV; text is read without them."""
    assert loaded_by("import visint.io; visint.io.read_text; visint.io.OutputFolder") == set()


def test_every_name_without_opencv():
    """OpenCV is loaded when an image is decoded, not when a reader is named."""
    assert not loaded_by("import visint.io; [getattr(visint.io, name) for name in visint.io.__all__]") & HEAVY


def test_public_names():
    """Sorted, there, and no others."""
    assert visint.io.__all__ == sorted(visint.io.__all__)
    assert dir(visint.io) == visint.io.__all__
    for name in visint.io.__all__:
        assert getattr(visint.io, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        visint.io.nothing  # noqa: B018


@pytest.mark.parametrize("name", visint.io.__all__)
def test_every_public_name_is_documented(name):
    """A docstring on each function and class."""
    public = getattr(visint.io, name)
    assert name == "LIMITS" or (public.__doc__ or "").strip()


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.stem)
def test_type_checkers_see_what_is_there_at_run_time(path):
    """Each file's ``__all__`` names what it defines; the package's two tables agree."""
    module = ast.parse(path.read_text())
    if path.stem != "__init__":
        names = next(n for n in module.body if isinstance(n, ast.Assign) and n.targets[0].id == "__all__")
        defined = {n.name for n in module.body if isinstance(n, ast.FunctionDef | ast.ClassDef)}
        targets = [t for n in module.body if isinstance(n, ast.Assign) for t in n.targets]
        defined |= {target.id for target in targets if isinstance(target, ast.Name)}
        assert set(ast.literal_eval(names.value)) <= defined
        return
    checked = {alias.asname for n in ast.walk(module) if isinstance(n, ast.ImportFrom) for alias in n.names}
    assert checked - {None} == set(visint.io.__all__)
