"""Whether one port may feed another, and how its value is then read."""

from __future__ import annotations

from visint.graph.graph import Reader
from visint.module import PortSpec
from visint.names import listed

__all__ = ["reader_between", "spelled"]


def reader_between(source: PortSpec, target: PortSpec) -> Reader | None:
    """How ``target`` reads one value of ``source``, or None if it cannot. Lists and None are not looked at.

    Besides equal kinds there are two implicit steps: a plain port reads the value of evidence, and an
    ``Image`` port the luminance of a ``Color``.
    """
    if target.evidence:
        return "plain" if source.evidence and target.kind in ("", source.kind) else None
    if source.kind == target.kind:
        return "value" if source.evidence else "plain"
    if (source.kind, target.kind) == ("Color", "Image") and not source.evidence:
        return "luminance"
    return None


def spelled(owner: str, ports: dict[str, PortSpec]) -> str:
    """``outputs of 'depth' (stereo.depth): depth: Depth float32 (H, W)``-like list of ports."""
    return f"{owner}: " + listed(f"{name}: {spec}" for name, spec in ports.items())
