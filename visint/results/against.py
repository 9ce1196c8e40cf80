"""Another run to compare a result with, read back from its folder."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

from visint import io
from visint.arrays import Array
from visint.errors import InputError
from visint.names import is_name

__all__ = ["Against", "read_against"]

_ENDINGS: Mapping[str, str] = {
    **dict.fromkeys(("Depth", "Disparity", "Relief", "Incidence", "Confidence", "Sigma"), "pfm"),
    **dict.fromkeys(("Normals", "Regions"), "npz"),
    **dict.fromkeys(("Boundaries", "Mask"), "png"),
}
"""What the file of an output of each kind ends in, of the kinds that can be compared."""


class Against(NamedTuple):
    """The other run.

    Attributes
    ----------
    folder
        Where it lies, as it was given.
    graph
        The name of its graph.
    maps
        Output name → (kind, array), for the outputs whose files are there.
    parameters
        Node → its parameters, as its record has them.
    seconds
        How long it took; None if it left no profile.
    """

    folder: str
    graph: str
    maps: Mapping[str, tuple[str, Array]]
    parameters: Mapping[str, Mapping[str, Any]]
    seconds: float | None = None


def read_against(folder: str | PathLike[str]) -> Against:
    """The run in ``folder``.

    Raises
    ------
    InputError
        VI302 if the folder holds no run record of visint; VI301 to VI305 if a map of it cannot be read.
    """
    place = Path(folder)
    record = io.read_json(place / "run.json")
    if not _is_record(record):
        raise InputError.of("VI302", "is no run record of visint", where=str(place / "run.json"))
    maps = {name: (kind, io.read(place / file, kind)) for name, kind, file in _files(place, record["outputs"])}
    parameters = {name: dict(told) for name, told in record["parameters"].items() if isinstance(told, dict)}
    return Against(str(folder), str(record["graph"].get("name", "")), maps, parameters, _seconds(place))


def _is_record(record: Any) -> bool:
    return isinstance(record, dict) and all(
        isinstance(record.get(key), dict) for key in ("graph", "outputs", "parameters")
    )


def _files(place: Path, outputs: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    """(name, kind, file) of each output that can be compared; a record names no file outside its folder."""
    for name, told in outputs.items():
        kind = told.get("kind") if isinstance(told, dict) else None
        if not isinstance(kind, str) or kind not in _ENDINGS or not is_name(name):
            continue
        file = f"{name}.{_ENDINGS[kind]}"
        if (place / file).is_file():
            yield name, kind, file


def _seconds(place: Path) -> float | None:
    try:
        profile = io.read_json(place / "profile.json")
    except InputError:
        return None
    seconds = profile.get("seconds") if isinstance(profile, dict) else None
    return float(seconds) if isinstance(seconds, float | int) else None
