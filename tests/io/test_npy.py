"""npy and npz: never unpickled, sizes checked first, the same arrays give the same bytes."""

from __future__ import annotations

import io
import os
import zipfile

import numpy as np
import pytest

import visint.io
from visint.errors import InputError, OutputError

F4 = "{'descr': '<f4', 'fortran_order': False, 'shape': %s, }"


class Trap:
    """An object whose unpickling would be seen."""

    def __reduce__(self):
        return os.mkdir, ("unpickled",)


@pytest.mark.parametrize("dtype", ["<f4", ">f4", "<f2", "<f8"])
@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("size", [(1, 1), (1, 4), (4, 1), (3, 5)], ids=str)
def test_every_float_becomes_float32_in_c_order(make, put, rng, dtype, order, size):
    """Byte order, precision and memory order of the file are gone; the values stay."""
    values = np.array(rng.integers(-8, 8, size) / 4, dtype=dtype, order=order)
    read = visint.io.read(put(make.stored(values)), "Depth")
    np.testing.assert_array_equal(read, values)
    assert read.dtype == np.float32
    assert read.flags.c_contiguous
    assert not read.flags.writeable


def test_rounding_is_told_and_overflow_refused(make, put):
    """float64 is rounded to float32 with a note, unless that makes it infinite."""
    notes: list[str] = []
    read = visint.io.read(put(make.stored(np.array([[0.1]]))), "Depth", note=notes.append)
    assert read[0, 0] == np.float32(0.1)
    assert "rounded" in notes[0]
    with pytest.raises(InputError, match="beyond float32"):
        visint.io.read(put(make.stored(np.array([[1e300]]))), "Depth")


def test_objects_are_never_unpickled(make, put, tmp_path, monkeypatch):
    """A pickle in an npy or npz file is refused by its header."""
    monkeypatch.chdir(tmp_path)
    trap = np.array([[Trap()]], dtype=object)
    for data in (make.stored(trap), make.zipped(depth=make.stored(trap))):
        with pytest.raises(InputError, match="holds objects"):
            visint.io.read(put(data), "Depth")
    assert not (tmp_path / "unpickled").exists()


@pytest.mark.parametrize(
    ("header", "body", "words"),
    [
        (F4 % "(1000000000000, 1)", b"", "VI303"),
        (F4 % "(2, 2)", bytes(15), "holds 15 bytes of values where its npy header claims 16"),
        (F4 % "(2, 2)", bytes(17), "holds 17 bytes"),
        (F4 % "(-2, -2)", bytes(16), "no such shape"),
        (F4 % "(True, 4)", bytes(16), "no such shape|damaged"),
        (F4 % "(2.0, 2)", bytes(16), "damaged npy header"),
        (F4 % str((1,) * 40), bytes(4), "no such shape|damaged"),
        (F4 % str(10**400), b"", "damaged npy header"),
        (F4 % "()", bytes(4), "shape"),
        (F4 % "(0, 5)", b"", "is empty"),
        ("{'descr': '|O', 'fortran_order': False, 'shape': (1, 1), }", bytes(8), "objects"),
        ("{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (1, 1), }", bytes(4), "plain numbers"),
        ("{'descr': '<U4', 'fortran_order': False, 'shape': (1, 1), }", bytes(16), "plain numbers"),
        ("{'descr': '<M8[s]', 'fortran_order': False, 'shape': (1, 1), }", bytes(8), "plain numbers"),
        ("{'descr': ('<f4', (1000000,)), 'fortran_order': False, 'shape': (1, 1), }", b"", "plain|damaged"),
        ("{'descr': '<f4', 'fortran_order': False}", b"", "damaged npy header"),
        ("__import__('os').mkdir('x')", b"", "damaged npy header"),
        ("(" * 5000 + ")" * 5000, b"", "damaged npy header"),
        ("[" * 300 + "]" * 300, b"", "damaged npy header"),
        ("{'descr': '<f4'," + " " * 20000, b"", "damaged npy header"),
        ("", b"", "damaged npy header"),
    ],
)
@pytest.mark.parametrize("version", [1, 2])
def test_hostile_headers_are_refused_in_words(make, put, header, body, words, version):
    """A header that lies, that is no literal, or that is of another sort; nothing is allocated for it."""
    with pytest.raises(InputError, match=words):
        visint.io.read(put(make.npy(header, body, version)), "Depth")


@pytest.mark.parametrize("data", [b"\x93NUMPY", b"\x93NUMPY\x01\x00", b"\x93NUMPY\x09\x00" + bytes(80)])
def test_cut_headers_and_unknown_versions_are_refused(put, data):
    """As any damaged header."""
    with pytest.raises(InputError, match="damaged npy header"):
        visint.io.read(put(data), "Depth")


def test_npz_gives_the_array_named_like_the_kind_or_the_only_one(make, put):
    """``depth`` for a Depth among others; any name if it is alone; else the names are listed."""
    one, two = np.ones((2, 3), np.float32), np.full((2, 3), 2, np.float32)
    assert visint.io.read(put(make.stored(None, depth=two, sigma=one)), "Depth")[0, 0] == 2
    assert visint.io.read(put(make.stored(None, whatever=two)), "Depth")[0, 0] == 2
    with pytest.raises(InputError, match=r"no array 'depth'[\s\S]*arrays in it: a, b"):
        visint.io.read(put(make.stored(None, a=one, b=two)), "Depth")


def test_npz_round_trip_is_exact_and_numpy_reads_it(put, rng):
    """Every plain dtype and shape, by visint and by numpy."""
    arrays = {
        "normals": rng.normal(size=(3, 4, 3)).astype(np.float32),
        "labels": rng.integers(0, 9, (3, 4), dtype=np.int32),
        "mask": rng.random((3, 4)) > 0.5,
        "scalar": np.float64(3.5) * np.ones(()),
        "transposed": rng.normal(size=(5, 2)).T,
    }
    path = put(visint.io.encode_npz(arrays), "all.npz")
    with np.load(path, allow_pickle=False) as numpys:
        for key, read in visint.io.read_npz(path).items():
            np.testing.assert_array_equal(read, arrays[key])
            np.testing.assert_array_equal(numpys[key], arrays[key])
            assert read.dtype == arrays[key].dtype
            assert not read.flags.writeable


def test_same_arrays_give_the_same_bytes_whenever_and_in_whatever_order(monkeypatch):
    """No time stamps, no order of keys."""
    a, b = np.arange(3), np.ones(2)
    first = visint.io.encode_npz({"a": a, "b": b})
    monkeypatch.setattr("time.time", lambda: 1e9)
    assert visint.io.encode_npz({"b": b, "a": a}) == first


@pytest.mark.parametrize("array", [np.array([None]), np.array(["a"]), np.zeros(1, [("x", "f4")])], ids=str)
def test_npz_and_npy_refuse_what_is_not_plain(array):
    """Objects would be pickled."""
    for encode in (visint.io.encode_npy, lambda one: visint.io.encode_npz({"a": one})):
        with pytest.raises(OutputError, match="VI603"):
            encode(array)


def test_broken_archives_are_refused_in_words(make, put, rng):
    """Cut anywhere, damaged inside, no arrays, encrypted, or no archive at all."""
    data = make.stored(None, depth=rng.normal(size=(20, 20)).astype(np.float32), other=np.ones(1))
    cuts = [data[: len(data) * tenth // 10] for tenth in range(1, 10)]
    middle = bytearray(data)
    middle[600] ^= 0xFF
    locked = bytearray(data)
    locked[data.index(b"PK\x01\x02") + 8] |= 1
    for one in [*cuts, bytes(middle), bytes(locked), b"PK\x03\x04", b"PK\x05\x06" + bytes(18)]:
        with pytest.raises(InputError) as caught:
            visint.io.read(put(one), "Depth")
        assert caught.value.problems[0].code in ("VI302", "VI305")


def test_zip_bombs_are_refused_by_their_directory(make, put):
    """Members that unpack to more than the limits, one or all; too many of them; a lie about the size."""
    header = make.npy(F4 % "(50000, 1000)")
    small = visint.io.Limits(megabytes=20)
    with pytest.raises(InputError, match="VI303"):
        visint.io.read(put(make.zipped(depth=header + bytes(30_000_000))), "Depth", limits=small)
    with pytest.raises(InputError, match="VI303"):
        visint.io.read_npz(put(make.zipped(**{f"a{i}": bytes(3_000_000) for i in range(9)})), limits=small)
    with pytest.raises(InputError, match="4096"):
        visint.io.read_npz(put(make.zipped(**{f"a{i}": b"" for i in range(4100)})))
    liar = bytearray(make.zipped(depth=header + bytes(10_000_000)))
    at = liar.index(b"PK\x01\x02")
    liar[at + 24 : at + 28] = (100).to_bytes(4, "little")
    with pytest.raises(InputError, match=r"VI302|VI303"):
        visint.io.read(put(bytes(liar)), "Depth")


def test_members_named_as_paths_leave_nothing_behind(make, put, tmp_path):
    """An archive is read in memory: a name like ../x is a key and no path."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("../escaped.npy", make.stored(np.ones((1, 1), np.float32)))
    assert visint.io.read(put(stream.getvalue()), "Depth").tolist() == [[1]]
    assert not (tmp_path.parent / "escaped.npy").exists()
