"""LangGraph: nodes that update a shared state, in supersteps. Loops are edges that lead back."""

# mypy: disable-error-code="import-not-found"
from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any, TypedDict


def load() -> str:
    """The graph of states; nothing is traced."""
    os.environ["LANGSMITH_TRACING"] = "false"
    from importlib.metadata import version

    from langgraph.graph import END, START, StateGraph  # noqa: F401 - timed

    return version("langgraph")


class Passed(TypedDict, total=False):
    """What goes round, and how often."""

    image: Any
    turn: int


def relay(state: Passed) -> Passed:
    """A node."""
    return {"image": state["image"]}


def counted(state: Passed) -> Passed:
    """The node that ends a turn."""
    return {"image": state["image"], "turn": state["turn"] + 1}


def chain(nodes: int, image: Any) -> Callable[[], Any]:
    """Edges from node to node."""
    from langgraph.graph import END, START, StateGraph

    graph = StateGraph(Passed)
    names = [f"n{i}" for i in range(nodes)]
    for name in names:
        graph.add_node(name, relay)
    for before, after in zip([START, *names], [*names, END], strict=True):
        graph.add_edge(before, after)
    compiled = graph.compile()
    return lambda: compiled.invoke({"image": image}, {"recursion_limit": nodes + 10})["image"]


def loop(turns: int, image: Any) -> Callable[[], Any]:
    """Three edges on, and one back as long as the count says so."""
    from langgraph.graph import END, START, StateGraph

    graph = StateGraph(Passed)
    for name, node in (("n0", relay), ("n1", relay), ("n2", relay), ("n3", counted)):
        graph.add_node(name, node)
    for before, after in ((START, "n0"), ("n0", "n1"), ("n1", "n2"), ("n2", "n3")):
        graph.add_edge(before, after)
    graph.add_conditional_edges("n3", lambda state: END if state["turn"] >= turns else "n0", ["n0", END])
    compiled = graph.compile()
    bound = {"recursion_limit": 4 * turns + 10}
    return lambda: compiled.invoke({"image": image, "turn": 0}, bound)["image"]


if __name__ == "__main__":
    from stopwatch import told

    told(load, chain, loop)
