"""What is installed, read from entry points; nothing is imported."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from importlib.metadata import Distribution, EntryPoint, distributions
from typing import NamedTuple

from visint.errors import PluginError

__all__ = ["GROUPS", "Entry", "discover", "only"]

GROUPS = ("visint.plugins", "visint.commands", "visint.graphs")
"""The entry-point groups: vision modules, command-line verbs, folders of graph files."""


class Entry(NamedTuple):
    """One installed entry point: its name, what it points to, and the distribution that brings it."""

    name: str
    target: EntryPoint
    distribution: str
    version: str

    @property
    def origin(self) -> str:
        """``distribution version``, for messages and run records."""
        return f"{self.distribution} {self.version}".strip()


def discover(group: str) -> Mapping[str, tuple[Entry, ...]]:
    """Every entry of a group by name, in the order of names; more than one where distributions clash."""
    found: dict[str, list[Entry]] = defaultdict(list)
    for distribution in distributions():
        for entry in _entries(distribution, group):
            found[entry.name].append(entry)
    return {name: _distinct(found[name]) for name in sorted(found)}


def _entries(distribution: Distribution, group: str) -> list[Entry]:
    """The entries of one distribution; none if its metadata are broken, which must not hide the others."""
    try:
        points = distribution.entry_points.select(group=group)
        if not points:
            return []
        metadata = distribution.metadata  # has no get
        about = {key: metadata[key] for key in ("Name", "Version") if key in metadata}
        name, version = about.get("Name", "unknown"), about.get("Version", "")
        return [Entry(point.name, point, name, version) for point in points]
    except (OSError, TypeError, ValueError, LookupError):
        return []


def _distinct(entries: Iterable[Entry]) -> tuple[Entry, ...]:
    """One entry a distribution: a checkout and its installed copy are the same distribution seen twice."""
    by_distribution = {entry.distribution: entry for entry in reversed(list(entries))}
    return tuple(by_distribution[name] for name in sorted(by_distribution))


def only(entries: tuple[Entry, ...]) -> Entry:
    """The one entry of a name.

    Raises
    ------
    PluginError
        VI502 if two distributions claim the name; both are named, neither is chosen.
    """
    if len(entries) > 1:
        claims = " and ".join(entry.origin for entry in entries)
        raise PluginError.of(
            "VI502",
            f"the name {entries[0].name!r} is claimed by {claims}",
            write=f"pip uninstall {entries[-1].distribution}",
        )
    return entries[0]
