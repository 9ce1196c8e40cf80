"""``visint tune``: scenes by seed, the choice among candidates, and what it writes."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from visint_lab.render.rendering import render
from visint_lab.tuning.conditions import CONDITIONS, OTHERS, drawn, with_others
from visint_lab.tuning.fit import fitted
from visint_lab.tuning.reliefs import CONDITIONS as RELIEFS
from visint_lab.tuning.reliefs import staged
from visint_lab.tuning.table import Sample, gathered, samples_in, written
from visint_lab.tuning.validation import Verdict, table

TABLE = Path(__file__).parents[3] / "docs/explanation/joint_table.json"


def test_every_seed_is_drawn_once():
    """Forty-two scenes a round, a thousand seeds apart; sixty with the surfaces nothing is trained on."""
    found = list(drawn(5000, 2))
    assert len(found) == 2 * 6 * len(CONDITIONS)
    assert len({seed for _, seed in found}) == len(found)
    assert {seed // 1000 for _, seed in found} == {5, 6}
    assert len(list(with_others(5000))) == 42 + len(OTHERS) == 60


def test_a_relief_is_rendered_from_its_name():
    """The same seed gives the same relief; another seed another one."""
    first, again, other = (render(staged(RELIEFS[1], 48, seed), samples=1) for seed in (3, 3, 4))
    assert np.array_equal(first.truth.depth, again.truth.depth, equal_nan=True)
    assert not np.array_equal(first.truth.foreground, other.truth.foreground)
    assert 0.1 < first.truth.foreground.mean() < 0.8


def samples(count=80):
    """Two candidates: a sign of the first tells which is better, the second is what it seems."""
    rng = np.random.default_rng(0)
    made = []
    for number in range(count):
        sign = rng.standard_normal()
        signs = np.array([[sign, rng.standard_normal()], [sign, rng.standard_normal()]])
        good, bad = np.exp([-1 + 0.1 * rng.standard_normal(), 1.0])
        ratios = np.array([[good, good], [bad, bad]] if sign > 0 else [[bad, bad], [good, good]])
        made.append(Sample("a/sphere/lambertian", number, 64, signs, ratios))
    return made


def test_the_fit_finds_the_sign_that_tells():
    """Where the sign is plain, the better candidate is predicted better."""
    fit = fitted(samples())
    high, low = (fit.model.predicted(np.full((2, 2), value) * [1.0, 0.0])[0] for value in (1.5, -1.5))
    assert high[0] < high[1] - 0.5
    assert low[1] < low[0] - 0.5
    assert np.median(fit.held_out) > 20


def test_a_table_reads_back():
    """Signs and ratios to five digits."""
    before = samples(3)
    after = samples_in(json.loads(json.dumps(written(before))))
    for one, other in zip(before, after, strict=True):
        assert one.signs == pytest.approx(other.signs, abs=1e-5)
        assert (one.scene, one.seed, one.size) == (other.scene, other.seed, other.size)


def test_the_recorded_table_is_of_training_seeds_only():
    """No validation seed (900000 and up) among what the shipped choice was learned from."""
    recorded = json.loads(TABLE.read_text())
    assert all(row["seed"] < 900000 for rows in recorded.values() for row in rows)
    assert len(recorded["lit"]) > 150


def test_the_shipped_choice_is_what_the_table_gives(tmp_path):
    """``visint tune joint --choice --table …`` writes the coefficients that are shipped."""
    from visint.cli import main

    out = tmp_path / "learned"
    arguments = ["tune", "joint", "--choice", "--table", str(TABLE), "--validate", "0:0", "--out", str(out)]
    assert not main(arguments)
    from visint.io import resource_text

    found, shipped = (json.loads(text) for text in ((out / "choice.json").read_text(), _shipped(resource_text)))
    for which in ("lit", "dark"):
        assert found[which]["depth"] == pytest.approx(np.array(shipped[which]["depth"]), abs=2e-3)
        assert found[which]["caution"] == shipped[which]["caution"]


def _shipped(resource_text):
    return resource_text("visint_bayes", "joint", "choice.json")


def test_candidates_are_gathered_with_their_true_errors():
    """One small scene: six candidates with a light, two without."""
    for lit, kinds in ((True, 6), (False, 2)):
        (found,) = gathered([("a/sphere/lambertian+2%", 3)], 96, lit)
        assert found.signs.shape[0] == kinds
        assert found.ratios.shape == (kinds, 2)
        assert (found.ratios > 0).all()


def test_the_report_counts_what_was_made_worse():
    """A row a kind of surface and one of all; worse is by more than 2 %."""
    found = [
        Verdict("a/sphere/lambertian#1", "joint", 50.0, 60.0, 10.0, 0.1, 0.2),
        Verdict("a/torus/lambertian#2", "joint", -5.0, -1.0, float("nan"), 0.1, 0.2),
    ]
    kind, everything = table(found)
    assert kind[:3] == ["joint", "lambertian", 2]
    assert everything[1:3] == ["all", 2]
    assert kind[6:9] == [1, 0, -5.0]


def test_scenes_that_make_no_sense_are_refused():
    """A usage error, not a traceback."""
    from visint_lab.tune import _drawn

    with pytest.raises(Exception, match="FIRST_SEED:ROUNDS"):
        _drawn("many")
