"""The classic drawings: how many labellings the catalogue allows, and which one is found."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest

from visint_lines.catalogue import FLIP, LABELS
from visint_lines.diagram import Measures
from visint_lines.elimination import count, solve
from visint_lines.factors import NEVER, factors_of
from visint_lines.label import LabelParams, labelled
from visint_lines.priors import type_prior
from visint_lines.record import labels_record

HERE = Path(__file__).parent
SPEC = importlib.util.spec_from_file_location("drawings", HERE / "drawings.py")
drawings = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(drawings)

NAMES = ("cube", "block", "house", "cylinder", "cone")
WHOLE = ("cube", "block", "house", "cylinder")


def made(name):
    spots, lines, outside, truth = getattr(drawings, name)()
    return drawings.drawing(spots, lines, outside), truth


def hard(name, diagram):
    """The type of each junction from clean geometry; a curved body's are known by their tangents."""
    if name in ("cylinder", "cone"):
        return [{kind: 1.0} for kind in drawings.TYPES[name].split()]
    priors = [type_prior(diagram, junction) for junction in diagram.junctions]
    return [{max(prior, key=prior.get): 1.0} for prior in priors]


def allowed(diagram, floating):
    """Log weights: marks never; with the floating preference outlines occlude with the body inside."""
    unary = np.zeros((len(diagram.arcs), len(LABELS)))
    unary[:, LABELS.index("x")] = NEVER
    for number, arc in enumerate(diagram.arcs):
        if floating and arc.background:
            inside = (">", ">>") if arc.background == "left" else ("<", "<<")
            unary[number] = [0.0 if label in inside else NEVER for label in LABELS]
    return unary


@pytest.mark.parametrize(
    ("name", "free", "floating"),
    [("cube", 4, 1), ("block", 4, 1), ("house", 7, 1), ("cylinder", 2, 1), ("cone", 4, 1)],
)
def test_number_of_labellings(name, free, floating):
    """As known for these drawings; the floating preference leaves one."""
    diagram, _ = made(name)
    factors = factors_of(diagram, hard(name, diagram), 0.0)
    assert count(allowed(diagram, False), factors) == pytest.approx(free)
    assert count(allowed(diagram, True), factors) == pytest.approx(floating)


@pytest.mark.parametrize("name", WHOLE)
def test_the_one_with_the_floating_preference_is_right(name):
    diagram, truth = made(name)
    answer = solve(allowed(diagram, True), factors_of(diagram, hard(name, diagram), 0.0))
    assert [LABELS[i] for i in answer.best] == truth
    assert answer.exact
    np.testing.assert_allclose(answer.marginals.max(axis=1), 1)


def test_a_cone_alone_is_labelled_wrongly_because_an_apex_is_no_corner():
    """The catalogue leaves the apex out: its sides come out as edges and its foot as a limb."""
    diagram, _ = made("cone")
    answer = solve(allowed(diagram, True), factors_of(diagram, hard("cone", diagram), 0.0))
    assert [LABELS[i] for i in answer.best] == ["<", ">", "<<"]


def with_depth(diagram, truth):
    """The diagram with features as clean depth would give them."""
    from dataclasses import replace

    arcs = []
    for arc, label in zip(diagram.arcs, truth, strict=True):
        left = label in ("<", "<<")
        gap = 0.0 if label in "+-" else 40.0 if left else -40.0
        bend = {"+": 1.5, "-": -1.5}.get(label, 0.0)
        limb = float(len(label) == 2)
        told = Measures(gap, 0.5, bend, 0.05, limb * left, limb * (not left), 1.0)
        arcs.append(replace(arc, measures=told))
    return replace(diagram, arcs=tuple(arcs))


@pytest.mark.parametrize("method", ["exact", "rows", "published"])
@pytest.mark.parametrize("name", WHOLE)
def test_soft_types_and_depth_find_the_truth(name, method):
    """Junction types are inferred, not given; with depth all three methods label every line right."""
    diagram, truth = made(name)
    found = labelled(with_depth(diagram, truth), LabelParams(method=method))
    assert [arc.label for arc in found.arcs] == truth


@pytest.mark.parametrize("name", WHOLE)
def test_as_published(name):
    """The record of each drawing is the one that was looked at (``golden/<name>.json``)."""
    diagram, truth = made(name)
    found = json.loads(labels_record(labelled(with_depth(diagram, truth), LabelParams())))
    kept = HERE / "golden" / f"{name}.json"
    if not kept.exists():  # pragma: no cover - written once, looked at, kept
        kept.parent.mkdir(exist_ok=True)
        kept.write_text(json.dumps(_essence(found), indent=1) + "\n")
    assert _essence(found) == json.loads(kept.read_text())


def _essence(record):
    """What does not hang on the last digit."""
    return {
        "junctions": [(j["type"], j["legal"], [a["arc"] for a in j["arcs"]]) for j in record["junctions"]]
        and [[j["type"], j["legal"], [a["arc"] for a in j["arcs"]]] for j in record["junctions"]],
        "arcs": [[arc["start"], arc["end"], arc["label"]] for arc in record["arcs"]],
    }


def test_a_line_walked_the_other_way_has_the_other_label():
    """Turning arcs round turns their labels and changes nothing else."""
    from dataclasses import replace

    spots, lines, outside, truth = drawings.block()
    turned = [(end, start) for start, end in lines]
    other = {number: {"left": "right", "right": "left"}[side] for number, side in outside.items()}
    diagram = drawings.drawing(spots, turned, other)
    answer = solve(allowed(diagram, True), factors_of(diagram, hard("block", diagram), 0.0))
    assert [LABELS[i] for i in answer.best] == [FLIP[label] for label in truth]
    assert replace(diagram).size == drawings.SIZE
