"""Writing: the whole file or the former one, and one line about why not."""

from __future__ import annotations

import errno
import os
import resource
import shutil
import subprocess
import sys
from collections import namedtuple
from pathlib import Path

import pytest

import visint.io
from visint.errors import OutputError


def names(folder):
    return sorted(path.name for path in Path(folder).iterdir())


def test_bytes_and_text_arrive(tmp_path):
    """Also over a former file; nothing else is left in the folder."""
    path = tmp_path / "a.bin"
    visint.io.write_bytes(path, b"one")
    visint.io.write_bytes(path, b"two")
    visint.io.write_text(tmp_path / "b.txt", "ä\n")
    assert path.read_bytes() == b"two"
    assert (tmp_path / "b.txt").read_bytes() == b"\xc3\xa4\n"
    assert names(tmp_path) == ["a.bin", "b.txt"]


def test_a_folder_is_made_with_its_parents(tmp_path):
    """One that is there is fine; a file in the way is one line that names it."""
    visint.io.make_folder(tmp_path / "a" / "b")
    visint.io.make_folder(tmp_path / "a" / "b")
    assert (tmp_path / "a" / "b").is_dir()
    (tmp_path / "file").touch()
    with pytest.raises(visint.OutputError, match=r"VI601 .*file"):
        visint.io.make_folder(tmp_path / "file")


def test_new_files_have_usual_permissions(tmp_path):
    """As the umask says, not a temporary file's 0600."""
    visint.io.write_bytes(tmp_path / "a", b"")
    (tmp_path / "b").write_bytes(b"")
    assert (tmp_path / "a").stat().st_mode == (tmp_path / "b").stat().st_mode


def failing(number):
    def fail(*args, **more):
        raise OSError(number, os.strerror(number))

    return fail


@pytest.mark.parametrize("step", ["pathlib.Path.open", "os.fsync", "pathlib.Path.replace"])
@pytest.mark.parametrize(
    "number", [errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EACCES, errno.EROFS, errno.EFBIG]
)
def test_every_step_may_fail(tmp_path, monkeypatch, step, number):
    """Opening, flushing, renaming: the former file stays, no part of the new one is left."""
    path = tmp_path / "depth.pfm"
    path.write_bytes(b"former")
    monkeypatch.setattr(step, failing(number))
    with pytest.raises(OutputError, match=r"VI601 .*depth\.pfm: cannot be written: \w+") as caught:
        visint.io.write_bytes(path, b"new")
    monkeypatch.undo()
    assert caught.value.exit_code == 5
    assert path.read_bytes() == b"former"
    assert names(tmp_path) == ["depth.pfm"]


def test_interruption_leaves_the_former_file(tmp_path, monkeypatch):
    """Ctrl-C while flushing."""

    def interrupt(handle):
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "fsync", interrupt)
    with pytest.raises(KeyboardInterrupt):
        visint.io.write_bytes(tmp_path / "a", b"new")
    assert names(tmp_path) == []


def test_a_full_disk_says_how_much_is_missing(tmp_path, monkeypatch):
    """Wanted, free and missing."""
    usage = namedtuple("usage", "total used free")(10, 8, 2)
    monkeypatch.setattr(shutil, "disk_usage", lambda path: usage)
    monkeypatch.setattr(os, "fsync", failing(errno.ENOSPC))
    with pytest.raises(
        OutputError, match="the disk is full: 5000 bytes wanted, 2 bytes free, 4998 bytes missing"
    ):
        visint.io.write_bytes(tmp_path / "a", bytes(5000))


def test_a_full_quota_says_what_is_needed(tmp_path, monkeypatch):
    """The disk has room, the user has none."""
    monkeypatch.setattr(os, "fsync", failing(errno.EDQUOT))
    with pytest.raises(OutputError, match=r"the disk or quota is full; this file needs 0\.02 MB"):
        visint.io.write_bytes(tmp_path / "a", bytes(20_000))


def test_places_that_are_none(tmp_path):
    """A missing folder, a folder of that name, a file as folder, an impossible name."""
    (tmp_path / "file").write_bytes(b"")
    (tmp_path / "folder").mkdir()
    for name, words in {
        "absent/a": "folder does not exist",
        "folder": "folder of that name",
        "file/a": "is a file, not a folder",
        "x" * 300: "too long",
        "nul\0": "no file name",
    }.items():
        with pytest.raises(OutputError, match=words):
            visint.io.write_bytes(f"{tmp_path}/{name}", b"")


def test_a_disk_that_really_ends(tmp_path):
    """Under a limit on file sizes, in a process of its own: one line, nothing left."""
    program = """
import resource, sys, visint.io
from visint.errors import OutputError
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
try:
    visint.io.write_bytes(sys.argv[1], bytes(5000))
except OutputError as error:
    print(error.problems[0].found)
"""
    run = subprocess.run(
        [sys.executable, "-c", program, tmp_path / "a"], capture_output=True, text=True, check=True
    )
    assert "larger than this process or disk may write" in run.stdout
    assert names(tmp_path) == []
    assert resource.getrlimit(resource.RLIMIT_FSIZE)[0] != 1000
