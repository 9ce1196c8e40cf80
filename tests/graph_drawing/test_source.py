"""From a name or a path to a spec, and from a spec to the same drawing everywhere, without any plugin."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
import shapes

from visint.errors import GraphError
from visint.graph import drawing, load
from visint.registry import Catalog

ROOT = Path(__file__).parents[2]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "recurrent.yaml"
    path.write_text(shapes.RECURRENT, encoding="utf-8")
    return path


def test_a_path_is_read(file: Path) -> None:
    """A path gives the spec that stands in the file, modules looked up by nobody."""
    assert drawing.spec_of(str(file)) == shapes.spec(shapes.RECURRENT)


def test_a_name_is_looked_up_among_the_installed_graphs(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A name means an installed graph."""
    monkeypatch.setattr("visint.registry.installed", lambda: Catalog(plugins={}, graphs={"mine": file}))
    assert drawing.spec_of("mine").name == "recurrent"


def test_an_unknown_name_is_told_as_when_loading(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same VI108, word for word, as `visint.load` gives."""
    catalog = Catalog(plugins={}, graphs={"mine": file})
    monkeypatch.setattr("visint.registry.installed", lambda: catalog)
    with pytest.raises(GraphError, match="VI108") as drawn:
        drawing.spec_of("mime")
    with pytest.raises(GraphError) as loaded:
        load("mime", catalog)
    assert str(drawn.value) == str(loaded.value)


def test_a_file_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(GraphError, match="VI101"):
        drawing.spec_of(str(tmp_path / "none.yaml"))


def run(code: str, *args: str, seed: str = "0") -> str:
    env = {
        **os.environ,
        "PYTHONHASHSEED": seed,
        "PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "plugins")]),
    }
    done = subprocess.run(
        [sys.executable, "-c", code, *args], capture_output=True, text=True, env=env, check=True
    )
    return done.stdout


def test_drawing_imports_no_plugin(file: Path) -> None:
    """Neither a plugin nor a heavy library is loaded to draw a graph that names plugins."""
    code = (
        "import sys\nfrom visint.graph import drawing\nspec = drawing.spec_of(sys.argv[1])\n"
        "drawing.to_dot(spec), drawing.to_html(spec)\n"
        "heavy = {'cv2', 'scipy', 'numba'}\n"
        "print(sorted(m for m in sys.modules if m.split('.')[0] in heavy or m.startswith('visint_')))\n"
    )
    assert run(code, str(file)).strip() == "[]"


def test_drawings_are_the_same_whatever_the_hashing(file: Path) -> None:
    """Two processes with other hash seeds write the same bytes."""
    code = (
        "import sys\nfrom visint.graph import drawing\nspec = drawing.spec_of(sys.argv[1])\n"
        "sys.stdout.reconfigure(encoding='utf-8')\nprint(drawing.to_html(spec), drawing.to_dot(spec))\n"
    )
    assert run(code, str(file), seed="1") == run(code, str(file), seed="2")


def test_every_shipped_graph_is_drawn() -> None:
    """What is shipped can be shown."""
    for path in sorted((ROOT / "graphs").glob("*.yaml")):
        spec = drawing.spec_of(str(path))
        assert all(name in drawing.to_svg(spec) for name in spec.nodes)
