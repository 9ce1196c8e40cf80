"""Hypothesis strategies: arrays of any field kind, evidence and cameras. Needs hypothesis installed."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import strategies as st

from visint.arrays import Array, ArraySpec
from visint.fields import KINDS, Camera, Evidence
from visint.testing.samples import CAN_BE_UNKNOWN, Content, Size, evidence_class, sample_array

__all__ = ["arrays", "cameras", "contents", "evidence", "sizes"]


def sizes(most: int = 40) -> st.SearchStrategy[Size]:
    """(rows, columns) from 1 to ``most``: single rows and columns, odd sides and squares included."""
    return st.tuples(st.integers(1, most), st.integers(1, most))


def contents(kind: str = "Depth") -> st.SearchStrategy[Content]:
    """What an array of the kind may hold; holes only where NaN stands for unknown."""
    plain: list[Content] = ["noise", "grey"]
    holes: list[Content] = ["holes", "unknown"] if kind in CAN_BE_UNKNOWN else []
    return st.sampled_from(plain + holes)


@st.composite
def arrays(
    draw: st.DrawFn, kind: str | ArraySpec, size: Size | None = None, content: Content | None = None
) -> Array:
    """An array of a built-in kind (by name) or of any spec.

    Parameters
    ----------
    kind
        ``"Depth"``, or an :class:`ArraySpec`.
    size, content
        As in :func:`visint.testing.sample_inputs`; drawn where not given.
    """
    spec = kind if isinstance(kind, ArraySpec) else _spec(kind)
    shape = size or draw(sizes())
    what = draw(contents(spec.kind)) if content is None else content
    return sample_array(spec, shape, what, np.random.default_rng(draw(st.integers(0, 2**32 - 1))))


def _spec(kind: str) -> ArraySpec:
    spec = KINDS[kind].array
    if spec is None:
        raise ValueError(f"{kind} is no kind of array")
    return spec


@st.composite
def evidence(draw: st.DrawFn, kind: str = "Depth", size: Size | None = None) -> Evidence:
    """Evidence on a field of the kind, which abstains in some pixels, or in all."""
    value = draw(arrays(kind, size))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    abstains = rng.random(value.shape[:2]) < draw(st.sampled_from([0.0, 0.3, 1.0]))
    trust = np.where(abstains, 0, rng.uniform(0.01, 1.0, abstains.shape))
    return evidence_class(kind).of(value, rng.uniform(0.01, 2.0, abstains.shape), trust)


@st.composite
def cameras(draw: st.DrawFn, /, size: Size | None = None, **fixed: Any) -> Camera:
    """A camera of any sensible field of view (30° to 127°), principal point, baseline and convergence."""
    rows, columns = size or draw(sizes())
    drawn = {
        "focal_length": max(rows, columns) * draw(st.floats(0.25, 1.9)),
        "cx": (columns - 1) / 2 + columns * draw(st.floats(-0.25, 0.25)),
        "cy": (rows - 1) / 2 + rows * draw(st.floats(-0.25, 0.25)),
        "baseline": draw(st.floats(0.01, 1000.0)),
        "doffs": draw(st.sampled_from([0.0, 7.5, 200.0])),
        "disparity_range": draw(st.sampled_from([None, (0.0, 16.0), (-8.0, 24.0)])),
    }
    return Camera(width=columns, height=rows, **{**drawn, **fixed})
