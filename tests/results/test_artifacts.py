"""The files of a result: one an output by its name and kind, each read back here."""

from __future__ import annotations

import dataclasses
import io
import json
from importlib import resources

import cv2
import numpy as np
import pytest

from visint.errors import OutputError
from visint.fields import BoundaryKind, DepthEvidence
from visint.hookspecs import hookimpl
from visint.results.artifacts import files_of

SIZE = (5, 7)


def pfm(data):
    """A PFM of one or three channels, by its definition: rows from the bottom up."""
    kind, size, scale, body = data.split(b"\n", 3)
    width, height = map(int, size.split())
    order = "<f4" if float(scale) < 0 else ">f4"
    shape = (height, width, 3) if kind == b"PF" else (height, width)
    return np.frombuffer(body, order).reshape(shape)[::-1]


def png(data):
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    return image[..., ::-1] if image.ndim == 3 else image


def npz(data):
    return dict(np.load(io.BytesIO(data), allow_pickle=False))


def ply(data):
    """(rows of the vertices, header) of a binary PLY."""
    head, _, body = data.partition(b"end_header\n")
    lines = head.decode().splitlines()
    types = {"float": "<f4", "uchar": "u1"}
    names = [(line.split()[2], types[line.split()[1]]) for line in lines if line.startswith("property")]
    return np.frombuffer(body, np.dtype(names)), lines


@pytest.fixture(scope="module")
def cue(toys):
    """A small result: depth from brightness, and what follows from it."""
    image = toys.scene(*SIZE)
    return toys.run(toys.CUE, image=image, camera=toys.camera(SIZE))


def with_output(result, name, kind, value):
    """``result`` with nothing but one output."""
    return dataclasses.replace(result, outputs={name: value}, kinds={name: kind}, confidence={}, evidence={})


def names_in(folder):
    return sorted(path.name for path in folder.iterdir())


def only(result):
    return dict(files_of(result))


def test_depth_is_a_pfm_with_unknown_as_infinity(cue):
    depth = cue["depth"].copy()
    depth[1, 2] = np.nan
    back = pfm(only(with_output(cue, "depth", "Depth", depth))["depth.pfm"])
    assert np.isinf(back[1, 2])
    np.testing.assert_array_equal(np.where(np.isinf(back), np.nan, back), depth)


@pytest.mark.parametrize("kind", ["Relief", "Image", "Confidence", "Sigma"])
def test_other_maps_of_numbers_are_pfm_too(cue, kind):
    value = np.linspace(0, 1, 35, dtype=np.float32).reshape(SIZE)
    files = only(with_output(cue, "it", kind, value))
    assert set(files) == {"it.pfm"}
    np.testing.assert_array_equal(pfm(files["it.pfm"]), value)


def test_color_is_a_pfm_of_three_channels(cue):
    value = np.random.default_rng(0).random((*SIZE, 3), np.float32)
    np.testing.assert_array_equal(pfm(only(with_output(cue, "it", "Color", value))["it.pfm"]), value)


def test_disparity_is_a_pfm_and_a_kitti_png(cue):
    """KITTI: 16 bits, disparity × 256, 0 unknown."""
    value = np.arange(35, dtype=np.float32).reshape(SIZE) / 4 + 1
    value[0, 0] = np.nan
    files = only(with_output(cue, "disparity", "Disparity", value))
    assert set(files) == {"disparity.pfm", "disparity.png"}
    steps = png(files["disparity.png"])
    assert (steps.dtype, steps[0, 0]) == (np.uint16, 0)
    np.testing.assert_array_equal(steps[1:] / 256, value[1:])


def test_disparity_below_zero_has_no_kitti_png(cue):
    """Converging cameras: KITTI's PNG cannot hold them, so there is the PFM alone."""
    value = np.full(SIZE, -3, np.float32)
    assert set(only(with_output(cue, "disparity", "Disparity", value))) == {"disparity.pfm"}


def test_normals_are_an_npz_by_their_name_and_a_picture(cue):
    """Facing the camera is blue: (0, 0, −1) → (127, 127, 255)."""
    value = np.zeros((*SIZE, 3), np.float32)
    value[..., 2] = -1
    files = only(with_output(cue, "normals", "Normals", value))
    assert set(files) == {"normals.npz", "normals.png"}
    assert list(npz(files["normals.npz"])) == ["normals", "normals.unit"]
    np.testing.assert_array_equal(npz(files["normals.npz"])["normals"], value)
    np.testing.assert_array_equal(png(files["normals.png"])[0, 0], [127, 127, 255])


@pytest.mark.parametrize("kind", ["Boundaries", "Mask"])
def test_booleans_are_a_black_and_white_png(cue, kind):
    value = np.random.default_rng(0).random(SIZE) < 0.5
    files = only(with_output(cue, "it", kind, value))
    np.testing.assert_array_equal(png(files["it.png"]), value * 255)


def test_kinds_of_boundary_are_an_npz_and_a_picture_in_their_colours(cue):
    """Every kind has its colour, none is black; the report's key shows the same colours."""
    value = np.array([[0, 1, 2], [3, 4, 5]], np.uint8)
    files = only(with_output(cue, "kinds", "BoundaryKinds", value))
    np.testing.assert_array_equal(npz(files["kinds.npz"])["kinds"], value)
    colors = png(files["kinds.png"]).reshape(-1, 3)
    assert not colors[0].any()
    assert len({tuple(color) for color in colors}) == 6
    css = (resources.files("visint.results.report") / "report.css").read_text()
    for kind in BoundaryKind:
        if kind:
            assert f".swatch.{kind.name.lower()} {{ background: #{bytes(colors[kind]).hex()}; }}" in css


def test_regions_are_an_npz_and_a_picture_in_their_colours(cue):
    value = np.array([[0, 1, 1], [2, 2, 70000]], np.int32)
    files = only(with_output(cue, "regions", "Regions", value))
    np.testing.assert_array_equal(npz(files["regions.npz"])["regions"], value)
    colors = png(files["regions.png"])
    assert not colors[0, 0].any()
    assert len({tuple(color) for color in colors.reshape(-1, 3)}) == 4


def test_any_other_array_is_an_npz(cue):
    value = np.linspace(0, 1, 5)
    files = only(with_output(cue, "weights", "Scalars", value))
    np.testing.assert_array_equal(npz(files["weights.npz"])["weights"], value)


def test_a_number_has_no_file_of_its_own(toys):
    assert only(toys.run(toys.SCALARS)) == {}


def test_confidence_stands_beside_each_output(cue):
    files = only(cue)
    for name in ("depth", "disparity", "normals"):
        np.testing.assert_array_equal(pfm(files[f"{name}_confidence.pfm"]), 0.5)


def test_confidence_that_the_graph_gives_itself_is_written_once(met):
    """The hub graph gives depth_confidence as an output: one file of the name, and no confidence of it."""
    names = [name for name, _ in files_of(met)]
    assert names.count("depth_confidence.pfm") == 1
    assert "depth_confidence_confidence.pfm" not in names
    assert len(set(names)) == len(names)


def test_evidence_is_one_npz(met):
    """Value by its kind, sigma and reliability of each spoke; the match says disparity 8 × brightness."""
    arrays = npz(only(met)["evidence.npz"])
    of = {"edges": "boundaries", "shade": "depth", "match": "disparity"}
    wanted = {f"{s}.{p}" for s, kind in of.items() for p in (kind, "sigma", "reliability")}
    units = {f"{s}.{p}.unit" for s, kind in of.items() for p in (kind, "sigma")}
    assert set(arrays) == wanted | units
    assert arrays["match.disparity.unit"].item() == arrays["match.sigma.unit"].item() == "px"
    np.testing.assert_allclose(arrays["match.disparity"], met.inputs["right"] * 8, rtol=1e-6)
    np.testing.assert_array_equal(arrays["match.sigma"], 0.5)


def test_points_are_the_known_ones_with_normals_and_colour(cue):
    """X = Z (u − c_x)/f, Y = Z (v − c_y)/f; the picture's grey is that of the screen."""
    depth = cue["depth"].copy()
    depth[0] = np.nan
    normals = cue["normals"]
    result = dataclasses.replace(cue, outputs={"depth": depth, "normals": normals})
    vertices, header = ply(only(result)["points.ply"])
    assert "comment unit mm" in header
    assert len(vertices) == 4 * 7
    v, u = np.mgrid[1:5, :7]
    camera = cue.camera
    np.testing.assert_allclose(
        vertices["x"], (depth[1:] * (u - camera.cx) / camera.focal_length).ravel(), rtol=1e-5
    )
    np.testing.assert_allclose(
        vertices["y"], (depth[1:] * (v - camera.cy) / camera.focal_length).ravel(), rtol=1e-5
    )
    np.testing.assert_array_equal(vertices["z"], depth[1:].ravel())
    np.testing.assert_array_equal(vertices["nz"], normals[1:, :, 2].ravel())
    np.testing.assert_array_equal(vertices["red"], vertices["blue"])


def test_no_points_without_a_camera_or_a_known_depth(toys, cue):
    image = toys.scene(*SIZE)
    assert "points.ply" not in only(toys.run(toys.CUE, image=image))
    nothing = np.full(SIZE, np.nan, np.float32)
    assert "points.ply" not in only(with_output(cue, "depth", "Depth", nothing))


def test_points_do_without_what_does_not_fit(cue):
    """A picture of another size gives no colour; a depth map of another size than the camera's no points."""
    other = dataclasses.replace(cue, inputs={**cue.inputs, "image": np.zeros((9, 9), np.float32)})
    vertices, _ = ply(only(other)["points.ply"])
    assert vertices.dtype.names == ("x", "y", "z", "nx", "ny", "nz")
    assert "points.ply" not in only(with_output(cue, "depth", "Depth", np.ones((9, 9), np.float32)))


class Brings:
    """A plugin that writes depth its own way."""

    visint_contract = 1

    @hookimpl
    def visint_modules(self):
        return ()

    @hookimpl
    def visint_writers(self):
        return {"Depth": lambda name, value: {f"{name}.txt": f"{value.shape}".encode()}}


def test_a_plugins_writer_comes_first(toys):
    text = toys.CUE
    catalog = toys.catalog({"mine": Brings()})
    catalog.plugin("mine")
    result = toys.run_in(text, catalog, image=toys.scene(*SIZE))
    assert only(result) == {
        "depth.txt": b"(5, 7)",
        "depth_confidence.pfm": only(result)["depth_confidence.pfm"],
        "evidence.npz": only(result)["evidence.npz"],
    }


def test_save_writes_all_files_and_the_records(met, tmp_path):
    """What is named is there, and nothing else; run.json and profile.json are JSON."""
    names = met.save(tmp_path / "out")
    assert names_in(tmp_path / "out") == sorted(names)
    told = json.loads((tmp_path / "out/run.json").read_text())
    assert sorted(told["files"]) == sorted(names)
    profile = json.loads((tmp_path / "out/profile.json").read_text())
    assert profile["graph"] == "meeting"
    assert {node["node"] for node in profile["nodes"]} >= {"edges", "shade", "match", "measured"}
    assert (tmp_path / "out/report.html").read_text().startswith("<!doctype html>")


def test_saving_twice_gives_the_same_bytes(toys, met, tmp_path):
    """But for the timings: the profile and the report."""
    for name, result in (("a", met), ("b", toys.meeting())):
        result.save(tmp_path / name)
    names = names_in(tmp_path / "a")
    assert names == names_in(tmp_path / "b")
    differ = [n for n in names if (tmp_path / "a" / n).read_bytes() != (tmp_path / "b" / n).read_bytes()]
    assert set(differ) <= {"profile.json", "report.html"}


def test_a_folder_of_other_things_is_refused_and_left_alone(met, tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(OutputError):
        met.save(tmp_path)
    assert names_in(tmp_path) == ["mine.txt"]


def test_evidence_that_knows_nothing_is_saved(met, tmp_path):
    nothing = DepthEvidence.of(np.full(SIZE, np.nan, np.float32), 1.0, 0.0)
    result = dataclasses.replace(met, evidence={"silent": nothing})
    assert "evidence.npz" in result.save(tmp_path / "out")
