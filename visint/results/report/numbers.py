"""Numbers and units as people read them."""

from __future__ import annotations

import math
from collections.abc import Sequence

__all__ = ["count", "number", "percent", "ranges", "seconds", "with_unit"]


def number(value: float) -> str:
    """Four digits of ``value``, without an exponent where that reads well; NaN is "unknown"."""
    if math.isnan(value):
        return "unknown"
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    plain = value == 0 or 1e-3 <= abs(value) < 1e6
    text = f"{value:.4g}" if not plain or abs(value) < 1e4 else f"{value:.0f}"
    return text.replace("-", "−") if plain else text


def with_unit(text: str, unit: str) -> str:
    """``text`` and its unit; a pure number has none."""
    return text if unit in ("", "1") else f"{text} {unit}"


def percent(share: float) -> str:
    """A share in [0, 1]; what is not quite all is not called 100 %."""
    text = f"{100 * share:.1f}".removesuffix(".0")
    if text in ("0", "100") and 0 < share < 1:
        return "less than 0.1 %" if share < 0.5 else "more than 99.9 %"
    return f"{text} %"


def seconds(value: float) -> str:
    """A duration: milliseconds below a second, minutes from two on."""
    if value < 1:
        return f"{1000 * value:.3g} ms"
    return f"{value:.2f} s" if value < 120 else f"{int(value // 60)} min {value % 60:.0f} s"


def count(many: int, one: str, more: str = "") -> str:
    """``many`` things: "1 turn", "3 turns"."""
    return f"{many} {one if many == 1 else more or one + 's'}"


def ranges(values: Sequence[int]) -> str:
    """Whole numbers in short: "3" or "0 to 6"."""
    low, high = min(values), max(values)
    return str(low) if low == high else f"{low} to {high}"
