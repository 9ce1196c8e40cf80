"""Broken and odd images: a clear result or one line each, in a process of little memory and in little time."""

from __future__ import annotations

import json
import random
import subprocess
import sys
import zlib

import cv2
import numpy as np
import pytest

PROGRAM = """
import json, resource, sys, time
import cv2, numpy, visint.io
from visint.errors import VisintError
for name in visint.io.__all__:
    getattr(visint.io, name)
cv2.setNumThreads(1)
cv2.imdecode(cv2.imencode(".png", numpy.zeros((64, 64), "u1"))[1], -1)
from visint.io import _kernels
for unpack in (_kernels.unlzw, _kernels.unpackbits):
    unpack(numpy.frombuffer(b"ab", "u1"), numpy.zeros(1, "u1"))
mapped = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
most = mapped + int(sys.argv[1]) * 2**20
resource.setrlimit(resource.RLIMIT_AS, (most, most))
for path, kind in json.load(sys.stdin):
    start = time.process_time()
    try:
        value = visint.io.read(path, kind)
        said = ["", 0, list(value.shape)]
    except VisintError as error:
        said = [error.problems[0].code, str(error).count("\\n"), error.problems[0].found]
    except BaseException as error:
        said = ["TRACEBACK", 0, repr(error)]
    print(json.dumps([*said, time.process_time() - start]))
"""


def read_all(files, megabytes=256):
    """What reading each (path, kind) says, in a process that may map so much more than it has."""
    files = [(str(path), kind) for path, kind in files]
    command = [sys.executable, "-c", PROGRAM, str(megabytes)]
    run = subprocess.run(command, input=json.dumps(files), capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return [json.loads(line) for line in run.stdout.splitlines()]


@pytest.fixture(scope="module")
def whole(make):
    """One small valid file a format."""
    rng = np.random.default_rng(3)
    grey = rng.integers(0, 256, (24, 32), dtype=np.uint8)
    color = rng.integers(0, 256, (24, 32, 3), dtype=np.uint8)
    floats = rng.random((24, 32)).astype(np.float32)
    return {
        "grey.png": make.png(grey),
        "deep.png": make.png(color.astype(np.uint16) * 257, 2, 16),
        "laced.png": make.png(color, 2, interlace=True),
        "photo.jpg": make.jpeg(color),
        "slow.jpg": make.jpeg(color, 2, 1),
        "raw.pgm": b"P5 32 24 255\n" + grey.tobytes(),
        "raw.ppm": b"P6 32 24 255\n" + color.tobytes(),
        "plain.pgm": b"P2 32 24 255\n" + " ".join(map(str, grey.ravel())).encode(),
        "map.pfm": make.pfm(floats),
        "map.npy": make.stored(floats),
        "map.npz": make.stored(None, image=floats),
        "strips.tif": make.tiff(color, rows=5),
        "tiles.tif": make.tiff(grey, tile=(16, 16), pack=zlib.compress, _259=(3, [8])),
        "packed.tif": cv2.imencode(".tif", grey, [cv2.IMWRITE_TIFF_COMPRESSION, 32773])[1].tobytes(),
        "words.tif": cv2.imencode(".tif", grey, [cv2.IMWRITE_TIFF_COMPRESSION, 5])[1].tobytes(),
        "map.tif": make.tiff(floats, order=">"),
    }


def damaged(data, dice):
    """Cuts, flipped bits, a doubled middle, a tail of zeros, a lost middle, another file's head."""
    at = dice.randrange(1, len(data))
    flipped = bytearray(data)
    for _ in range(dice.choice([1, 3, 30])):
        flipped[dice.randrange(len(data))] ^= 1 << dice.randrange(8)
    yield data[:at]
    yield data[: dice.randrange(1, 60)]
    yield bytes(flipped)
    yield data[:at] + data[at // 2 :]
    yield data[:at] + bytes(len(data) - at)
    yield data[:at] + data[at + dice.randrange(1, 50) :]
    head = bytearray(data)
    head[dice.randrange(min(40, len(data)))] = dice.randrange(256)
    yield bytes(head)


def test_hundreds_of_damaged_files(whole, tmp_path):
    """Sixteen files damaged in seven ways, four times: never a traceback, never more than two seconds."""
    dice, files = random.Random(11), []
    for turn in range(4):
        for name, data in whole.items():
            for way, broken in enumerate(damaged(data, dice)):
                path = tmp_path / f"{turn}-{way}-{name}"
                path.write_bytes(broken)
                files.append((path, "Image"))
    answers = read_all(files)
    assert len(answers) == len(files) == 448
    for (path, _), (code, lines, said, seconds) in zip(files, answers, strict=True):
        assert code in ("", "VI302", "VI303", "VI305"), (path.name, said)
        assert lines <= 1, (path.name, said)
        assert seconds < 2, path.name
        assert code or path.read_bytes() not in (b"",)
    refused = sum(code != "" for code, *_ in answers)
    assert refused > 200  # the rest: damage that no format's own rules can show, in raw samples


def test_files_that_claim_to_be_giants(make, tmp_path):
    """Terabytes in a header, gigabytes behind a small one: refused within 256 MB."""
    f4 = "{'descr': '<f4', 'fortran_order': False, 'shape': %s, }"
    row = np.zeros((1, 8), np.uint8)
    bomb = zlib.compress(bytes(11_000_000), 9)  # about 11 KB
    huge = make.png(row, claim=(60000, 60000))
    start = huge.index(b"IDAT") - 4
    giants = {
        "huge.png": huge[:start] + make.chunk(b"IDAT", bomb) + make.chunk(b"IEND", b""),
        "wide.png": make.png(row, claim=(2**31 - 1, 1)),
        "square.png": make.png(row, claim=(8000, 8000)),
        "tall.png": make.png(row, claim=(1, 2**24)),
        "deep.png": make.png(row, claim=(8000, 8000)).replace(b"\x08\0\0\0\0", b"\x10\x06\0\0\0", 1),
        "many.jpg": make.jpeg(np.zeros((8, 8), np.uint8)).replace(b"\0\x08\0\x08", b"\xea\x60\xea\x60", 1),
        "large.jpg": make.jpeg(np.zeros((8, 8), np.uint8)).replace(b"\0\x08\0\x08", b"\x1f\x40\x1f\x40", 1),
        "huge.pgm": b"P5 99999999 99999999 255\n",
        "huge.ppm": b"P6 8000 8000 65535\n" + bytes(1000),
        "plain.pgm": b"P2 8000 8000 255\n" + b"1 " * 1000,
        "huge.pfm": b"Pf\n99999999 99999999\n-1\n",
        "large.pfm": b"Pf\n8000 8000\n-1\n" + bytes(1000),
        "tera.npy": make.npy(f4 % "(1000000, 1000000)"),
        "giga.npy": make.npy(f4 % "(10000, 10000)"),
        "tera.npz": make.zipped(image=make.npy(f4 % "(1000000, 1000000)")),
        "bomb.npz": make.zipped(image=make.npy(f4 % "(20000, 5000)") + bytes(60_000_000)),
    }
    files = []
    for name, data in giants.items():
        (tmp_path / name).write_bytes(data)
        files.append((tmp_path / name, "Image"))
    assert len(giants["huge.png"]) < 12_000
    for (path, _), (code, lines, said, seconds) in zip(files, read_all(files), strict=True):
        assert code in ("VI302", "VI303"), (path.name, code, said)
        assert lines == 1
        assert seconds < 2


def test_valid_files_pass_the_same_process(whole, tmp_path):
    """The limits of that process let every ordinary file through."""
    files = []
    for name, data in whole.items():
        (tmp_path / name).write_bytes(data)
        files.append((tmp_path / name, "Image"))
    for (path, _), (code, _lines, said, _seconds) in zip(files, read_all(files), strict=True):
        assert (code, said) == ("", [24, 32]), (path.name, said)


@pytest.mark.parametrize(
    "kind", ["Image", "Color", "Depth", "Disparity", "Normals", "Mask", "Regions", "Camera", "Scalars"]
)
def test_rubbish_is_refused_as_any_kind(tmp_path, kind):
    """Random bytes behind every format's first ones: one refusal each."""
    import visint.io
    from visint.errors import InputError

    dice = random.Random(kind)
    heads = [
        b"\x89PNG\r\n\x1a\n",
        b"\xff\xd8\xff\xe0",
        b"P5 ",
        b"P2\n",
        b"Pf\n",
        b"\x93NUMPY\x01\x00",
        b"PK\x03\x04",
        b"",
    ]
    for head in heads:
        path = tmp_path / "rubbish"
        path.write_bytes(head + dice.randbytes(400))
        with pytest.raises(InputError):
            visint.io.read(path, kind)


def test_a_member_is_not_unpacked_for_a_header_that_lies(make, tmp_path):
    """60 MB behind a header that claims 400: refused for the lie, not for the memory that it would take."""
    lie = make.npy("{'descr': '<f4', 'fortran_order': False, 'shape': (20000, 5000), }")
    (tmp_path / "lie.npz").write_bytes(make.zipped(image=lie + bytes(60_000_000)))
    ((code, _lines, said, _seconds),) = read_all([(tmp_path / "lie.npz", "Image")], megabytes=30)
    assert code == "VI302"
    assert "npy header claims" in said


def test_too_little_memory_is_one_line(make, tmp_path):
    """A valid file within visint's limits, on a machine that has less."""
    (tmp_path / "valid.npy").write_bytes(make.stored(np.zeros((4000, 3000), np.float32)))
    ((code, lines, said, _seconds),) = read_all([(tmp_path / "valid.npy", "Image")], megabytes=30)
    assert (code, lines) == ("VI303", 1)
    assert "more memory than there is" in said
