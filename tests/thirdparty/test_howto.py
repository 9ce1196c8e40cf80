"""A stranger's plugins, written from the how-to page alone: every block of it is extracted and run."""

from __future__ import annotations

import doctest
import importlib
import importlib.util
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

import visint
from visint.engine.options import Options
from visint.events import NodeFinished
from visint.names import ModuleId
from visint.registry import Catalog
from visint.testing import ModuleContract, installed, sentences

ROOT = Path(visint.__file__).parents[1]
DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "howto/write-a-module.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
FILES = {
    match[1]: text
    for _, text in BLOCKS
    if (match := re.match(r"# ([\w/.-]+\.(?:py|yaml|toml))\n", text)) is not None
}
SESSION = "".join(text for language, text in BLOCKS if language == "pycon")


@pytest.fixture(scope="module")
def place():
    """Both plugins of the page, installed as two distributions, and its files beside them."""
    points = tomllib.loads(FILES["pyproject.toml"])["project"]["entry-points"]["visint.plugins"]
    flow = {name: text for name, text in FILES.items() if name.startswith("visint_flow/")}
    rest = {name: text for name, text in FILES.items() if name not in flow}
    with (
        installed("visint-focus", plugins=points, files=rest) as folder,
        installed("visint-flow", plugins={"flow": "visint_flow"}, files=flow),
    ):
        yield folder


def test_the_page_has_its_files():
    """The folder drawn at the top is what the page then writes."""
    drawn = re.findall(r"^  ([\w/.]+\.\w+)", BLOCKS[0][1], re.MULTILINE)
    assert set(drawn) == {
        name for name in FILES if not name.startswith("visint_flow/") and name.count(".yaml") == 0
    }
    unnamed = [text for language, text in BLOCKS if language in ("python", "toml", "yaml") if text[0] != "#"]
    assert not unnamed


def test_every_session_on_the_page_runs(place, monkeypatch):
    """What is shown at the prompt is what comes out, the refused prior and its message included."""
    monkeypatch.chdir(place)
    session = doctest.DocTestParser().get_doctest(SESSION, {}, "write-a-module", None, 0)
    said = []
    result = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(session, out=said.append)
    assert result.attempted > 8
    assert result.failed == 0, "".join(said)


def test_the_registry_finds_both(place):
    """By name, from two distributions, like any shipped plugin; nothing is imported before it is asked for."""
    catalog = Catalog()
    assert {"focus", "flow"} <= set(catalog.plugin_names)
    assert catalog.module(ModuleId("focus", "laplacian")).__module__ == "visint_focus.laplacian"
    assert catalog.plugin("focus").origin == "visint-focus 1.0"
    assert catalog.kind("flow.Flow").finer == 2.0


def test_the_laplacian_passes_its_own_tests(place):
    """Contract and known answer, run as the page's test file has them."""
    test_file = _module(place / "tests/test_laplacian.py")
    assert issubclass(test_file.TestLaplacian, ModuleContract)
    assert _run_all(test_file.TestLaplacian) > 11


def test_speed_passes_the_contract(place):
    """A module on a kind that visint has never heard of."""
    speed = importlib.import_module("visint_flow.speed").Speed
    assert _run_all(type("TestSpeed", (ModuleContract,), {"module": speed})) > 10


def test_flow_goes_through_a_pyramid(place):
    """The stranger's kind is halved with the images: at level 1 the same motion is half as many pixels."""
    graph = """
visint: 1
name: coarse
inputs: {image: Image, flow: flow.Flow}
loops: {levels: {over: pyramid, levels: 3}}
nodes:
  speed: {uses: flow.speed, loop: levels, in: {flow: inputs.flow}}
outputs: {speed: speed.speed, moving: speed.moving}
"""
    (place / "coarse.yaml").write_text(graph, encoding="utf-8")
    seen = []

    def observe(event):
        if isinstance(event, NodeFinished):
            speed = event.outputs["speed"]
            seen.append((event.level, speed.shape, float(speed.max()), event.summary()["speed"]))

    inputs = {"image": np.zeros((9, 12), np.float32), "flow": np.full((9, 12, 2), [3, 4], np.float32)}
    result = visint.run(visint.load(place / "coarse.yaml"), inputs, options=Options(observers=(observe,)))
    assert seen == [
        (2, (3, 3, 1), 1.25, "float32 (3, 3, 1) 1.25..1.25"),
        (1, (5, 6, 1), 2.5, "float32 (5, 6, 1) 2.5..2.5"),
        (0, (9, 12, 1), 5.0, "float32 (9, 12, 1) 5..5"),
    ]
    assert result["moving"].all()


WRONG = """
from visint_focus.laplacian import FocusInputs, FocusOutputs, Laplacian
from visint.module import Context

class Wrong(Laplacian):
    def run(self, inputs: FocusInputs, ctx: Context) -> FocusOutputs:
        window: str = self.params.window
        inputs.prior.mean()
        inputs.iamges
        return FocusOutputs(depth=inputs.images[0], sharpness=inputs.images[0])
"""


def test_mypy_strict_accepts_the_page(place, request):
    """The stranger's type checker sees arrays, not spellings, and has nothing to say; of mistakes it has."""
    flow = Path(importlib.import_module("visint_flow").__file__).parent
    files = [place / name for name in FILES if name.endswith(".py") and not name.startswith("visint_flow/")]
    (place / "wrong.py").write_text(WRONG, encoding="utf-8")
    paths = [place, flow.parent, *([] if ROOT.name == "site-packages" else [ROOT])]
    environment = {**os.environ, "MYPYPATH": os.pathsep.join(map(str, paths))}
    cache = request.config.cache.mkdir("mypy")
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file=", f"--cache-dir={cache}"]
    command += ["--follow-imports=silent", "--no-pretty", *map(str, files), str(flow), "wrong.py"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False, cwd=place)
    *complaints, _ = done.stdout.splitlines()
    assert all(line.startswith("wrong.py:") for line in complaints), done.stdout + done.stderr
    kinds = [re.search(r"\[([a-z-]+)\]$", line)[1] for line in complaints if ": error:" in line]
    assert kinds == ["assignment", "union-attr", "attr-defined", "arg-type"], done.stdout


def test_the_reference_page_has_the_sentences():
    """Word for word those in the docstring of visint.module, which the kit tests."""
    page = (DOCS / "reference/contract.md").read_text(encoding="utf-8")
    listed = dict(re.findall(r"^(\d+)\. (.+)$", page, re.MULTILINE))
    assert listed == {str(n): text.replace("``", "`") for n, text in sentences().items()}


def _module(path):
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _run_all(tests):
    """How many tests of a class there are; raises as the first that fails."""
    names = [name for name in dir(tests) if name.startswith("test_")]
    for name in names:
        getattr(tests(), name)()
    return len(names)
