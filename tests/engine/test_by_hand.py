"""A system of the size of the real ones, against the same thing written out in plain Python and numpy."""

from __future__ import annotations

import numpy as np
import pytest

from visint.fields import KINDS
from visint.fields.kinds import down, up

TEXT = """
inputs: {left: Image, right: Image}
loops:
  levels: {over: pyramid, levels: 4, between: {Image: replicate}}
  sweeps: {inside: levels, times: 8, until: {change_of: couple.image, below: 0.02, patience: 2}}
  rounds: {inside: sweeps, times: 3}
nodes:
  mean: {uses: toy.stack, in: {images: [inputs.left, inputs.right]}}
  bright: {uses: toy.image, loop: levels, at: {3: {gain: 2.0}}, in: {image: inputs.left}}
  match: {uses: toy.smooth, loop: rounds, in: {source: back.image},
          feedback: {image: {from: match.image, start: 0.5}}}
  anew: {uses: toy.smooth, loop: rounds,
         feedback: {image: {from: anew.image, start: bright.image, restart: sweeps}}}
  still: {uses: toy.image, loop: rounds, with: {gain: 0.1}, in: {image: mean.image}}
  shade: {uses: toy.image, loop: sweeps, levels: [0, 2], with: {offset: 0.1}, in: {image: match.image}}
  couple: {uses: toy.stack, loop: sweeps, in: {images: [match.image, anew.image, shade.image, still.image]}}
  back: {uses: toy.image, loop: sweeps, with: {gain: 0.05},
         feedback: {image: {from: couple.image, start: inputs.right}}}
  after: {uses: toy.stack, loop: levels, in: {images: [couple.image, bright.image]}}
  last: {uses: toy.image, in: {image: after.image}, with: {gain: 3.0}}
outputs: {last: last.image, couple: couple.image, back: back.image}
"""


def picture(image, gain=1.0, offset=0.0):
    return image * np.float32(gain) + np.float32(offset)


def stack(*images):
    return np.stack(images).mean(axis=0, dtype=np.float32)


def smooth(old, source=None):
    new = old.copy()
    new[1:-1, 1:-1] = (old[:-2, 1:-1] + old[2:, 1:-1] + old[1:-1, :-2] + old[1:-1, 2:]) / 4
    if source is not None:
        new[1:-1, 1:-1] -= source[1:-1, 1:-1] / 4
    return new


def pyramid(image, levels):
    images = [image]
    while len(images) < levels:
        images.append(down(images[-1], KINDS["Image"]))
    return images


def by_hand(left, right):
    """The graph above, written out; gives its outputs and the sweeps of each level."""
    lefts, means, rights = pyramid(left, 4), pyramid(stack(left, right), 4), pyramid(right, 4)
    sweeps = []
    match_cell = np.full(lefts[3].shape, 0.5, np.float32)
    back_cell = rights[3]
    for level in (3, 2, 1, 0):
        size = lefts[level].shape
        if match_cell.shape != size:
            match_cell, back_cell = (
                up(cell, KINDS["Image"], size, "replicate") for cell in (match_cell, back_cell)
            )
        bright = picture(lefts[level], 2.0 if level == 3 else 1.0)
        still = picture(means[level], 0.1)
        before, calm, sweep = None, 0, 0
        while sweep < 8 and calm < 2:
            sweep += 1
            back = picture(back_cell, 0.05)
            anew = bright
            for _ in range(3):
                match_cell, anew = smooth(match_cell, back), smooth(anew)
            shade = [picture(match_cell, 1.0, 0.1)] if level in (0, 2) else []
            couple = back_cell = stack(match_cell, anew, *shade, still)
            if before is not None:
                change = np.linalg.norm(couple - before) / np.linalg.norm(couple)
                calm = calm + 1 if change < 0.02 else 0
            before = couple
        sweeps.append(sweep)
        after = stack(couple, bright)
    return {"last": picture(after, 3.0), "couple": couple, "back": back}, sweeps


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("size", [(29, 22), (32, 16), (9, 40)])
def test_four_levels_of_sweeps_and_rounds(stage, size, threads):
    """The very bits: levels, converging sweeps, rounds; what carries on, restarts, pauses, is lifted."""
    rng = np.random.default_rng(11)
    left, right = rng.random(size, dtype=np.float32), rng.random(size, dtype=np.float32)
    result = stage.run(TEXT, {"left": left, "right": right}, threads=threads)
    wanted, sweeps = by_hand(left, right)
    for name, image in wanted.items():
        np.testing.assert_array_equal(result[name], image, err_msg=name)
    assert [stop.turns for stop in result.stops if stop.loop == "sweeps"] == sweeps
    assert len(set(sweeps)) > 1 or max(sweeps) < 8
    assert len(stage.calls_of("match")) == 3 * sum(sweeps)
    assert stage.calls_of("still") == stage.calls_of("bright") == [(level, 0) for level in (3, 2, 1, 0)]
