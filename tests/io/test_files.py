"""Files as bytes and text: each failure one line that names the file and what is wrong."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

import numpy as np
import pytest

import visint.io
from visint.errors import InputError

READERS = {
    "bytes": visint.io.read_bytes,
    "text": visint.io.read_text,
    "json": visint.io.read_json,
    "image": visint.io.read_image,
    "raster": visint.io.read_raster,
    "camera": visint.io.read_camera,
    "npz": visint.io.read_npz,
    "digest": visint.io.digest,
}


def refusal(read, path):
    with pytest.raises(InputError) as caught:
        read(path)
    (problem,) = caught.value.problems
    assert "\n" not in str(problem.where) + problem.found
    return problem


@pytest.mark.parametrize("reader", READERS)
def test_what_is_no_file_is_named(tmp_path, reader):
    """Missing, a folder, a pipe, a path through a file, a name with a NUL, a name that is too long."""
    read = READERS[reader]
    (tmp_path / "plain").write_text("x")
    os.mkfifo(tmp_path / "pipe")
    for name, words in {
        "absent.png": "no such file",
        ".": "is a folder; wants a file",
        "pipe": "a device or a pipe",
        "plain/below.png": "a part of its path is a file",
        "nul\0.png": "no file name has",
        "long" * 100: "too long",
    }.items():
        problem = refusal(read, f"{tmp_path}/{name}")
        assert problem.code == "VI301"
        assert words in problem.found
    assert refusal(read, "/dev/zero").code == "VI301"


@pytest.mark.parametrize("reader", ["bytes", "image", "camera", "json"])
def test_denied_permission_is_named(monkeypatch, put, reader):
    """As the system words it; tests may run as root, who is never denied."""

    def deny(self, *args, **more):
        raise PermissionError(13, "Permission denied")

    path = put(b"x")
    monkeypatch.setattr(Path, "open", deny)
    problem = refusal(READERS[reader], path)
    assert problem.code == "VI301"
    assert "permission denied" in problem.found


def test_a_near_name_is_offered(put):
    """A typing mistake is met with the file that is there."""
    path = put(b"x", "left.png")
    assert "left.png" in refusal(visint.io.read_image, path.with_name("lefft.png")).choices


def test_names_stay_on_one_line(tmp_path):
    """A line feed, an escape or a byte that is no text in a name is spelled out in the message."""
    for name in ("two\nlines", "\x1b[31mred", "byte\udcff"):
        problem = refusal(visint.io.read_bytes, tmp_path / name)
        assert problem.where.file.isprintable()
        problem.where.file.encode()


def test_empty_and_too_large_files(put):
    """Nothing is no image; more than the limit is not read."""
    assert refusal(visint.io.read_image, put(b"")).code == "VI302"
    assert refusal(lambda path: visint.io.read_bytes(path, most=9), put(bytes(10))).code == "VI303"
    assert visint.io.read_bytes(put(bytes(10)), most=10) == bytes(10)


def test_a_sparse_giant_is_refused_without_reading_it(tmp_path):
    """Terabytes by its size alone."""
    path = tmp_path / "giant"
    with path.open("wb") as file:
        file.truncate(1 << 40)
    assert refusal(visint.io.read_image, path).code == "VI303"


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"hello world\n", "is text"),
        (b"II+\0" + bytes(20), "BigTIFF"),
        (b"MM\0+" + bytes(20), "BigTIFF"),
        (b"GIF89a", "GIF"),
        (b"BM" + bytes(60), "BMP"),
        (b"RIFF\0\0\0\0WEBP", "WebP"),
        (b"v/1\x01", "OpenEXR"),
        (b"\x89HDF\r\n", "HDF5"),
        (b"MATLAB 5.0", "MATLAB"),
        (b"%PDF-1.7", "PDF"),
        (b"\x1f\x8b\x08", "gzip"),
        (b"\x89PNG\n\x1a\n", "text-mode"),
        (bytes(100), "no format that visint knows"),
        (b"#!/bin/sh\nrm -rf x\n", "is text"),
        (b"<svg xmlns='x'/>", "is text"),
    ],
)
def test_other_formats_are_named_whatever_the_suffix(put, data, words):
    """By content: a text file named .png is text. Nothing is read that merely happens to decode."""
    problem = refusal(visint.io.read_image, put(data, "named.png"))
    assert problem.code == "VI302"
    assert words in problem.found
    assert "PNG, JPEG, PGM/PPM, TIFF, PFM, npy, npz" in problem.choices


def test_content_counts_and_not_the_suffix(make, put):
    """A PNG named .jpg is read."""
    assert visint.io.read_image(put(make.png(np.zeros((2, 3), np.uint8)), "a.jpg")).shape == (2, 3)


def test_text_is_utf8_without_its_mark(put):
    """The byte order mark goes, line ends stay."""
    assert visint.io.read_text(put("\ufeffä\r\nb")) == "ä\r\nb"


@pytest.mark.parametrize(("data", "line"), [(b"a\nb\xff", 2), (b"\xff\xfea\0", 1), (b"a\nb\nc\0", 3)])
def test_what_is_no_text_is_named_with_its_line(put, data, line):
    """Another encoding, or bytes."""
    problem = refusal(visint.io.read_text, put(data))
    assert (problem.code, problem.where.line) == ("VI302", line)


@pytest.mark.parametrize(
    "text",
    ["{", '{"a": }', "[" * 100_000, "nope", "[" + "1" * 10_000 + "]"],
    ids=["open", "value", "deep", "word", "long"],
)
def test_what_is_no_json_is_refused(put, text):
    """Broken, too deep or too long a number: one line each."""
    assert refusal(visint.io.read_json, put(text)).code == "VI302"


def test_json_mistakes_have_line_and_column(put):
    """As an editor counts them."""
    where = refusal(visint.io.read_json, put('{"a": 1,\n "b" 2}')).where
    assert (where.line, where.column) == (2, 6)
    assert visint.io.read_json(put('{"a": [1, null]}')) == {"a": [1, None]}


def test_digest_is_sha256(put):
    """Of any file, empty ones too."""
    for data in (b"", b"abc" * 1000):
        assert visint.io.digest(put(data)) == hashlib.sha256(data).hexdigest()


def test_files_of_a_folder_by_name(tmp_path, put):
    """Files alone, sorted, with the suffixes asked for."""
    for name in ("b.yaml", "a.yaml", "c.json"):
        put(b"", name)
    (tmp_path / "d.yaml").mkdir()
    assert [path.name for path in visint.io.files_in(tmp_path, ".yaml")] == ["a.yaml", "b.yaml"]
    assert len(visint.io.files_in(tmp_path)) == 3
    assert refusal(visint.io.files_in, tmp_path / "absent").code == "VI301"
