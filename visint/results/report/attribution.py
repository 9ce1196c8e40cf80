"""The section on attribution: one map a cue of how much of a field it decided."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from visint.arrays import Array
from visint.results.report.markup import Markup, element, joined
from visint.results.report.numbers import percent
from visint.results.report.setting import Setting

__all__ = ["attribution"]

_ABOUT = (
    "White is where a cue decided alone, black where it had no say: its weight as it is left after all that "
    "others did later. What no cue decided is the start's."
)
_LEAST = 1e-3


def attribution(setting: Setting) -> Markup | None:
    """For each field a row of maps, one a cue and one of what the start still decides."""
    weights = setting.result.attribution
    if not weights:
        return None
    small = setting.small()
    each = [joined(_field(small, name, some)) for name, some in weights.items()]
    return joined([element("p", _ABOUT), *each])


def _field(setting: Setting, name: str, weights: Mapping[str, Array]) -> Iterator[Markup]:
    yield element("h3", name, " ", element("small", _shares(weights)))
    rest = _rest(weights)
    shown = {**weights, **({"start": rest} if float(rest.mean()) > _LEAST else {})}
    if len(shown) == 1:
        yield element("p", f"{next(iter(shown))} decided all of it.")
        return
    figures = [setting.over_view(cue, "Confidence", one) for cue, one in shown.items()]
    yield element("div", *figures, class_="row" if len(figures) > 2 else "grid")


def _rest(weights: Mapping[str, Array]) -> Array:
    """What the start decides, float32 (H, W) in [0, 1]."""
    total = np.add.reduce([*weights.values()])
    return np.asarray(np.clip(1 - total, 0, 1), dtype=np.float32)


def _shares(weights: Mapping[str, Array]) -> str:
    means = {cue: float(one.mean(dtype=np.float64)) for cue, one in weights.items()}
    told = [f"{cue} {percent(mean)}" for cue, mean in means.items()]
    return "on average " + ", ".join(told)
