"""A plot of quality against time, memory as size, drawn as SVG."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

from visint_lab.trials.contest import Standing

__all__ = ["quality_and_time"]

WIDTH, HEIGHT, MARGIN = 720, 420, 60


def quality_and_time(standings: Sequence[Standing], score: str, label: str) -> str:
    """SVG: CPU seconds (logarithmic) across, the median of ``score`` up, a disc's area is the peak memory."""
    shown = [one for one in standings if one.medians.get("cpu", 0) > 0 and score in one.medians]
    if not shown:
        return ""
    times = [math.log10(one.medians["cpu"]) for one in shown]
    low, high = math.floor(min(times)), math.ceil(max(times) + 1e-9)
    top = 1.1 * max(one.medians[score] for one in shown)

    def place(one: Standing) -> tuple[float, float]:
        across = (math.log10(one.medians["cpu"]) - low) / max(high - low, 1)
        return MARGIN + across * (WIDTH - 2 * MARGIN), HEIGHT - MARGIN - one.medians[score] / top * (
            HEIGHT - 2 * MARGIN
        )

    parts = [_frame(label), *_decades(low, high)]
    for turn, one in enumerate(sorted(shown, key=place)):
        parts.append(_disc(one, place(one), one.medians[score], 4 if turn % 2 else -10))
    inside = "".join(parts)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" '
        f'font-family="system-ui, sans-serif" font-size="12" fill="currentColor">{inside}</svg>'
    )


def _frame(label: str) -> str:
    bottom = HEIGHT - MARGIN
    return (
        f'<path d="M{MARGIN} {MARGIN / 2}V{bottom}H{WIDTH - MARGIN / 2}" fill="none" stroke="currentColor"/>'
        f'<text x="{MARGIN - 40}" y="{MARGIN / 2 - 8}">{escape(label)} (0 at the bottom)</text>'
        f'<text x="{WIDTH - MARGIN}" y="{HEIGHT - 12}" text-anchor="end">CPU seconds; area: peak memory</text>'
    )


def _decades(low: int, high: int) -> list[str]:
    step = (WIDTH - 2 * MARGIN) / max(high - low, 1)
    return [
        f'<text x="{MARGIN + (k - low) * step:.0f}" y="{HEIGHT - MARGIN + 18}" text-anchor="middle">'
        f"{10.0**k:g}</text>"
        for k in range(low, high + 1)
    ]


def _disc(one: Standing, at: tuple[float, float], value: float, lift: int) -> str:
    """A disc with its name beside it, neighbours' names at different heights."""
    x, y = at
    radius = 3 + math.sqrt(max(one.medians.get("peak_mb", 0.0), 0.0)) / 3
    name = escape(one.entrant)
    return (
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}" fill="#4a7bd0" fill-opacity=".55"/>'
        f'<text x="{x + radius + 4:.1f}" y="{y + lift:.1f}">{name} {value:.3g}</text>'
    )
