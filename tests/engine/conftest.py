"""Graphs of toys put on stage: text in, result and the list of calls out."""

from __future__ import annotations

import numpy as np
import pytest

import visint.testing.plugin
from visint.engine import Options, run
from visint.events import NodeStarted
from visint.fields import Camera
from visint.graph import Graph, parse_graph
from visint.graph.bind import bind
from visint.graph.spec import GraphSpec
from visint.hookspecs import hookimpl
from visint.registry import Catalog


class OwnPlugin:
    """A plugin made of modules that a test wrote."""

    visint_contract = 1

    def __init__(self, modules):
        self._modules = modules

    @hookimpl
    def visint_modules(self):
        return self._modules


class Stage:
    """Runs graphs and keeps what their observers saw.

    Attributes
    ----------
    calls
        (node, level, turn) of every call of the last run, in order.
    events
        Every event of the last run.
    """

    def __init__(self, folder):
        self._folder = folder
        self._graphs = {}
        self._plugins = {"toy": visint.testing.plugin}
        self._catalog = Catalog(self._plugins, self._graphs)
        self.calls = []
        self.events = []

    def modules(self, **plugins):
        """Adds modules of the test's own: ``stage.modules(own=[Module, ...])``."""
        self._plugins |= {name: OwnPlugin(modules) for name, modules in plugins.items()}

    def sub_graph(self, text):
        """Installs the graph in ``text`` under the name it gives itself."""
        name = text.split("name:")[1].split()[0].strip("},")
        path = self._folder / f"{name}.yaml"
        path.write_text(text)
        self._graphs[name] = path

    def graph(self, text):
        """The bound graph in ``text``; its first line may be left out."""
        if isinstance(text, Graph):
            return text
        head = "" if "visint: 1" in text else "visint: 1\nname: staged\n"
        return parse_graph(head + text, Catalog(self._plugins, self._graphs))

    def bound(self, data):
        """The bound graph of a spec as plain data; nothing is written and read."""
        return bind(GraphSpec.model_validate(data), self._catalog)

    def run(self, text, inputs=None, *, watch=True, **options):
        """Runs the graph in ``text`` (or a bound one); options as in :class:`visint.Options`."""
        self.events = []
        self.calls = []
        observers = options.pop("observers", ())
        if watch:
            observers = (*observers, self._observe)
        return run(self.graph(text), inputs or {}, options=Options(observers=observers, **options))

    def _observe(self, event):
        self.events.append(event)
        if isinstance(event, NodeStarted):
            self.calls.append((event.node, event.level, event.turn))

    def of(self, kind):
        """The events of one class."""
        return [event for event in self.events if isinstance(event, kind)]

    def calls_of(self, node):
        """(level, turn) of every call of ``node``."""
        return [(level, turn) for name, level, turn in self.calls if name == node]


@pytest.fixture
def stage(tmp_path):
    """A stage for graphs of toys."""
    return Stage(tmp_path)


@pytest.fixture
def image():
    """float32 noise of an odd size, 21 × 13."""
    return np.random.default_rng(0).random((21, 13), dtype=np.float32)


@pytest.fixture
def camera_for():
    """A camera for an image's size."""

    def make(image, **given):
        rows, columns = image.shape[:2]
        facts = {"focal_length": 40.0, "cx": columns / 2, "cy": rows / 2, "baseline": 10.0}
        return Camera(width=columns, height=rows, **{**facts, "disparity_range": (2.0, 6.0), **given})

    return make
