"""Files made byte by byte from their format's definition, so that readers are held against no other reader."""

from __future__ import annotations

import importlib.util
import io
import os
import struct
import zipfile
import zlib
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

ADAM7 = ((0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2))
CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def packed_rows(samples, depth):
    """Filter byte 0 and the samples of each row, most significant bit first."""
    rows = bytearray()
    for row in samples.reshape(samples.shape[0], -1):
        if depth >= 8:
            rows += b"\0" + row.astype(">u2" if depth == 16 else "u1").tobytes()
        else:
            bits = ((row[:, None] >> np.arange(depth - 1, -1, -1)) & 1).astype(np.uint8).ravel()
            rows += b"\0" + np.packbits(bits).tobytes()
    return bytes(rows)


def png(samples, colour=0, depth=8, interlace=False, extra=b"", claim=None):
    """A PNG of ``samples`` (H, W) or (H, W, C); ``claim`` is the (width, height) its header lies about."""
    height, width = samples.shape[:2]
    passes = ADAM7 if interlace else ((0, 0, 1, 1),)
    parts = [samples[y::dy, x::dx] for x, y, dx, dy in passes]
    raw = b"".join(packed_rows(part, depth) for part in parts if part.size)
    size = claim or (width, height)
    header = struct.pack(">IIBBBBB", *size, depth, colour, 0, 0, int(interlace))
    image = chunk(b"IHDR", header) + extra + chunk(b"IDAT", zlib.compress(raw))
    return b"\x89PNG\r\n\x1a\n" + image + chunk(b"IEND", b"")


def unpng(data):
    """(samples, depth, colour) of a PNG of 8 or 16 bits that is not interlaced: an independent decoder."""
    at, idat, header = 8, b"", ()
    while at < len(data):
        length = int.from_bytes(data[at : at + 4], "big")
        kind, body = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", body)
        idat += body if kind == b"IDAT" else b""
        at += 12 + length
    width, height, depth, colour, *_ = header
    step = CHANNELS[colour] * depth // 8
    raw, stride, before, rows = zlib.decompress(idat), width * step, bytearray(width * step), []
    for y in range(height):
        row = bytearray(raw[y * (stride + 1) + 1 : (y + 1) * (stride + 1)])
        unfilter(raw[y * (stride + 1)], row, before, step)
        rows.append(bytes(row))
        before = row
    samples = np.frombuffer(b"".join(rows), ">u2" if depth == 16 else "u1").reshape(height, width, -1)
    return (samples[..., 0] if samples.shape[2] == 1 else samples), depth, colour


def unfilter(kind, row, before, step):
    for i in range(len(row)):
        left = row[i - step] if i >= step else 0
        corner = before[i - step] if i >= step else 0
        guess = left + before[i] - corner
        paeth = min((left, before[i], corner), key=lambda one: abs(guess - one))
        row[i] = (row[i] + (0, left, before[i], (left + before[i]) // 2, paeth)[kind]) & 255


def pfm(values, little=True, scale=1.0):
    """A PFM of ``values`` (H, W) or (H, W, 3), float by float."""
    height, width = values.shape[:2]
    mark = "PF" if values.ndim == 3 else "Pf"
    body = b"".join(struct.pack("<f" if little else ">f", v) for v in values[::-1].ravel().tolist())
    return f"{mark}\n{width} {height}\n{-scale if little else scale}\n".encode() + body


def unpfm(data):
    """float32 (H, W): an independent reader of grey PFM."""
    mark, size, scale, body = data.split(b"\n", 3)
    assert mark == b"Pf"
    width, height = map(int, size.split())
    floats = struct.unpack(f"{'<' if float(scale) < 0 else '>'}{width * height}f", body)
    return np.array(floats, np.float32).reshape(height, width)[::-1]


def npy(header, body=b"", version=1):
    """An npy file with any header text."""
    text = header.encode("latin1")
    text += b" " * (-(len(text) + 11) % 64) + b"\n"
    size = struct.pack("<H" if version == 1 else "<I", len(text))
    return b"\x93NUMPY" + bytes([version, 0]) + size + text + body


def stored(array, **more):
    """An npy file as numpy writes it, pickling if it must; with ``more``, an npz file."""
    stream = io.BytesIO()
    if more:
        np.savez(stream, **more)
    else:
        np.save(stream, array, allow_pickle=True)
    return stream.getvalue()


def zipped(**members):
    """A zip archive with members of any bytes, deflated."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in members.items():
            archive.writestr(f"{name}.npy", data)
    return stream.getvalue()


def tiff(samples, *, order="<", photometric=None, rows=None, tile=None, pack=None, **tags):
    """A TIFF of ``samples`` (H, W) or (H, W, C), written from the format's definition; ``tags`` override."""
    samples = samples[..., None] if samples.ndim == 2 else samples
    height, width, channels = samples.shape
    kind = samples.dtype.kind
    raw = samples.astype(samples.dtype.newbyteorder(order))
    rows, columns = tile or (rows or height, width)
    parts = []
    for top in range(0, height, rows):
        for left in range(0, width, columns):
            part = raw[top : top + rows, left : left + columns]
            if tile:
                part = np.pad(part, ((0, rows - part.shape[0]), (0, columns - part.shape[1]), (0, 0)))
            parts.append((pack or bytes)(part.tobytes()))
    offsets = np.cumsum([8, *map(len, parts)])[:-1].tolist()
    if photometric is None:
        photometric = 2 if channels >= 3 else 1
    entries = {
        256: (4, [width]), 257: (4, [height]), 258: (3, [samples.dtype.itemsize * 8] * channels), 259: (3, [1]),
        262: (3, [photometric]), 277: (3, [channels]), 284: (3, [1]),
        339: (3, [3 if kind == "f" else 1] * channels),
        **({322: (4, [columns]), 323: (4, [rows]), 324: (4, offsets), 325: (4, [len(p) for p in parts])} if tile
           else {273: (4, offsets), 278: (4, [rows]), 279: (4, [len(p) for p in parts])}),
    }  # fmt: skip
    for tag, value in tags.items():
        entries[int(tag[1:])] = value
    return assembled(b"".join(parts), entries, order)


def assembled(body, entries, order):
    start = 8 + len(body)
    start += start % 2
    tail, table = b"", b""
    after = start + 2 + 12 * len(entries) + 4
    for tag in sorted(entries):
        type_, values = entries[tag]
        data = struct.pack(f"{order}{len(values)}{'?BBHI'[type_]}", *values)
        if len(data) > 4:
            data, tail = struct.pack(f"{order}I", after + len(tail)), tail + data
        table += struct.pack(f"{order}HHI", tag, type_, len(values)) + data.ljust(4, b"\0")
    head = (b"II*\0" if order == "<" else b"MM\0*") + struct.pack(f"{order}I", start)
    count = struct.pack(f"{order}H", len(entries))
    return (head + body).ljust(start, b"\0") + count + table + bytes(4) + tail


def jpeg(samples, *flags):
    import cv2

    return cv2.imencode(".jpg", samples, list(flags))[1].tobytes()


@pytest.fixture(scope="session")
def make():
    return SimpleNamespace(
        png=png,
        unpng=unpng,
        chunk=chunk,
        pfm=pfm,
        unpfm=unpfm,
        npy=npy,
        stored=stored,
        zipped=zipped,
        jpeg=jpeg,
        tiff=tiff,
    )


@pytest.fixture
def put(tmp_path):
    """Writes bytes to a file and gives its path."""

    def put(data, name="file.bin"):
        path = tmp_path / name
        path.write_bytes(data.encode() if isinstance(data, str) else data)
        return path

    return put


@pytest.fixture(scope="session")
def real_data():
    """The folder of real data; its tests are skipped where it is absent."""
    root = Path(__file__).parents[2]
    folder = Path(os.environ.get("VISINT_DATA", root / ".." / "shared" / "data"))
    if not folder.is_dir():
        pytest.skip("no real data: set VISINT_DATA")
    return folder


@pytest.fixture(scope="session")
def rigs():
    """The module beside this one: a rig of known numbers."""
    spec = importlib.util.spec_from_file_location("rigs", Path(__file__).with_name("rigs.py"))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def rng():
    return np.random.default_rng(7)
