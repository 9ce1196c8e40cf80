"""The report: one HTML file that works offline by double click."""

from visint.results.report.page import report

__all__ = ["report"]
