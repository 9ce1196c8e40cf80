"""``visint run`` from files to files, held against readers of the test's own."""

from __future__ import annotations

import json

import cv2
import numpy as np
import pytest

import visint as package
from visint import io

EVERYTHING = {
    "depth.pfm",
    "depth_confidence.pfm",
    "disparity.pfm",
    "disparity.png",
    "disparity_confidence.pfm",
    "evidence.npz",
    "normals.npz",
    "normals.png",
    "normals_confidence.pfm",
    "points.ply",
    "profile.json",
    "report.html",
    "run.json",
    "surface.glb",
}
SHIFT, ROWS, COLUMNS = 5, 48, 64


class TestArtifacts:
    """The files of one run of ``stereo_sgm`` with a camera."""

    def test_all_are_there(self, former):
        """Everything that design §6 names and this graph can fill; and nothing else."""
        assert {file.name for file in former.iterdir()} - EVERYTHING <= {"match.pfm"}
        assert {file.name for file in former.iterdir()} >= EVERYTHING - {"evidence.npz"}

    def test_disparity_is_the_shift(self, former, files):
        """The wall was moved five pixels; where both cameras see it the map says so."""
        disparity = files.pfm(former / "disparity.pfm")
        assert disparity.shape == (ROWS, COLUMNS)
        seen = disparity[2:-2, SHIFT + 2 : -2]
        assert np.median(np.abs(seen - SHIFT)) < 0.1
        assert np.mean(np.abs(seen - SHIFT) < 0.5) > 0.98

    def test_kitti_is_disparity_times_256(self, former, files):
        disparity = files.pfm(former / "disparity.pfm")
        stored = cv2.imread(str(former / "disparity.png"), cv2.IMREAD_UNCHANGED)
        assert stored.dtype == np.uint16
        known = stored > 0
        np.testing.assert_allclose(stored[known] / 256, disparity[known], atol=0.51 / 256)
        assert np.array_equal(np.isfinite(disparity), known)

    def test_depth_follows_from_the_camera(self, former, files):
        """Z = f B / (d + doffs), with f = 100 px, B = 50 mm; unknown in PFM is inf, and confidence 0 there."""
        disparity, depth = (files.pfm(former / f"{name}.pfm") for name in ("disparity", "depth"))
        known = np.isfinite(disparity)
        np.testing.assert_allclose(depth[known], 100 * 50 / disparity[known], rtol=1e-5)
        assert np.isinf(depth[~known]).all()
        sure = files.pfm(former / "depth_confidence.pfm")
        assert ((sure >= 0) & (sure <= 1)).all()
        assert np.array_equal(sure == 0, ~known)

    def test_normals_face_the_camera(self, former):
        with np.load(former / "normals.npz", allow_pickle=False) as stored:
            assert list(stored) == ["normals", "normals.unit"]
            normals = stored["normals"]
        assert normals.shape == (ROWS, COLUMNS, 3)
        assert normals.dtype == np.float32
        known = np.isfinite(normals).all(axis=-1)
        assert known.mean() > 0.9
        np.testing.assert_allclose(np.linalg.norm(normals[known], axis=-1), 1, atol=1e-5)
        assert (normals[known][:, 2] < 0).all()

    def test_points_project_to_their_pixels(self, former, files):
        points = files.ply(former / "points.ply")
        depth = files.pfm(former / "depth.pfm")
        assert len(points) == np.isfinite(depth).sum()
        u = 100 * points["x"] / points["z"] + (COLUMNS - 1) / 2
        v = 100 * points["y"] / points["z"] + (ROWS - 1) / 2
        np.testing.assert_allclose(u, np.round(u), atol=1e-2)
        rows, columns = np.round(v).astype(int), np.round(u).astype(int)
        np.testing.assert_allclose(points["z"], depth[rows, columns], rtol=1e-4)

    def test_record_tells_where_it_comes_from(self, former, pair):
        record = json.loads((former / "run.json").read_text())
        assert record["visint"] == package.__version__
        assert record["graph"]["name"] == "stereo_sgm"
        assert len(record["graph_hash"]) == 64
        assert record["inputs"]["left"]["paths"] == [pair.left]
        assert record["inputs"]["camera"]["value"]["focal_length"] == 100
        assert {"kind": "Depth", "shape": [ROWS, COLUMNS]}.items() <= record["outputs"]["depth"].items()
        assert "stereo.sgm" in record["modules"]
        assert record["parameters"]["match"]["speckle"] == 100
        assert {"python", "numpy", "opencv-python-headless"} <= set(record["libraries"])
        assert set(record["files"]) == {file.name for file in former.iterdir()}
        assert record["seed"] == 0
        assert (record["stops"], record["warnings"]) == ([], [])

    def test_profile_times_each_node(self, former):
        profile = json.loads((former / "profile.json").read_text())
        assert [node["node"] for node in profile["nodes"]] == ["match"]
        assert 0 < profile["nodes"][0]["seconds"] <= profile["seconds"]

    def test_report_stands_alone(self, former):
        """One file: nothing is fetched from anywhere."""
        page = (former / "report.html").read_text()
        assert "stereo_sgm" in page
        assert "data:image/png;base64," in page
        assert not any(f'{attribute}="http' in page for attribute in ("src", "href"))


class TestTalk:
    """Data to stdout, talk to stderr."""

    def test_the_reports_path_is_all_of_stdout(self, visint, pair, tmp_path):
        done = visint("run", "stereo_sgm", *pair.all, "--out", "out")
        assert (done.code, done.out, done.err) == (0, f"{tmp_path / 'out' / 'report.html'}\n", "")

    def test_json(self, visint, pair, tmp_path):
        told = visint("run", "stereo_sgm", *pair.all, "--out", "out", "--json").json
        assert set(told["files"]) == {file.name for file in (tmp_path / "out").iterdir()}
        assert told["out"] == "out"
        assert told["seconds"] > 0
        assert told["warnings"] == []

    def test_quiet_says_nothing(self, visint, pair):
        assert visint("run", "stereo_sgm", *pair.images, "--out", "out", "-q") == (0, "", "")

    def test_verbose_says_what_each_node_took(self, visint, pair):
        done = visint("run", "stereo_sgm", *pair.all, "--out", "out", "-v")
        assert done.err.split()[:3] == ["match", "level", "0"]
        assert len(done.out.splitlines()) == 1


class TestOptions:
    """What each option turns."""

    def test_set_changes_a_parameter(self, visint, pair, tmp_path, files):
        done = visint("run", "stereo_sgm", *pair.all, "--out", "out", "--set", "match.max_disparity=4")
        assert done.code == 0
        assert json.loads((tmp_path / "out/run.json").read_text())["parameters"]["match"]["max_disparity"] == 4
        disparity = files.pfm(tmp_path / "out" / "disparity.pfm")
        assert disparity[np.isfinite(disparity)].max() < SHIFT

    def test_without_calibration_depth_is_relative_and_says_so(self, visint, pair, tmp_path, files):
        """f is the images' width and the baseline 1: a stand-in, and no unit in any file."""
        done = visint("run", "stereo_sgm", *pair.images, "--disparity-range", "0,15", "--out", "out")
        assert done.code == 0
        assert "[relative_depth]" in done.err
        disparity, depth = (files.pfm(tmp_path / "out" / f"{name}.pfm") for name in ("disparity", "depth"))
        known = np.isfinite(depth)
        np.testing.assert_allclose(depth[known], COLUMNS / disparity[known], rtol=1e-5)
        record = json.loads((tmp_path / "out/run.json").read_text())
        assert record["inputs"]["camera"]["value"]["unit"] == "relative"
        assert [warned["code"] for warned in record["warnings"]] == ["relative_depth"]
        assert "relative" in (tmp_path / "out/report.html").read_text()

    def test_without_any_camera_there_is_disparity_alone_and_it_says_why(self, visint, pair, tmp_path):
        done = visint("run", "stereo_sgm", *pair.images, "--out", "out")
        assert done.code == 0
        assert "--disparity-range" in done.err
        assert not (tmp_path / "out/depth.pfm").exists()
        assert (tmp_path / "out/disparity.pfm").exists()

    def test_disparity_range_goes_before_the_calibrations(self, visint, pair, tmp_path):
        visint("run", "stereo_sgm", *pair.all, "--disparity-range", "2,9", "--out", "out")
        camera = json.loads((tmp_path / "out/run.json").read_text())["inputs"]["camera"]
        assert camera["value"]["disparity_range"] == [2, 9]
        assert camera["value"]["unit"] == "mm"

    def test_trace_is_a_timeline(self, visint, pair, tmp_path):
        """Chrome's trace events, in a folder of its own or in the run's."""
        for name in ("t.json", "out/t.json"):
            assert visint("run", "stereo_sgm", *pair.all, "--out", "out", "--trace", name).code == 0
            events = json.loads((tmp_path / name).read_text())["traceEvents"]
            assert [(event["name"], event["ph"]) for event in events] == [("match", "X")]
            assert all(
                isinstance(event[key], int | float) for event in events for key in ("ts", "dur", "pid", "tid")
            )

    def test_stop_after(self, visint, pair, tmp_path):
        graph = {
            "visint": 1,
            "name": "two",
            "inputs": {"left": "Image", "right": "Image", "camera": "Camera"},
            "nodes": {
                "match": {"uses": "stereo.sgm", "in": {"left": "inputs.left", "right": "inputs.right"}},
                "depth": {
                    "uses": "stereo.depth",
                    "in": {"disparity": "match.disparity", "camera": "inputs.camera"},
                },
            },
            "outputs": {"disparity": "match.disparity", "mine": "depth.depth"},
        }
        (tmp_path / "two.json").write_text(json.dumps(graph))
        assert visint("run", "two.json", *pair.all, "--out", "out", "--stop-after", "match").code == 0
        profile = json.loads((tmp_path / "out/profile.json").read_text())
        assert [node["node"] for node in profile["nodes"]] == ["match"]
        assert not (tmp_path / "out/mine.pfm").exists()
        assert (tmp_path / "out/disparity.pfm").exists()

    def test_in_names_any_input(self, visint, pair, tmp_path, former, files):
        """``--left`` is short for ``--in left=``; paths may be relative."""
        link = tmp_path / "here"
        link.symlink_to(pair.folder)
        inputs = ["--in", "left=here/left.png", "--in", "right=here/right.png", "--in", "camera=here/calib.txt"]
        assert visint("run", "stereo_sgm", *inputs, "--out", "out").code == 0
        assert (tmp_path / "out/disparity.pfm").read_bytes() == (former / "disparity.pfm").read_bytes()

    def test_gamma_1_leaves_values_alone(self, visint, pair, tmp_path):
        """What arrives is 8-bit over 255; without it the sRGB curve is undone."""
        seen = cv2.imread(pair.left, cv2.IMREAD_UNCHANGED).astype(np.float32) / 255
        digests = {}
        for name, options in {"linear": ["--gamma", 1], "curved": []}.items():
            visint("run", "stereo_sgm", *pair.all, "--out", name, *options)
            digests[name] = json.loads((tmp_path / name / "run.json").read_text())["inputs"]["left"]
        package.run("stereo_sgm", left=seen, right=seen).save(tmp_path / "python")
        python = json.loads((tmp_path / "python/run.json").read_text())["inputs"]["left"]
        assert digests["linear"]["sha256"] == python["sha256"] != digests["curved"]["sha256"]
        assert digests["linear"]["gamma"] == 1

    def test_threads_and_seed(self, visint, pair, tmp_path, former, files):
        """Side by side the same bytes; the seed is on record."""
        visint("run", "stereo_sgm", *pair.all, "--out", "out", "--threads", 2)
        same = {"profile.json", "report.html"}
        ours, theirs = files.contents(tmp_path / "out"), files.contents(former)
        assert {name for name in theirs if ours.get(name) != theirs[name]} <= same
        visint("run", "stereo_sgm", *pair.all, "--out", "seeded", "--seed", 7)
        assert json.loads((tmp_path / "seeded/run.json").read_text())["seed"] == 7

    def test_colour_and_16_bits_are_read(self, visint, pair, tmp_path, files):
        """A grey picture in RGBA tells that alpha is dropped, and gives the same disparity."""
        grey = cv2.imread(pair.left, cv2.IMREAD_UNCHANGED)
        cv2.imwrite(str(tmp_path / "l.png"), cv2.merge([grey, grey, grey, np.full_like(grey, 200)]))
        images = ["--left", "l.png", "--right", pair.right, "--calib", pair.calib]
        done = visint("run", "stereo_sgm", *images, "--out", "out")
        assert done.code == 0
        assert "alpha" in done.err
        disparity = files.pfm(tmp_path / "out" / "disparity.pfm")
        assert np.median(np.abs(disparity[:, 8:] - SHIFT)) < 0.1


class TestFolder:
    """Whose folder a run may take."""

    def test_another_persons_folder_is_refused_before_the_work(self, visint, pair, tmp_path, monkeypatch):
        (tmp_path / "mine").mkdir()
        (tmp_path / "mine" / "thesis.txt").write_text("years of work")
        monkeypatch.setattr(package, "run", None, raising=False)
        monkeypatch.setattr("visint.engine.sources.read_sources", None)
        done = visint("run", "stereo_sgm", *pair.all, "--out", "mine")
        assert done.code == 5
        assert done.err.startswith("VI602")
        assert "--force" in done.err
        assert [file.name for file in (tmp_path / "mine").iterdir()] == ["thesis.txt"]

    def test_force_keeps_what_is_in_it(self, visint, pair, tmp_path):
        (tmp_path / "mine").mkdir()
        (tmp_path / "mine" / "thesis.txt").write_text("years of work")
        assert visint("run", "stereo_sgm", *pair.all, "--out", "mine", "--force").code == 0
        assert (tmp_path / "mine/thesis.txt").read_text() == "years of work"
        assert (tmp_path / "mine/depth.pfm").exists()

    def test_a_second_run_takes_the_place_of_the_first(self, visint, pair, tmp_path):
        """Its files go; a note that the user put there stays."""
        visint("run", "stereo_sgm", *pair.all, "--out", "out")
        (tmp_path / "out" / "note.txt").write_text("good one")
        assert visint("run", "stereo_sgm", *pair.images, "--out", "out").code == 0
        assert not (tmp_path / "out/depth.pfm").exists()
        assert (tmp_path / "out/note.txt").exists()

    def test_folders_are_made_on_the_way(self, visint, pair, tmp_path):
        assert visint("run", "stereo_sgm", *pair.all, "--out", "a/b/c").code == 0
        assert (tmp_path / "a/b/c/depth.pfm").exists()


class TestAnyInput:
    """Inputs that are no files."""

    GRAPH = """visint: 1
name: sum
inputs: {a: Scalar, b: Scalar?}
nodes: {n: {uses: toy.noise, in: {value: inputs.a}}}
outputs: {n: n.value}
"""

    def test_numbers_by_in(self, visint, toys, tmp_path):
        (tmp_path / "sum.yaml").write_text(self.GRAPH)
        done = visint("run", "sum.yaml", "--in", "a=2.5", "--out", "out", "--set", "n.sigma=0")
        assert done.code == 0, done
        record = json.loads((tmp_path / "out/run.json").read_text())
        assert record["inputs"]["a"]["value"] == 2.5
        assert record["outputs"]["n"]["value"] == 2.5
        assert visint("run", "out/run.json", "--out", "again").code == 0
        assert (tmp_path / "again/run.json").read_bytes() == (tmp_path / "out/run.json").read_bytes()

    @pytest.mark.parametrize("seed", [0, 1])
    def test_seed_turns_the_noise(self, visint, toys, tmp_path, seed):
        """Equal seeds, equal numbers; and ``run.json`` takes another one."""
        (tmp_path / "sum.yaml").write_text(self.GRAPH)

        def noise(graph, out, *options):
            assert visint("run", graph, "--in", "a=0", "--out", out, *options).code == 0
            return json.loads((tmp_path / out / "run.json").read_text())["outputs"]["n"]["value"]

        first = noise("sum.yaml", "one", "--seed", seed)
        assert first == noise("sum.yaml", "two", "--seed", seed)
        assert first == noise("one/run.json", "three")
        assert first != noise("one/run.json", "four", "--seed", 5)

    def test_light(self, visint, toys, tmp_path):
        """``x,y,z`` typed for a Light is no path."""
        text = self.GRAPH.replace("b: Scalar?", "light: Light?")
        (tmp_path / "sum.yaml").write_text(text)
        for option, value in [("--light", "0,0,-2"), ("--in", "light=0,0,-2"), ("--light-at", "1,2,3")]:
            assert visint("run", "sum.yaml", "--in", "a=1", option, value, "--out", "out").code == 0
            assert json.loads((tmp_path / "out/run.json").read_text())["inputs"]["light"]["text"].endswith(
                value[-5:]
            )


class TestLists:
    """An input that is a list of images."""

    @pytest.fixture(autouse=True)
    def graph(self, toys, tmp_path, pair):
        (tmp_path / "many.yaml").write_text(
            "visint: 1\nname: many\ninputs: {images: [Image]}\n"
            "nodes: {mean: {uses: toy.stack, in: {images: inputs.images}}}\noutputs: {mean: mean.image}\n"
        )
        cv2.imwrite(str(tmp_path / "low.png"), cv2.imread(pair.left)[:30])

    def test_in_is_given_again_and_again(self, visint, pair, tmp_path):
        """In the order of the command line, on record and when run again."""
        files = [pair.left, pair.right, pair.left]
        inputs = [word for file in files for word in ("--in", f"images={file}")]
        assert visint("run", "many.yaml", *inputs, "--out", "out").code == 0
        record = json.loads((tmp_path / "out/run.json").read_text())
        assert record["inputs"]["images"]["paths"] == files
        assert visint("run", "out/run.json", "--out", "again").code == 0
        assert (tmp_path / "again/mean.pfm").read_bytes() == (tmp_path / "out/mean.pfm").read_bytes()

    def test_sizes_must_agree(self, refused, pair):
        """The one that differs is named by its place in the list, from 0."""
        inputs = ["--in", f"images={pair.left}", "--in", "images=low.png"]
        said = refused(3, "run", "many.yaml", *inputs, "--out", "out")
        assert "'images[0]' and 'images[1]' are of different sizes: 64 × 48 and 64 × 30" in said


def test_python_gives_the_same_bytes(visint, pair, tmp_path, former, files):
    """The graph built in code, on the same files, saved from Python: every map byte for byte."""
    g = package.Builder("stereo_sgm", left="Image", right="Image", camera="Camera?")
    match = g.add("match", "stereo.sgm", left=g.left, right=g.right, camera=g.camera)
    inputs = {"left": io.read_image(pair.left), "right": io.read_image(pair.right)}
    graph = g.outputs(disparity=match.disparity)
    package.run(graph, inputs, camera=io.read_camera(pair.calib)).save(tmp_path / "python")
    ours, theirs = files.contents(tmp_path / "python"), files.contents(former)
    assert set(ours) == set(theirs)
    different = {name for name in ours if ours[name] != theirs[name]}
    assert different <= {"profile.json", "report.html", "run.json"}
    records = [json.loads(each["run.json"]) for each in (ours, theirs)]
    assert records[0]["graph"]["nodes"] == records[1]["graph"]["nodes"]
    assert records[0]["outputs"] == records[1]["outputs"]
