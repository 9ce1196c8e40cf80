"""Another run to compare with: what is read back, how maps differ, what a folder from anywhere cannot do."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from visint.errors import InputError
from visint.results.against import read_against
from visint.results.report import report
from visint.results.report.differences import difference


def boxed(*rows):
    return np.array(rows, np.float32)


class TestDifference:
    """From values known beforehand."""

    def test_equal_maps_are_said_to_be(self):
        one = boxed([1, np.nan], [2, 3])
        found = difference("Depth", one, one.copy(), "mm")
        assert found.figures == {"difference": "none: equal to the last bit"}
        assert found.picture is None

    def test_numbers(self):
        """+1, −1, +3 where both are known; one pixel only here, one only there."""
        here, there = boxed([2, 1, 5, 9, np.nan]), boxed([1, 2, 2, np.nan, 4])
        found = difference("Depth", here, there, "mm")
        assert found.figures == {
            "median of |difference|": "1 mm",
            "mean difference": "1 mm",
            "root mean square": "1.915 mm",  # √(11/3)
            "95th percentile of |difference|": "2.8 mm",
            "known here alone": "20 %",
            "known there alone": "20 %",
        }
        red, blue, _, unknown, _ = found.picture[0].astype(int)
        assert red[0] > red[2]  # more than there: towards red
        assert blue[2] > blue[0]
        assert len(set(unknown)) == 1

    def test_nothing_in_common(self):
        found = difference("Depth", boxed([1, np.nan]), boxed([np.nan, 1]), "mm")
        assert found.figures["difference"] == "nothing is known in both"

    def test_normals_by_their_angle(self):
        """Half of them turned by 60°."""
        here = np.zeros((2, 4, 3), np.float32)
        here[..., 2] = -1
        there = here.copy()
        there[0] = [0, np.sqrt(0.75), -0.5]
        figures = difference("Normals", here, there, "1").figures
        assert (figures["median angle"], figures["mean angle"]) == ("30°", "30°")

    def test_boundaries_in_both_and_in_one(self):
        here, there = np.array([[1, 1, 0, 0]], bool), np.array([[1, 0, 1, 0]], bool)
        found = difference("Boundaries", here, there, "1")
        assert found.figures == {"in both": "25 %", "here alone": "25 %", "there alone": "25 %"}
        assert found.picture[0].tolist() == [[255, 255, 255], [178, 24, 43], [33, 102, 172], [0, 0, 0]]

    def test_regions_by_their_number(self):
        here, there = np.array([[1, 2, 0]], np.int32), np.array([[1, 1, 0]], np.int32)
        assert difference("Regions", here, there, "1").figures == {"regions here": "2", "regions there": "1"}


@pytest.fixture(scope="module")
def before(met, tmp_path_factory):
    """The folder of a run whose depth was half a millimetre less, but for the last bits."""
    folder = tmp_path_factory.mktemp("runs") / "before"
    depth = met["depth"] - np.float32(0.5)
    dataclasses.replace(met, outputs={**met.outputs, "depth": depth}).save(folder)
    return folder


class TestSection:
    def test_figures_and_difference_maps(self, met, before, toys):
        page = report(met, read_against(before))
        assert "Compared with another run" in page
        assert "0.5 mm" in page
        assert "Difference of depth: median of |difference| 0.5 mm" in page
        assert page.count("equal to the last bit") >= 3  # normals, boundaries, regions
        assert any(alt.startswith("Difference of depth") for alt, _ in toys.pictures(page))

    def test_parameters_that_differ(self, met, before, tmp_path):
        record = json.loads((before / "run.json").read_text())
        record["parameters"]["shade"]["near"] = 123.0
        other = tmp_path / "other"
        other.mkdir()
        (other / "run.json").write_text(json.dumps(record))
        page = report(met, read_against(other))
        assert "<code>shade.near</code></th><td>700.0</td><td>123.0</td>" in page
        assert "match.near" not in page.partition('id="inputs"')[0]

    def test_outputs_of_one_alone_and_of_other_sizes(self, met, toys, tmp_path):
        image = toys.scene(8, 9)
        toys.run(toys.CUE, image=image, camera=toys.camera((8, 9))).save(tmp_path / "small")
        page = report(met, read_against(tmp_path / "small"))
        assert "48 × 64 here, 8 × 9 there: not compared" in page
        assert "there is no such output there" in page
        assert "there is no such output here" not in page

    def test_without_another_run_there_is_no_section(self, met):
        assert "Compared with another run" not in report(met)

    def test_a_run_saved_against_itself(self, met, tmp_path):
        """The folder that is written may be the one that is compared with."""
        met.save(tmp_path / "out")
        met.save(tmp_path / "out", against=tmp_path / "out")
        assert "equal to the last bit" in (tmp_path / "out/report.html").read_text()


class TestSpoilt:
    """A folder is data from anywhere."""

    @pytest.mark.parametrize(
        "record", [[], {}, {"graph": {}, "outputs": [], "parameters": {}}, {"graph": 1, "outputs": {}}]
    )
    def test_no_record(self, tmp_path, record):
        (tmp_path / "run.json").write_text(json.dumps(record))
        with pytest.raises(InputError, match=r"VI302.*no run record"):
            read_against(tmp_path)

    def test_no_folder(self, tmp_path):
        with pytest.raises(InputError, match="VI301"):
            read_against(tmp_path / "nowhere")

    @pytest.mark.parametrize("name", ["../secret", "/etc/passwd", "a/b", "", ".hidden"])
    def test_names_that_lead_out_of_the_folder(self, tmp_path, name):
        """They name no file, whatever lies there."""
        (tmp_path / "secret.pfm").write_bytes(b"Pf\n1 1\n-1\n\0\0\0\0")
        inside = tmp_path / "run"
        inside.mkdir()
        told = {"graph": {}, "outputs": {name: {"kind": "Depth"}, "x": 3, "y": {"kind": []}}, "parameters": {}}
        (inside / "run.json").write_text(json.dumps(told))
        assert read_against(inside).maps == {}

    def test_a_map_that_is_broken(self, before, tmp_path):
        (tmp_path / "run.json").write_text((before / "run.json").read_text())
        (tmp_path / "depth.pfm").write_bytes(b"Pf\n64 48\n-1\n")
        with pytest.raises(InputError, match=r"depth\.pfm"):
            read_against(tmp_path)
