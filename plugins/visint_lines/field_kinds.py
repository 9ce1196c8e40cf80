"""The field kinds of this plugin: line diagrams and labels."""

from __future__ import annotations

from typing import Any

from visint.fields import FieldKind
from visint.fields.resampling import smaller

__all__ = ["KINDS"]


def _down(value: Any) -> Any:
    return value.scaled(0.5, smaller(_size(value)))


def _up(value: Any, size: tuple[int, int]) -> Any:
    return value.scaled(2.0, size)


def _size(value: Any) -> tuple[int, int]:
    size: tuple[int, int] = value.size if hasattr(value, "size") else value.diagram.size
    return size


KINDS = (
    FieldKind("lines.Diagram", None, _down, _up),
    FieldKind("lines.Labels", None, _down, _up),
    FieldKind("lines.Superquadrics"),
)
