"""150 broken and odd images through the whole program: a result, or a few lines; nothing half-written.

Each is tried in a process that may map 512 MB more than it has when it starts, within 2 s of its time.
"""

from __future__ import annotations

import importlib.util
import json
import os
import random
import struct
import subprocess
import sys
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest

PROGRAM = """
import contextlib, io, json, os, pathlib, resource, shutil, sys, time
from visint.cli.main import main
def call(arguments):
    out, err = io.StringIO(), io.StringIO()
    started = time.process_time()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main(arguments)
    return code, out.getvalue(), err.getvalue(), time.process_time() - started
tasks = json.load(sys.stdin)
call([*tasks[0], "--out", "warm"])
shutil.rmtree("warm")
mapped = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (mapped + 512 * 2**20,) * 2)
for arguments in tasks:
    code, out, err, seconds = call([*arguments, "--out", "out"])
    names = sorted(path.name for path in pathlib.Path().iterdir())
    left = [name for name in names if name == "out" or name.startswith(".visint")]
    whole = os.path.exists("out/run.json")
    shutil.rmtree("out", ignore_errors=True)
    print(json.dumps([code, out, err, seconds, left, whole]))
print(json.dumps(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss))
"""


def makers():
    """The writers of the reader's own tests, made from the formats' definitions."""
    path = Path(__file__).parents[1] / "io" / "conftest.py"
    spec = importlib.util.spec_from_file_location("io_makers", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def whole(m) -> dict[str, bytes]:
    """A sound file of each sort."""
    rng = np.random.default_rng(3)
    grey = (cv2.GaussianBlur(rng.random((24, 32)), (0, 0), 1) * 255).astype(np.uint8)
    color = rng.integers(0, 256, (24, 32, 3), dtype=np.uint8)
    floats = grey.astype(np.float32) / 255
    packed = {
        name: cv2.imencode(".tif", grey, [cv2.IMWRITE_TIFF_COMPRESSION, number])[1].tobytes()
        for name, number in (("lzw", 5), ("deflate", 8), ("packbits", 32773))
    }
    return {
        "grey.png": m.png(grey),
        "deep.png": m.png(color.astype(np.uint16) * 257, 2, 16),
        "laced.png": m.png(color, 2, interlace=True),
        "photo.jpg": m.jpeg(color),
        "slow.jpg": m.jpeg(color, 2, 1),
        "raw.pgm": b"P5 32 24 255\n" + grey.tobytes(),
        "raw.ppm": b"P6 32 24 255\n" + color.tobytes(),
        "plain.pgm": b"P2 32 24 255\n" + " ".join(map(str, grey.ravel())).encode(),
        "map.pfm": m.pfm(floats),
        "map.npy": m.stored(floats),
        "map.npz": m.stored(None, left=floats),
        "plain.tif": m.tiff(grey, rows=7),
        "tiles.tif": m.tiff(color, tile=(16, 16), pack=zlib.compress, _259=(3, [8])),
        "map.tif": m.tiff(floats, order=">"),
        **{f"{name}.tif": data for name, data in packed.items()},
    }


def damaged(data: bytes, dice: random.Random) -> list[bytes]:
    """Cut, cut in the header, bits flipped, a lost middle, zeros behind, one byte of the header changed."""
    at = dice.randrange(1, len(data))
    flipped, head = bytearray(data), bytearray(data)
    for _ in range(20):
        flipped[dice.randrange(len(data))] ^= 1 << dice.randrange(8)
    head[dice.randrange(min(40, len(data)))] = dice.randrange(256)
    lost = data[:at] + data[at + dice.randrange(1, 50) :]
    return [
        data[:at],
        data[: dice.randrange(1, 50)],
        bytes(flipped),
        lost,
        data[:at] + bytes(len(data) - at),
        bytes(head),
    ]


def giants(m) -> dict[str, bytes]:
    """Headers that promise more than a machine has."""
    row = np.zeros((1, 8), np.uint8)
    f4 = "{'descr': '<f4', 'fortran_order': False, 'shape': %s, }"
    jpeg = m.jpeg(np.zeros((8, 8), np.uint8))
    bomb = m.png(row, claim=(60000, 60000))
    start = bomb.index(b"IDAT") - 4
    stuffed = m.chunk(b"IDAT", zlib.compress(bytes(11_000_000), 9))
    return {
        "bomb.png": bomb[:start] + stuffed + m.chunk(b"IEND", b""),
        "wide.png": m.png(row, claim=(2**31 - 1, 1)),
        "square.png": m.png(row, claim=(8000, 8000)),
        "many.jpg": jpeg.replace(b"\0\x08\0\x08", b"\xea\x60\xea\x60", 1),
        "huge.pgm": b"P5 99999999 99999999 255\n",
        "plain.pgm": b"P2 8000 8000 255\n" + b"1 " * 1000,
        "huge.pfm": b"Pf\n99999999 99999999\n-1\n",
        "tera.npy": m.npy(f4 % "(1000000, 1000000)"),
        "bomb.npz": m.zipped(left=m.npy(f4 % "(20000, 5000)") + bytes(60_000_000)),
        "huge.tif": m.tiff(row, _256=(4, [2**31 - 1]), _257=(4, [2**31 - 1])),
        "tiles.tif": m.tiff(row, tile=(1, 8), _322=(4, [1 << 30]), _323=(4, [1 << 30])),
        "strips.tif": m.tiff(row, _257=(4, [1 << 20]), _278=(4, [1])),
    }


def odd(m) -> dict[str, bytes]:
    """Sound files that are seldom seen, and files that are no image at all."""
    grey = np.arange(24 * 32, dtype=np.uint8).reshape(24, 32)
    rgba = np.dstack([grey] * 4)
    nothing = np.full((24, 32), np.nan, np.float32)
    return {
        "alpha.png": m.png(rgba, 6),
        "grey and alpha.png": m.png(np.dstack([grey, grey]), 4),
        "one bit.png": m.png(grey % 2, depth=1),
        "two bits.png": m.png(grey % 4, depth=2),
        "one pixel.png": m.png(grey[:1, :1]),
        "one row.png": m.png(grey[:1]),
        "one column.png": m.png(grey[:, :1]),
        "black.png": m.png(np.zeros((24, 32), np.uint8)),
        "ten bits.pgm": b"P5 32 24 1023\n" + (grey.astype(">u2") * 4).tobytes(),
        "maxval 1.pgm": b"P5 32 24 1\n" + (grey % 2).tobytes(),
        "comments.pgm": b"P2\n# a\n32 # b\n24\n#c\n255\n" + b"7 " * 768,
        "big endian.pfm": m.pfm(grey.astype(np.float32) / 255, little=False),
        "nan.pfm": m.pfm(nothing),
        "out of range.pfm": m.pfm(grey.astype(np.float32)),
        "negative.npy": m.stored(-np.ones((24, 32), np.float32)),
        "doubles.npy": m.stored(np.linspace(0, 1, 768).reshape(24, 32)),
        "integers.npy": m.stored(grey.astype(np.int64)),
        "objects.npy": m.stored(np.array([[None, {}]], object)),
        "records.npy": m.stored(np.zeros((2, 2), [("a", "f4")])),
        "empty.npy": m.stored(np.zeros((0, 4), np.float32)),
        "one axis.npy": m.stored(np.zeros(9, np.float32)),
        "no such key.npz": m.stored(None, a=np.zeros((2, 2)), b=np.zeros((2, 2))),
        "white is zero.tif": m.tiff(grey, photometric=0),
        "alpha.tif": m.tiff(rgba),
        "palette.tif": m.tiff(grey, photometric=3),
        "turned.tif": m.tiff(grey, _274=(3, [6])),
        "ring.tif": b"II*\0" + struct.pack("<IHHHII", 8, 1, 256, 4, 1, 8) + struct.pack("<I", 8),
        "big.tif": b"II+\0" + bytes(60),
        "empty.png": b"",
        "text.png": b"not an image\n",
        "page.png": b"<html></html>\n",
        "gif.png": b"GIF89a" + bytes(100),
        "bmp.png": b"BM" + bytes(100),
        "webp.png": b"RIFF\0\0\0\0WEBPVP8 " + bytes(100),
        "pdf.jpg": b"%PDF-1.7\n" + bytes(100),
        "noise.png": random.Random(1).randbytes(3000),
    }


def files() -> dict[str, bytes]:
    """All of them by name."""
    m, dice = makers(), random.Random(7)
    found = {f"giant {name}": data for name, data in giants(m).items()} | odd(m)
    for name, data in whole(m).items():
        found |= {f"{way} {name}": broken for way, broken in enumerate(damaged(data, dice))}
    return found


FILES = files()


def test_there_are_enough():
    """At least 150."""
    assert len(FILES) >= 150


def tried(names, folder, pair):
    """What the program says of each file as the left image of a pair, or as both images."""
    tasks = [["run", "stereo_sgm", "--left", pair.left, "--right", pair.right, "--disparity-range", "0,8"]]
    for name in names:
        path = folder / name
        path.write_bytes(FILES[name])
        tasks.append(
            ["run", "stereo_sgm", "--left", str(path), "--right", str(path), "--disparity-range", "0,8"]
        )
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        input=json.dumps(tasks),
        capture_output=True,
        text=True,
        check=False,
        cwd=folder,
        env={**os.environ, "OMP_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"},
    )
    assert done.returncode == 0, done.stderr[-2000:]
    *answers, peak = [json.loads(line) for line in done.stdout.splitlines()]
    return dict(zip(names, answers[1:], strict=True)), peak


def checked(names, folder, pair):
    """Holds every answer against what is promised; how many files were refused."""
    answers, peak = tried(names, folder, pair)
    for name, (code, out, err, seconds, left, complete) in answers.items():
        assert code in (0, 3), (name, code, err)
        assert "Traceback" not in err, name
        assert seconds < 2, (name, seconds)
        if code == 3:
            assert (out, left) == ("", []), name
            assert len(err.splitlines()) <= 4, (name, err)
            assert name in err, (name, err)
        else:
            assert (left, complete) == (["out"], True), name
    assert peak * 1024 < 1.2e9  # with numba, scipy and OpenCV loaded
    return sum(code == 3 for code, *_ in answers.values())


def test_some_of_them(tmp_path, pair):
    """Every sixth."""
    names = list(FILES)[::6]
    assert checked(names, tmp_path, pair) > len(names) // 2


@pytest.mark.slow
def test_all_of_them(tmp_path, pair):
    """150 and more."""
    assert checked(list(FILES), tmp_path, pair) > 100
