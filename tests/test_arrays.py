"""Arrays on ports: what a spec refuses, in which words, and that nothing is copied or can be written."""

from __future__ import annotations

import re
import typing

import numpy as np
import pytest
from hypothesis import given
from pydantic import TypeAdapter, ValidationError

from visint import arrays
from visint.arrays import SPECS, Array, ArrayKind, ArraySpec, Depth, Image, Normals, read_only
from visint.testing import strategies

DEPTH = SPECS["Depth"]


class TestReadOnly:
    def test_nothing_is_copied(self):
        array = np.ones((3, 4), np.float32)
        view = read_only(array)
        assert np.shares_memory(view, array)
        assert array.flags.writeable
        with pytest.raises(ValueError, match="read-only"):
            view[0, 0] = 2

    def test_what_is_read_only_already_is_itself(self):
        array = read_only(np.ones((3, 4)))
        assert read_only(array) is array

    @pytest.mark.parametrize("slanted", [np.s_[:, ::2], np.s_[::-1], np.s_[:, 1:]])
    def test_c_order_is_made(self, slanted):
        """OpenCV and the kernels count on it; the values stay."""
        array = np.arange(12.0).reshape(3, 4)[slanted]
        view = read_only(array)
        assert view.flags.c_contiguous
        assert not view.flags.writeable
        np.testing.assert_array_equal(view, array)

    def test_transposed_and_read_only(self):
        array = np.arange(12.0).reshape(3, 4).T
        array.flags.writeable = False
        assert read_only(array).flags.c_contiguous
        assert not read_only(array).flags.writeable

    def test_a_subclass_becomes_a_plain_array(self, tmp_path):
        """A matrix multiplies by other rules, a memory map is only where the array came from."""
        matrix = np.ones((2, 2), np.float32).view(np.matrix)
        mapped = np.memmap(tmp_path / "depth", np.float32, "w+", shape=(2, 2))
        for given_ in (matrix, mapped):
            taken = DEPTH.check(given_)
            assert type(taken) is np.ndarray
            assert np.shares_memory(taken, given_)

    def test_a_mask_is_not_lost_in_silence(self):
        masked = np.ma.masked_array(np.ones((2, 2), np.float32), mask=[[1, 0], [0, 0]])
        with pytest.raises(ValueError, match=r"masked array; write array.filled\(np.nan\)"):
            DEPTH.check(masked)


class TestSpec:
    def test_words(self):
        """As it stands in every message."""
        assert str(DEPTH) == "Depth float32 (H, W)"
        assert str(SPECS["Normals"]) == "Normals float32 (H, W, 3)"
        assert str(SPECS["Scalars"]) == "Scalars float64 (N)"

    @pytest.mark.parametrize(
        ("value", "found"),
        [
            (np.ones((2, 3)), "this array is float64"),
            (np.ones((2, 3), np.int32), "this array is int32"),
            (np.ones((2, 3), ">f4"), "this array is >f4"),
            (np.ones(3, np.float32), "this array has shape (3,)"),
            (np.ones((2, 3, 1), np.float32), "this array has shape (2, 3, 1)"),
            ([[1.0]], "this is a list, not a numpy array"),
            (None, "this is a NoneType, not a numpy array"),
            (np.float32(1), "this is a float32, not a numpy array"),
        ],
        ids=str,
    )
    def test_refused(self, value, found):
        """What was wanted and what was found, on one line, without the contents."""
        with pytest.raises(ValueError, match=re.escape(f"wants Depth float32 (H, W); {found}")) as refused:
            DEPTH.check(value)
        assert "\n" not in str(refused.value)

    def test_a_fixed_length_must_be_right(self):
        with pytest.raises(ValueError, match=r"Normals float32 \(H, W, 3\); this array has shape \(4, 5, 2\)"):
            SPECS["Normals"].check(np.ones((4, 5, 2), np.float32))

    def test_values_are_never_looked_at(self):
        """NaN and inf are values like others here."""
        value = np.array([[np.nan, np.inf]], np.float32)
        assert np.shares_memory(DEPTH.check(value), value)

    def test_specs_are_values(self):
        again = ArraySpec("Depth", "float32", ("H", "W"), "baseline")
        assert again == DEPTH
        assert hash(again) == hash(DEPTH)
        assert ArraySpec("Depth", "float32", ("rows", "W"), "baseline") != DEPTH

    @pytest.mark.parametrize("dtype", ["float33", "object", "O", "datetime64[s]", "U3"])
    def test_only_numbers_go_round(self, dtype):
        """An object array could hold anything, and could not be written anywhere."""
        with pytest.raises(TypeError):
            ArraySpec("own.Thing", dtype, ("N",))

    @given(strategies.arrays("Normals"))
    def test_samples_pass(self, value):
        """What the kit makes is what the kind wants."""
        assert not SPECS["Normals"].check(value).flags.writeable
        length = np.linalg.norm(value, axis=-1)
        np.testing.assert_allclose(length[np.isfinite(length)], 1, rtol=1e-5)


class TestKinds:
    def test_a_port_is_annotated(self):
        """At run time `Depth[Array, "H W"]` is the array with its spec beside it."""
        array, spec = typing.get_args(Depth[Array, "rows columns"])
        assert array == Array
        assert spec == ArraySpec("Depth", "float32", ("rows", "columns"), "baseline")

    def test_digits_are_lengths(self):
        assert typing.get_args(Normals[Array, "H W 3"])[1].dims == ("H", "W", 3)
        assert typing.get_args(Image[Array, "480 640"])[1].dims == (480, 640)

    def test_the_number_of_axes_is_the_kinds(self):
        with pytest.raises(TypeError, match=r"Depth has 2 axes, as in Depth float32 \(H, W\); got 'H W 3'"):
            Depth[Array, "H W 3"]

    @pytest.mark.parametrize("dims", ["H W 2", "H W C"])
    def test_a_length_that_the_kind_fixes_stays(self, dims):
        """Normals have three components whatever a port says."""
        with pytest.raises(TypeError, match=r"Normals float32 \(H, W, 3\)"):
            Normals[Array, dims]

    def test_all_kinds_are_exported_under_their_names(self):
        assert set(SPECS) <= set(arrays.__all__)
        for name, spec in SPECS.items():
            kind = getattr(arrays, name)
            assert isinstance(kind, ArrayKind)
            assert repr(kind) == name
            assert kind.spec == spec

    def test_a_strangers_kind(self):
        flow = ArrayKind("flow.Flow", "float32", "H W 2", "px")
        adapter = TypeAdapter(flow[Array, "H W 2"])
        taken = adapter.validate_python(np.zeros((3, 4, 2), np.float32))
        assert taken.shape == (3, 4, 2)
        with pytest.raises(ValidationError, match=r"wants flow.Flow float32 \(H, W, 2\)"):
            adapter.validate_python(np.zeros((3, 4, 3), np.float32))

    def test_the_table_cannot_be_changed(self):
        with pytest.raises(TypeError):
            SPECS["Depth"] = None
