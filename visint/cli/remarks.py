"""What a run on files has to say beside its modules: about the files, and what did not follow."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from visint.results import Result
    from visint.results.records import Warned

__all__ = ["remarks"]

_UNSURE, _HARDLY = 0.3, 0.1
"""A confidence that nobody should build upon, and the share of pixels above it that calls for a word."""


def remarks(result: Result, said: Iterable[tuple[str, str]], changed: Iterable[str]) -> list[Warned]:
    """Warnings, to go before those of the modules.

    Parameters
    ----------
    said
        (input, sentence): what reading the files changed.
    changed
        The inputs that are no longer what they were in the run that is done again.
    """
    from visint.results.records import Warned

    told = [*_of_files(said, changed), *_of_camera(result), *_of_confidence(result)]
    return [Warned(place, 0, 0, code, text) for place, code, text in told]


def _of_files(said: Iterable[tuple[str, str]], changed: Iterable[str]) -> Iterator[tuple[str, str, str]]:
    for name, sentence in said:
        yield f"inputs.{name}", "read", sentence
    for name in changed:
        yield f"inputs.{name}", "changed", "the file is not what it was in the former run; results will differ"


def _of_camera(result: Result) -> Iterator[tuple[str, str, str]]:
    kinds = set(result.kinds.values())
    wanted = next((name for name, spec in result.graph.inputs.items() if spec.kind == "Camera"), None)
    if wanted and result.camera is None and "Disparity" in kinds and "Depth" not in kinds:
        text = "without a calibration neither depth nor normals follow; give --calib or --disparity-range"
        yield f"inputs.{wanted}", "no_camera", text


def _of_confidence(result: Result) -> Iterator[tuple[str, str, str]]:
    """An even or unmatched pair gives full maps all the same; who looks at them alone would not know."""
    unsure = [name for name, sure in result.confidence.items() if (sure > _UNSURE).mean() < _HARDLY]
    if unsure:
        text = "hardly anything is known: confidence is low nearly everywhere (no texture, or no match?)"
        yield ", ".join(unsure), "unsure", text
