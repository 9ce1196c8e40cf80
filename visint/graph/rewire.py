"""References moved to other nodes: what renaming a node, or passing one by, does to those that read it."""

from __future__ import annotations

from collections.abc import Mapping

from visint.graph.spec import NodeSpec

__all__ = ["moved", "rewired"]


def moved(ref: str, instead: Mapping[str, str]) -> str:
    """``ref`` with its node replaced by the one that ``instead`` leads to, step by step."""
    name, dot, port = ref.partition(".")
    while name in instead:
        name = instead[name]
    return f"{name}{dot}{port}"


def rewired(node: NodeSpec, instead: Mapping[str, str]) -> NodeSpec:
    """``node`` with all its references moved."""
    ins = {
        port: moved(refs, instead) if isinstance(refs, str) else tuple(moved(ref, instead) for ref in refs)
        for port, refs in node.in_.items()
    }
    feedback = {
        port: each.model_copy(
            update={
                "from_": moved(each.from_, instead),
                "start": moved(each.start, instead) if isinstance(each.start, str) else each.start,
            }
        )
        for port, each in node.feedback.items()
    }
    return node.model_copy(update={"in_": ins, "feedback": feedback})
