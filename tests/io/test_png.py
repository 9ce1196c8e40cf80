"""PNG files give the samples that were stored, whatever their depth; broken ones are refused."""

from __future__ import annotations

import struct
import zlib

import numpy as np
import pytest

import visint.io
from visint.errors import InputError, OutputError

SIZES = [(1, 1), (1, 7), (7, 1), (3, 5), (8, 8), (9, 17)]
SORTS = [(0, 1), (0, 2), (0, 4), (0, 8), (0, 16), (2, 8), (2, 16), (4, 8), (4, 16), (6, 8), (6, 16)]
CHANNELS = {0: 1, 2: 3, 4: 2, 6: 4}


def random_samples(rng, size, colour, depth):
    samples = rng.integers(0, 1 << depth, (*size, CHANNELS[colour]), dtype=np.uint16)
    return samples[..., 0] if colour == 0 else samples


@pytest.mark.parametrize("size", SIZES, ids=str)
@pytest.mark.parametrize("sort", SORTS, ids=str)
@pytest.mark.parametrize("interlace", [False, True])
def test_every_sort_of_png_gives_the_samples_that_were_stored(make, put, rng, size, sort, interlace):
    """Grey and RGB of each depth come back exactly; of grey+alpha and RGBA the colours do."""
    colour, depth = sort
    samples = random_samples(rng, size, colour, depth)
    raster = visint.io.read_raster(put(make.png(samples, colour, depth, interlace)))
    wanted = {0: samples, 2: samples, 4: samples[..., 0], 6: samples[..., :3]}[colour]
    assert raster.top == (1 << depth) - 1
    assert raster.samples.dtype == (np.uint16 if depth == 16 else np.uint8)
    np.testing.assert_array_equal(raster.samples, wanted)


@pytest.mark.parametrize("depth", [1, 2, 4, 8])
def test_palette_gives_the_colours(make, put, rng, depth):
    """A palette's index becomes its colour, red first."""
    palette = rng.integers(0, 256, (1 << depth, 3), dtype=np.uint8)
    index = rng.integers(0, 1 << depth, (5, 9), dtype=np.uint8)
    data = make.png(index, 3, depth, extra=make.chunk(b"PLTE", palette.tobytes()))
    np.testing.assert_array_equal(visint.io.read_raster(put(data)).samples, palette[index])


def test_dropped_alpha_is_told(make, put):
    """Alpha that says something is dropped with a note; alpha that is opaque everywhere without."""
    samples = np.full((2, 3, 4), 255, np.uint8)
    notes: list[str] = []
    visint.io.read_raster(put(make.png(samples, 6)), note=notes.append)
    assert notes == []
    samples[0, 0, 3] = 10
    visint.io.read_raster(put(make.png(samples, 6), "see.png"), note=notes.append)
    assert len(notes) == 1
    assert "see.png" in notes[0]
    assert "alpha" in notes[0]


def test_sixteen_bits_stay_sixteen(make, put):
    """The low byte of a 16-bit colour sample is kept, where cv2.imread's default loses it."""
    samples = np.array([[[1, 256, 257]]], np.uint16)
    raster = visint.io.read_raster(put(make.png(samples, 2, 16)))
    assert raster.samples.tolist() == [[[1, 256, 257]]]


def test_metadata_changes_no_sample(make, put):
    """Gamma, colour profile, orientation and texts are left out of decoding."""
    samples = np.arange(12, dtype=np.uint8).reshape(3, 4)
    extra = make.chunk(b"gAMA", struct.pack(">I", 20000)) + make.chunk(b"tEXt", b"Title\0" + b"x" * 100)
    extra += make.chunk(b"eXIf", b"MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0")
    np.testing.assert_array_equal(visint.io.read_raster(put(make.png(samples, extra=extra))).samples, samples)


@pytest.mark.parametrize("tenth", range(1, 10))
def test_truncated_png_is_refused(make, put, rng, tenth):
    """Cut anywhere, a PNG is refused in words."""
    data = make.png(rng.integers(0, 256, (20, 20), dtype=np.uint8))
    with pytest.raises(InputError, match=r"VI302 .*cut\.png: is .*(cut off|no format)"):
        visint.io.read_raster(put(data[: len(data) * tenth // 10], "cut.png"))


def test_missing_end_mark_is_refused(make, put):
    """A PNG whose samples are all there but whose end mark is not was cut off while copying."""
    data = make.png(np.zeros((4, 4), np.uint8))
    with pytest.raises(InputError, match="end mark"):
        visint.io.read_raster(put(data[:-12]))


def test_every_flipped_byte_is_noticed(make, put, rng):
    """A damaged byte anywhere in an image chunk is refused: the checksums are held against the data."""
    data = make.png(rng.integers(0, 256, (6, 6), dtype=np.uint8))
    for at in range(len(data)):
        broken = bytearray(data)
        broken[at] ^= 0x41
        with pytest.raises(InputError) as caught:
            visint.io.read_raster(put(bytes(broken)))
        assert caught.value.problems[0].code in ("VI302", "VI303")


def test_header_that_lies_about_its_size_is_refused_before_decoding(make, put):
    """Fewer samples than width × height: refused by counting, not by allocating."""
    samples = np.zeros((4, 4), np.uint8)
    with pytest.raises(InputError, match=r"fewer samples than the 4000 × 4000"):
        visint.io.read_raster(put(make.png(samples, claim=(4000, 4000))))
    with pytest.raises(InputError, match=r"VI303 .*60000 × 60000 pixels .*at most 64 MP"):
        visint.io.read_raster(put(make.png(samples, claim=(60000, 60000))))


def test_limits_can_be_raised_and_lowered(make, put):
    """The limits are an argument."""
    path = put(make.png(np.zeros((1100, 1000), np.uint8)))
    assert visint.io.read_raster(path, limits=visint.io.Limits(megapixels=2)).samples.shape == (1100, 1000)
    with pytest.raises(InputError, match="at most 1 MP"):
        visint.io.read_raster(path, limits=visint.io.Limits(megapixels=1))
    with pytest.raises(InputError, match="at most 1 MB"):
        visint.io.read_raster(path, limits=visint.io.Limits(megabytes=1))


@pytest.mark.parametrize("size", SIZES, ids=str)
@pytest.mark.parametrize("channels", [1, 3])
@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_what_is_written_is_what_an_independent_decoder_reads(make, rng, size, channels, dtype):
    """Grey and RGB, 8 and 16 bits, bit for bit."""
    shape = size if channels == 1 else (*size, 3)
    samples = rng.integers(0, np.iinfo(dtype).max + 1, shape, dtype=dtype)
    read, depth, colour = make.unpng(visint.io.encode_png(samples))
    assert (depth, colour) == (samples.itemsize * 8, 0 if channels == 1 else 2)
    np.testing.assert_array_equal(read, samples)


def test_truth_values_and_labels_are_written_exactly(make, put, rng):
    """Bool as 0 and 255; labels as 16 bits; both read back equal."""
    mask = rng.random((5, 6)) > 0.5
    labels = rng.integers(0, 65536, (5, 6), dtype=np.int32)
    assert set(np.unique(make.unpng(visint.io.encode_png(mask))[0])) == {0, 255}
    np.testing.assert_array_equal(visint.io.read(put(visint.io.encode_png(mask)), "Mask"), mask)
    np.testing.assert_array_equal(visint.io.read(put(visint.io.encode_png(labels)), "Regions"), labels)


@pytest.mark.parametrize(
    "array",
    [
        np.zeros((2, 2), np.float32),
        np.zeros((2, 2), np.float64),
        np.zeros((2, 2), np.int64),
        np.full((2, 2), -1, np.int32),
        np.full((2, 2), 65536, np.int32),
        np.zeros((2, 2, 2), np.uint8),
        np.zeros((2, 2, 4), np.uint8),
        np.zeros((2, 2, 3), bool),
        np.zeros((0, 2), np.uint8),
        np.zeros(4, np.uint8),
    ],
    ids=lambda a: f"{a.dtype}{a.shape}",
)
def test_arrays_without_an_exact_png_are_refused(array):
    """A float image would be written as 8 bits and nobody told."""
    with pytest.raises(OutputError, match="VI603"):
        visint.io.encode_png(array)


def test_bomb_of_one_idat_chunk_is_counted_in_pieces(make, put):
    """Data that unpack to far more than the header claims are not unpacked further than it claims."""
    bomb = zlib.compress(bytes(50_000_000), 9)
    small = make.png(np.zeros((2, 2), np.uint8))
    start = small.index(b"IDAT") - 4
    data = small[:start] + make.chunk(b"IDAT", bomb) + make.chunk(b"IEND", b"")
    assert visint.io.read_raster(put(data)).samples.tolist() == [[0, 0], [0, 0]]
