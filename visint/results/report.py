"""The report: one HTML file that works offline by double click."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from visint.results.result import Result

__all__ = ["report"]


def report(result: Result) -> str:
    """The whole report of ``result`` as the text of an HTML file."""
    return f"<!doctype html><title>{result.graph.name}</title>"
