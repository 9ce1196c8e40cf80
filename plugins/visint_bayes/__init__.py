"""How evidence enters the intrinsic map: coherence among neighbours, consistency with the map."""

from __future__ import annotations

from typing import Any

from visint.hookspecs import hookimpl

visint_contract = 1


@hookimpl
def visint_modules() -> list[Any]:
    """The modules of this plugin; imported here so that finding the plugin costs nothing."""
    from visint_bayes.boundaries import Boundaries
    from visint_bayes.pairwise import Pairwise

    return [Boundaries, Pairwise]
