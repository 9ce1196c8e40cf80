"""Scenes of the lab from label map to labels, alone and as a graph; figures of the documentation."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import numpy as np
import pytest

import visint
from visint.fields import BoundaryKind
from visint.fields.geometry import depth_from_disparity
from visint.fields.resampling import region_boundaries
from visint.module import Context
from visint_lines.catalogue import KINDS
from visint_lines.label import Label, LabelInputs, LabelParams
from visint_lines.measure import Features, FeaturesInputs, FeaturesParams
from visint_lines.parse import Parse, ParseInputs

HERE = Context()
UNSEEN = range(30)  # run once with the parameters as they are; those were chosen on 1000 to 1041
SPEC = spec_from_file_location("truth", Path(__file__).with_name("truth.py"))
truths = module_from_spec(SPEC)
SPEC.loader.exec_module(truths)
GRAPH = """
visint: 1
name: drawing
inputs: {image: Image, regions: Regions, depth: Depth, camera: Camera}
nodes:
  parse: {uses: lines.parse, in: {regions: inputs.regions}}
  features:
    uses: lines.features
    in: {diagram: parse.diagram, regions: parse.regions, depth: inputs.depth, camera: inputs.camera}
  label: {uses: lines.label, in: {diagram: features.diagram, image: inputs.image}}
outputs: {labels: label.labels, kinds: label.kinds, limbs: label.limbs}
"""


def interpreted(regions, depth, camera, image=None, blur=0.0, **params):
    drawing = Parse().run(ParseInputs(regions=regions), HERE)
    given = FeaturesInputs(diagram=drawing.diagram, regions=drawing.regions, depth=depth, camera=camera)
    measured = Features(FeaturesParams(blur=blur)).run(given, HERE)
    return Label(LabelParams(**params)).run(LabelInputs(diagram=measured.diagram, image=image), HERE)


def figures(pairs, depth_of=None, blur=0.0, **params):
    """(shares of lines, of directions, of types of junctions right; how many lines, junctions) over scenes.

    ``depth_of(seed, pair)``: the depth to go by, the true one if left out. Lines without a true edge near them
    and junctions at the frame do not count; four lines at a point always count as wrong.
    """
    lines, directions, types = [], [], []
    for seed, pair in pairs:
        depth = pair.truth.depth if depth_of is None else depth_of(seed, pair)
        labels = interpreted(pair.truth.regions, depth, pair.camera, blur=blur, **params).labels
        kinds = truths.kinds_of(labels.diagram, pair.truth.edges)
        nearer = truths.nearer_regions(labels.diagram, pair.truth.depth)
        for arc, told, kind, near in zip(labels.diagram.arcs, labels.arcs, kinds, nearer, strict=True):
            said = truths.NUMBERS[KINDS[told.label]]
            lines += [said == kind] if kind else []
            if said == kind and told.label[0] in "<>":
                directions.append((arc.right if told.label[0] == ">" else arc.left) == near)
        meant = truths.types_of(labels.diagram, kinds, nearer, truths.corners_of(pair.scene))
        for told, kind in zip(labels.junctions, meant, strict=True):
            types += [told.type == kind != "M"] if kind else []
    return np.mean(lines), np.mean(directions), np.mean(types), len(lines), len(types)


def noisy(noise):
    """True depth with Gaussian noise of so many pixels of relative depth."""

    def depth_of(seed, pair):
        true = pair.truth.depth
        off = np.random.default_rng(seed).standard_normal(true.shape)
        return (true * (1 + noise / pair.camera.focal_length * off)).astype(np.float32)

    return depth_of


def by_stereo(seed, pair):
    """The system's own depth: ``stereo.weng``, its smoothness held back at the drawing's lines."""
    del seed
    found = visint.run(
        visint.load(str(Path(__file__).with_name("stereo_by_lines.yaml"))),
        left=pair.left,
        right=pair.right,
        camera=pair.camera,
        boundaries=region_boundaries(pair.truth.regions),
    )
    return depth_from_disparity(found["disparity"], pair.camera)


def test_a_few_scenes(lab):
    """A torus and a box, a cylinder, an ellipsoid and more: nine of ten lines right."""
    lines, directions, types, *_ = figures([(seed, lab(seed)) for seed in (1004, 1009, 1013, 1018)])
    assert lines >= 0.9
    assert directions >= 0.95
    assert types >= 0.85


def test_a_ball_is_a_limb_and_a_box_has_none(lab):
    ball, box = lab(1011), lab(1008)
    kinds = interpreted(ball.truth.regions, ball.truth.depth, ball.camera).kinds
    assert set(np.unique(kinds)) == {BoundaryKind.NONE, BoundaryKind.LIMB}
    kinds = interpreted(box.truth.regions, box.truth.depth, box.camera).kinds
    assert set(np.unique(kinds)) == {BoundaryKind.NONE, BoundaryKind.OCCLUDING, BoundaryKind.CONVEX}


def test_as_a_graph_with_its_files(lab, tmp_path):
    """Plain nodes; labels are written as JSON and as a picture, kinds as a map."""
    pair = lab(1008)
    truth = pair.truth
    graph = tmp_path / "drawing.yaml"
    graph.write_text(GRAPH)
    result = visint.run(
        visint.load(str(graph)), image=pair.left, regions=truth.regions, depth=truth.depth, camera=pair.camera
    )
    result.save(tmp_path / "out")
    told = json.loads((tmp_path / "out/labels.json").read_text())
    assert len(told["arcs"]) == 9
    assert {arc["kind"] for arc in told["arcs"]} == {"occluding", "convex"}
    assert sorted(junction["type"] for junction in told["junctions"]) == ["L", "L", "L", "W", "W", "W", "Y"]
    for arc in told["arcs"]:
        assert sum(arc["probabilities"].values()) == pytest.approx(1, abs=1e-2)
    root = ET.fromstring((tmp_path / "out/labels.svg").read_text())
    names = [element.tag.rpartition("}")[2] for element in root.iter()]
    assert names.count("polyline") == 9
    assert names.count("image") == 1
    assert (tmp_path / "out/kinds.png").is_file()
    assert "swatch convex" in (tmp_path / "out/report.html").read_text()


@pytest.mark.parametrize("marks", ["checker", "two"])
def test_marks_are_no_creases(marks):
    """Lines between fields of a checker or two tones: nine of ten are not taken for creases."""
    from visint_lab.render.rendering import render

    spec = spec_from_file_location("scenes", Path(__file__).with_name("conftest.py"))
    scenes = module_from_spec(spec)
    spec.loader.exec_module(scenes)
    said = []
    for seed in (1000, 1002, 1009):
        pair = render(scenes.scene(seed, 256, marks), 1)
        labels = interpreted(scenes.marked(pair.truth), pair.truth.depth, pair.camera).labels
        truth = truths.kinds_of(labels.diagram, pair.truth.edges)
        said += [KINDS[arc.label] for arc, kind in zip(labels.arcs, truth, strict=True) if kind == 5]
    assert len(said) > 3
    assert np.mean([kind in ("convex", "concave") for kind in said]) <= 0.1


@pytest.mark.slow
@pytest.mark.parametrize(("noise", "least"), [(0.0, (0.93, 0.85)), (1.0, (0.92, 0.8))])
def test_thirty_unseen_scenes(lab, noise, least):
    """The figures of the documentation, lines and types of junctions. The aims were 97 and 95 %."""
    found = figures([(seed, lab(seed)) for seed in UNSEEN], noisy(noise) if noise else None)
    assert found[0] >= least[0]
    assert found[1] >= 0.98
    assert found[2] >= least[1]


@pytest.mark.slow
def test_thirty_unseen_scenes_by_their_own_depth(lab):
    """Depth by stereo alone. The aims were 90 % of lines and 85 % of types of junctions."""
    found = figures([(seed, lab(seed, samples=3)) for seed in UNSEEN], by_stereo, blur=5.0)
    assert found[0] >= 0.88
    assert found[2] >= 0.75


def limb_points_of(pair, seed, noise):
    """(true edge kind, whether taken for a limb) of every section across a line."""
    from scipy.ndimage import distance_transform_edt

    from visint_lines.measure import _flat, _observed, _offsets
    from visint_lines.sections import cut, surfaces

    rng, params = np.random.default_rng(seed), FeaturesParams()
    depth = pair.truth.depth * (
        1 + noise / pair.camera.focal_length * rng.standard_normal(pair.truth.depth.shape)
    )
    drawing = Parse().run(ParseInputs(regions=pair.truth.regions), HERE)
    seen = surfaces(depth, drawing.regions, pair.camera, params.window)
    sections = cut(drawing.diagram, seen, _offsets(params.samples, 0.0))
    edges = pair.truth.edges
    distance, nearest = distance_transform_edt(edges == 0, return_indices=True)
    label = np.where(distance <= 2.5, edges[tuple(nearest)], 0)
    spots = np.array(
        [drawing.diagram.arcs[a].points[i] for a, i in zip(sections.arc, sections.point, strict=True)]
    )
    column, row = (np.clip(np.rint(v).astype(int), 0, 255) for v in spots.T)
    flat = _flat(drawing.diagram, sections.arc, seen)
    return label[row, column], _observed(sections, params, 0.0, flat).points.passed


@pytest.mark.slow
@pytest.mark.parametrize("noise", [0.0, 0.5, 1.0])
def test_limbs_of_twelve_unseen_scenes(lab, noise):
    """Found in 95 % of their points, in at most 3 % of all others, up to a pixel of noise in depth."""
    told = [limb_points_of(lab(seed), seed, noise) for seed in range(12)]
    kind, passed = (np.concatenate(part) for part in zip(*told, strict=True))
    assert passed[kind == 1].mean() >= 0.95
    assert passed[(kind > 1) & (kind < 6)].mean() <= 0.03


def test_nothing_to_see():
    """One region: no lines, empty maps, sound files."""
    regions = np.ones((12, 9), np.int32)
    found = interpreted(regions, np.full((12, 9), np.nan, np.float32), None)
    assert not found.labels.arcs
    assert not found.kinds.any()
