"""The lattice of premises: which can hold together, and which of the largest such sets to prefer."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import takewhile
from typing import Literal, NamedTuple

__all__ = ["Nogood", "maximal", "preferred"]

Premises = frozenset[str]


class Nogood(NamedTuple):
    """Premises that cannot all hold, unless ``excuse`` (a premise too) does."""

    premises: Premises
    excuse: str = ""

    def rules_out(self, held: Premises) -> bool:
        """Whether ``held`` cannot be."""
        return self.premises <= held and self.excuse not in held


def maximal(premises: Premises, nogoods: Sequence[Nogood]) -> Iterator[Premises]:
    """The largest sets of premises that no nogood rules out, none inside another; larger first, then by name.

    From all premises downwards, one given up a level, and only one that a nogood asks for: the work grows
    with how much must be given up.
    """
    found: list[Premises] = []
    level = [premises]
    while level:
        below: set[Premises] = set()
        for held in level:
            nogood = next((one for one in nogoods if one.rules_out(held)), None)
            if nogood is not None:
                below |= {held - {name} for name in nogood.premises}
            elif not any(held <= larger for larger in found):
                found.append(held)
                yield held
        level = sorted(below, key=sorted)


def preferred(
    premises: Premises, nogoods: Sequence[Nogood], by: Literal["votes", "priority"], trusted: Sequence[str]
) -> Premises:
    """One of the maximal sets.

    Parameters
    ----------
    by
        ``votes``: the one that gives up the fewest premises, of several the one that keeps the earliest of
        ``trusted``. ``priority``: premises are taken in the order of trust, each if it can join the rest.
        Those that are not named come behind, by name.
    """
    order = [*(name for name in trusted if name in premises), *sorted(premises - {*trusted})]
    if by == "priority":
        return _joined(order, nogoods)
    sets = maximal(premises, nogoods)
    first = next(sets)
    largest = [first, *takewhile(lambda one: len(one) == len(first), sets)]
    return min(largest, key=lambda one: [name not in one for name in order])


def _joined(order: Sequence[str], nogoods: Sequence[Nogood]) -> Premises:
    held: Premises = frozenset()
    for name in order:
        more = held | {name}
        if not any(nogood.rules_out(more) for nogood in nogoods):
            held = more
    return held
