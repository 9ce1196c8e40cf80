"""How evidence enters the intrinsic map: coherence among neighbours, consistency with the map."""

from __future__ import annotations

from typing import Any

from visint.hookspecs import hookimpl

visint_contract = 1


@hookimpl
def visint_modules() -> list[Any]:
    """The modules of this plugin; imported here so that finding the plugin costs nothing."""
    from visint_bayes.boundaries import Boundaries
    from visint_bayes.coherence.boundaries import CohereBoundaries
    from visint_bayes.coherence.disparity import CohereDepth, CohereDisparity
    from visint_bayes.coherence.orientation import CohereNormals
    from visint_bayes.depth import Depth
    from visint_bayes.gradient import Gradient
    from visint_bayes.joint.candidates import Candidates
    from visint_bayes.joint.module import Joint
    from visint_bayes.joint.surface import Surface
    from visint_bayes.pairwise import Pairwise
    from visint_bayes.pointwise import Pointwise
    from visint_bayes.strategies.description_length import DescriptionLength
    from visint_bayes.strategies.fault_lattice import FaultLattice
    from visint_bayes.strategies.game import Game
    from visint_bayes.strategies.mrf import Mrf
    from visint_bayes.strategies.relaxation import Relaxation

    coherence = [CohereBoundaries, CohereDepth, CohereDisparity, CohereNormals]
    strategies = [DescriptionLength, FaultLattice, Game, Mrf, Relaxation]
    estimates = [Candidates, Joint, Surface]
    return [*coherence, *strategies, *estimates, Boundaries, Depth, Gradient, Pairwise, Pointwise]


@hookimpl
def visint_policies() -> Any:
    """``bayes.uniform``: chapter 5's coherence and consistency mapping for each kind of evidence."""
    from visint_bayes.policy import UNIFORM

    return {"uniform": UNIFORM}
