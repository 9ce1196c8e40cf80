"""Middlebury calibration: the camera it means, and every wrong line named."""

from __future__ import annotations

import pytest

import visint.io
from visint.errors import InputError

GOOD = {
    "cam0": "[100 0 20; 0 100 15; 0 0 1]",
    "cam1": "[100 0 23.5; 0 100 15; 0 0 1]",
    "doffs": "3.5",
    "baseline": "160.5",
    "width": "40",
    "height": "30",
    "ndisp": "64",
    "isint": "0",
    "vmin": "5",
    "vmax": "50",
    "dyavg": "0",
    "dymax": "0",
}


def sheet(**changes):
    entries = {**GOOD, **changes}
    return "\n".join(f"{key}={value}" for key, value in entries.items() if value is not None) + "\n"


def test_every_number_finds_its_place(put):
    """f, cx, cy from cam0; doffs, baseline in mm; rows and columns; the bounds of the disparity."""
    camera = visint.io.read_camera(put(sheet(), "calib.txt"))
    assert (camera.focal_length, camera.cx, camera.cy) == (100, 20, 15)
    assert (camera.baseline, camera.unit, camera.doffs) == (160.5, "mm", 3.5)
    assert camera.size == (30, 40)
    assert camera.disparity_range == (5, 50)


def test_what_is_absent_follows_from_the_rest(put):
    """doffs from the two matrices; the search range from ndisp, or none."""
    assert visint.io.read_camera(put(sheet(doffs=None))).doffs == 3.5
    assert visint.io.read_camera(put(sheet(cam1=None))).doffs == 3.5
    assert visint.io.read_camera(put(sheet(vmin=None))).disparity_range == (0, 63)
    assert visint.io.read_camera(put(sheet(vmin=None, ndisp=None))).disparity_range is None


def test_converging_rigs_keep_their_negative_numbers(put):
    """vmin and doffs may be below zero."""
    text = sheet(vmin="-20", doffs="-4", cam1="[100 0 16; 0 100 15; 0 0 1]")
    camera = visint.io.read_camera(put(text))
    assert camera.disparity_range == (-20, 50)
    assert camera.doffs == -4


@pytest.mark.parametrize(
    "text",
    [
        sheet().replace("=", " = ").replace("\n", "  \r\n"),
        "\n\n" + sheet().replace("\n", "\n\n"),
        sheet().replace("[", "[ ").replace(";", " ; ").replace("]", " ]"),
        "\ufeff" + sheet(),
        "\n".join(reversed(sheet().splitlines())),
        sheet() + "future=something else\n",
    ],
    ids=["spaces", "blank lines", "wide", "byte order mark", "reversed", "unknown names"],
)
def test_spelling_does_not_matter(put, text):
    """Spaces, blank lines, line ends and order are as they please."""
    assert visint.io.read_camera(put(text)) == visint.io.read_camera(put(sheet()))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"cam0": None}, "cam0: is missing"),
        ({"baseline": None}, "baseline: is missing"),
        ({"width": None}, "width: is missing"),
        ({"height": None}, "height: is missing"),
        ({"doffs": None, "cam1": None}, "doffs: is missing, and so is cam1"),
        ({"baseline": "abc"}, ":4:1 baseline: is 'abc'; wants a number above 0"),
        ({"baseline": "-3"}, "wants a number above 0"),
        ({"baseline": "0"}, "wants a number above 0"),
        ({"baseline": "nan"}, "wants a number above 0"),
        ({"baseline": "1_0"}, "wants a number above 0"),
        ({"baseline": ""}, "wants a number above 0"),
        ({"doffs": "inf"}, "doffs: is 'inf'; wants a number"),
        ({"doffs": "1e999"}, "wants a number"),
        ({"width": "40.5"}, ":5:1 width: is '40.5'; wants a whole number above 0"),
        ({"height": "0"}, "wants a whole number above 0"),
        ({"ndisp": "many"}, "wants a whole number above 0"),
        ({"vmin": "60"}, "wants vmin below vmax"),
        ({"cam0": "[100 0 20; 0 100 15]"}, ":1:1 cam0: wants a 3 × 3 matrix"),
        ({"cam0": "[100 0 20 0 100 15 0 0 1]"}, "wants a 3 × 3 matrix"),
        ({"cam0": "[a 0 20; 0 100 15; 0 0 1]"}, "wants a 3 × 3 matrix"),
        ({"cam0": ""}, "wants a 3 × 3 matrix"),
        ({"cam0": "[100 0 20; 0 90 15; 0 0 1]"}, "focal lengths 100 and 90; wants square pixels"),
        ({"cam0": "[-100 0 20; 0 -100 15; 0 0 1]"}, "above 0"),
        ({"cam0": "[100 2 20; 0 100 15; 0 0 1]"}, "without skew"),
        ({"cam0": "[100 0 20; 0 100 15; 0 0 2]"}, "wants the form"),
        ({"cam1": "[90 0 23.5; 0 90 15; 0 0 1]"}, "cam1: has another focal length"),
        ({"cam1": "[100 0 23.5; 0 100 19; 0 0 1]"}, "wants a rectified pair"),
        ({"doffs": "9"}, "doffs: is 9, but cam1's cx less cam0's is 3.5"),
    ],
)
def test_each_mistake_is_named_with_its_line(put, changes, words):
    """Where it stands, what was found, what was wanted."""
    with pytest.raises(InputError, match=words) as caught:
        visint.io.read_camera(put(sheet(**changes), "calib.txt"))
    assert {problem.code for problem in caught.value.problems} == {"VI306"}
    assert "calib.txt" in str(caught.value)


def test_all_mistakes_are_told_together(put):
    """Three wrong lines, three problems."""
    with pytest.raises(InputError) as caught:
        visint.io.read_camera(put(sheet(baseline="x", width="y", cam0="z")))
    assert [problem.where.path for problem in caught.value.problems] == ["cam0", "baseline", "width"]


def test_a_name_that_stands_twice_is_refused(put):
    """Both lines are named."""
    with pytest.raises(InputError, match="stands twice: first on line 4, again on line 13"):
        visint.io.read_camera(put(sheet() + "baseline=3\n"))


@pytest.mark.parametrize("text", ["hello\nworld\n", "{}\n", "a = [1\nb\n"])
def test_another_sort_of_file_is_refused_in_one_line(put, text):
    """Text that is no calibration: the first line that cannot be one."""
    with pytest.raises(InputError, match="wants name=value"):
        visint.io.read_camera(put(text))


def test_xml_is_refused_by_name(put):
    """OpenCV's other format: how to write the one that is read."""
    with pytest.raises(InputError, match=r"is XML[\s\S]*\.yml"):
        visint.io.read_camera(put("<?xml version='1.0'?><opencv_storage></opencv_storage>"))


@pytest.mark.parametrize(
    "data", [b"", b"\xff\xfe\0", b"cam0=\0", b"x" * 100_000], ids=["empty", "utf16", "nul", "long"]
)
def test_files_that_are_no_text_are_refused(put, data):
    """By the checks of every text file."""
    with pytest.raises(InputError, match=r"VI30[23]"):
        visint.io.read_camera(put(data))
