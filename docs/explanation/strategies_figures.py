"""Draws the figure of the strategies page beside this file, and prints its table.

Run from the project's root: ``python docs/explanation/strategies_figures.py``. Two made-up cues look at a
made-up surface: a sharp one that is grossly wrong at some pixels and, sure of itself as a matcher is of what a
mirror shows, over a patch; and a blunt one that is right everywhere.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from visint.fields import DisparityEvidence
from visint.fields.geometry import depth_from_disparity, disparity_from_depth
from visint.io import encode_png
from visint.module import Context
from visint.results.pictures import of_scalar
from visint.testing.samples import sample_camera
from visint_bayes.pointwise import Pointwise
from visint_bayes.strategies.description_length import DescriptionLength
from visint_bayes.strategies.fault_lattice import FaultLattice
from visint_bayes.strategies.game import Game
from visint_bayes.strategies.mrf import Mrf
from visint_bayes.strategies.relaxation import Relaxation

SIZE = (72, 96)
PATCH = (slice(45, 66), slice(69, 90))
PREMISES = (("brightness_constancy", "opacity"), ("homogeneity",))


def surface():
    """True disparity: a slanted ground, and a box in front of it."""
    y, x = np.mgrid[: SIZE[0], : SIZE[1]].astype(np.float32)
    ground = 6 + 0.04 * y
    box = (np.abs(x - 45) < 21) & (np.abs(y - 33) < 16)
    return np.where(box, 12 - 0.03 * x, ground).astype(np.float32)


def cues(truth, seed=0):
    """The sharp one (σ 0.3, one pixel in twelve anywhere, a patch 4 px off) and the blunt one (σ 1)."""
    rng = np.random.default_rng(seed)
    sharp = truth + rng.normal(0, 0.3, SIZE)
    wild = rng.random(SIZE) < 1 / 12
    sharp[wild] = rng.uniform(4, 14, wild.sum())
    sharp[PATCH] += 4
    blunt = truth + rng.normal(0, 1, SIZE)
    return tuple(
        DisparityEvidence.of(value.astype(np.float32), sigma, 1.0)
        for value, sigma in ((sharp, 0.3), (blunt, 1.0))
    )


def strategies():
    """(name, module) in the order of the page."""
    return [
        ("pointwise (Eq. 5.10)", Pointwise()),
        ("relaxation", Relaxation()),
        ("MRF with lines", Mrf()),
        ("game", Game()),
        ("fault lattice, votes", FaultLattice(FaultLattice.Params(premises=PREMISES))),
        ("fault lattice, trust in the sharp cue", trusting()),
        ("description length", DescriptionLength()),
    ]


def trusting():
    """The lattice that gives up the blunt cue's premise first."""
    params = FaultLattice.Params(premises=PREMISES, choose="priority", trusted=PREMISES[0])
    return FaultLattice(params)


def answers(evidence):
    """(name, disparity) of every strategy."""
    camera = sample_camera(SIZE)
    depth = depth_from_disparity(np.full(SIZE, 8, np.float32), camera)
    for name, module in strategies():
        inputs = module.Inputs(disparity_evidence=evidence, depth=depth, camera=camera)
        outputs = module.run(inputs, Context(size=SIZE))
        yield name, disparity_from_depth(outputs.depth, camera)


def tile(values):
    """A map in colours, framed in white."""
    quarters = np.round(values * 4) / 4  # fewer colours make a smaller file
    return np.pad(of_scalar(quarters, 4.0, 14.0), ((2, 2), (2, 2), (0, 0)), constant_values=255)


def main():
    """Writes ``strategies.png`` and prints the errors."""
    truth = surface()
    evidence = cues(truth)
    found = dict(answers(evidence))
    maps = [truth, *(one.value for one in evidence), *found.values()]
    maps += [np.full(SIZE, np.nan, np.float32)] * (-len(maps) % 5)
    tiles = [tile(one) for one in maps]
    rows = [np.concatenate(tiles[i : i + 5], axis=1) for i in range(0, len(tiles), 5)]
    (Path(__file__).parent / "strategies.png").write_bytes(encode_png(np.concatenate(rows)))
    patch = np.zeros(SIZE, bool)
    patch[PATCH] = True
    named = {"sharp cue": evidence[0].value, "blunt cue": evidence[1].value, **found}
    for name, disparity in named.items():
        wrong = np.abs(disparity - truth)
        bad = 100 * float((wrong > 1).mean())
        print(f"| {name} | {rms(wrong):.2f} | {rms(wrong[~patch]):.2f} | {rms(wrong[patch]):.2f} | {bad:.1f} |")


def rms(error):
    """Root mean square."""
    return float(np.sqrt(np.mean(error**2)))


if __name__ == "__main__":
    main()
