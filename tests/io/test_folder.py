"""The output folder: all files of a run or none, and nobody else's touched."""

from __future__ import annotations

import errno
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

import visint.io
from visint.errors import OutputError
from visint.io.folder import former_files


def record(*files):
    return json.dumps({"visint": "0.1.0", "files": [*files, "run.json"]}).encode()


def names(folder):
    return sorted(path.name for path in Path(folder).iterdir())


def write_run(path, force=False, **files):
    """A run of these files: ``depth=b"x"`` becomes depth.pfm."""
    with visint.io.OutputFolder(path, force=force) as folder:
        for name, data in files.items():
            folder.write(f"{name}.pfm", data)
        folder.write("run.json", record(*folder.files))


def tree(folder):
    return {p.name: p.read_bytes() if p.is_file() else None for p in Path(folder).iterdir()}


def test_a_missing_folder_appears_whole(tmp_path):
    """Its parents too; not before the block ends; with the permissions of any new folder."""
    out = tmp_path / "a" / "b" / "out"
    with visint.io.OutputFolder(out) as folder:
        folder.write("depth.pfm", b"1")
        assert not (tmp_path / "a").exists()
    (tmp_path / "other").mkdir()
    assert tree(out) == {"depth.pfm": b"1"}
    assert out.stat().st_mode == (tmp_path / "other").stat().st_mode
    assert names(tmp_path) == ["a", "other"]


def test_an_empty_folder_is_filled_and_stays_itself(tmp_path):
    """The same folder, not another of its name: a shell may stand in it."""
    before = tmp_path.stat().st_ino
    write_run(tmp_path, depth=b"1")
    assert set(tree(tmp_path)) == {"depth.pfm", "run.json"}
    assert tmp_path.stat().st_ino == before


def test_the_working_folder_may_be_the_output(tmp_path, monkeypatch):
    """``--out .``"""
    monkeypatch.chdir(tmp_path)
    write_run(".", depth=b"1")
    assert set(names(".")) == {"depth.pfm", "run.json"}


def test_a_former_run_is_replaced_and_strangers_stay(tmp_path):
    """Its files go, whatever the new run has; a note that the user put there does not."""
    write_run(tmp_path, depth=b"1", normals=b"1")
    (tmp_path / "notes.txt").write_bytes(b"mine")
    write_run(tmp_path, depth=b"2")
    assert tree(tmp_path) == {"depth.pfm": b"2", "notes.txt": b"mine", "run.json": record("depth.pfm")}


@pytest.mark.parametrize(
    "content", [b"", b"{}", b"[1]", b"not json", b'{"other": 1}', b"[" * 99_999, b"\xff"], ids=range(7)
)
def test_a_folder_of_other_things_is_refused(tmp_path, content):
    """Before the run begins, with the way out; a run.json of another program is no visint run."""
    (tmp_path / "run.json").write_bytes(content)
    with pytest.raises(OutputError, match=r"VI602 .*is not empty and holds no visint run[\s\S]*--force"):
        visint.io.OutputFolder(tmp_path)
    assert not visint.io.is_run(tmp_path)
    assert tree(tmp_path) == {"run.json": content}


def test_a_file_is_no_folder(tmp_path, put):
    """Not with force either."""
    with pytest.raises(OutputError, match=r"VI602 .*is a file; wants a folder"):
        visint.io.OutputFolder(put(b"", "file"), force=True)
    with pytest.raises(OutputError, match=r"VI602 .*file: is a file; wants a folder"):
        visint.io.OutputFolder(tmp_path / "file" / "below" / "out")


def test_force_takes_a_folder_and_keeps_what_is_in_it(tmp_path):
    """Only files of the same name are replaced."""
    (tmp_path / "thesis.tex").write_bytes(b"years of work")
    (tmp_path / "depth.pfm").write_bytes(b"old")
    write_run(tmp_path, force=True, depth=b"1")
    assert tree(tmp_path) == {
        "thesis.tex": b"years of work",
        "depth.pfm": b"1",
        "run.json": record("depth.pfm"),
    }


def test_a_record_cannot_have_other_files_removed(tmp_path):
    """The former record is untrusted: only plain names of files in the folder count."""
    out, secret = tmp_path / "out", tmp_path / "secret"
    secret.write_bytes(b"keep")
    (out / "sub").mkdir(parents=True)
    (out / "sub" / "inner").write_bytes(b"keep")
    listed = [
        "../secret",
        str(secret),
        "sub/inner",
        "sub",
        "..",
        ".",
        "",
        "a\0b",
        7,
        None,
        ["x"],
        "x" * 999,
        "old.pfm",
    ]
    (out / "run.json").write_text(json.dumps({"visint": "9", "files": listed}))
    (out / "old.pfm").write_bytes(b"old")
    assert former_files(out) == ("old.pfm",)
    write_run(out, depth=b"1")
    assert secret.read_bytes() == b"keep"
    assert (out / "sub" / "inner").read_bytes() == b"keep"
    assert set(tree(out)) == {"sub", "depth.pfm", "run.json"}
    (out / "run.json").write_text('{"visint": 1, "files": "depth.pfm"}')
    assert former_files(out) == ()


@pytest.mark.parametrize("kind", [RuntimeError, KeyboardInterrupt, SystemExit])
@pytest.mark.parametrize("start", ["missing", "empty", "run"])
def test_an_exception_leaves_everything_as_it_was(tmp_path, kind, start):
    """Ctrl-C in the middle of a run included."""
    out = tmp_path / "out"
    if start != "missing":
        out.mkdir()
    if start == "run":
        write_run(out, depth=b"1")
    before = tree(out) if out.exists() else None
    with pytest.raises(kind), visint.io.OutputFolder(out) as folder:  # noqa: PT012 - it is the block
        folder.write("depth.pfm", b"2")
        raise kind
    assert (tree(out) if out.exists() else None) == before
    assert names(tmp_path) == ([] if start == "missing" else ["out"])


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EIO, errno.EACCES])
@pytest.mark.parametrize("nth", range(1, 7))
@pytest.mark.parametrize("start", ["missing", "run"])
def test_every_rename_may_fail(tmp_path, monkeypatch, number, nth, start):
    """Whichever step fails, the folder is as it was, and a second try gives the whole run."""
    out = tmp_path / "out"
    if start == "run":
        write_run(out, depth=b"1", normals=b"1")
    before = tree(out) if out.exists() else None
    real, count = Path.rename, iter(range(1, 99))

    def rename(self, goal):
        if next(count) == nth:
            raise OSError(number, os.strerror(number))
        return real(self, goal)

    monkeypatch.setattr(Path, "rename", rename)
    steps = 1 if start == "missing" else 5  # record and two files out, two in
    if nth <= steps:
        with pytest.raises(OutputError, match="VI601"):
            write_run(out, depth=b"2")
        assert (tree(out) if out.exists() else None) == before
    monkeypatch.undo()
    write_run(out, depth=b"2")
    assert tree(out) == {"depth.pfm": b"2", "run.json": record("depth.pfm")}
    assert names(tmp_path) == ["out"]


def test_ctrl_c_while_moving_waits_for_the_last_file(tmp_path, monkeypatch):
    """The few renames are done whole, then the interruption arrives."""
    write_run(tmp_path, depth=b"1")
    real = Path.rename

    def rename(self, goal):
        signal.raise_signal(signal.SIGINT)
        return real(self, goal)

    monkeypatch.setattr(Path, "rename", rename)
    with pytest.raises(KeyboardInterrupt):
        write_run(tmp_path, depth=b"2")
    assert tree(tmp_path) == {"depth.pfm": b"2", "run.json": record("depth.pfm")}
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_a_thread_may_write_a_run(tmp_path):
    """Signals belong to the main thread; others go without."""
    thread = threading.Thread(target=write_run, args=(tmp_path / "out",), kwargs={"depth": b"1"})
    thread.start()
    thread.join()
    assert set(tree(tmp_path / "out")) == {"depth.pfm", "run.json"}


def test_the_record_leaves_first_and_arrives_last(tmp_path, monkeypatch):
    """So a folder with a record is whole at every moment, whoever looks."""
    real, seen = Path.rename, []

    def rename(self, goal):
        seen.append(self.name)
        return real(self, goal)

    write_run(tmp_path, depth=b"1")
    monkeypatch.setattr(Path, "rename", rename)
    with visint.io.OutputFolder(tmp_path) as folder:
        folder.write("run.json", record())
        folder.write("normals.pfm", b"2")
    assert seen == ["run.json", "depth.pfm", "normals.pfm", "run.json"]


@pytest.mark.parametrize("name", ["", ".", "..", "a/b", "/etc/x", "a\\b", ".hidden", "n\0l", "x" * 300])
def test_names_are_plain(tmp_path, name):
    """No artifact leaves its folder."""
    with pytest.raises(OutputError, match="VI601"), visint.io.OutputFolder(tmp_path / "out") as folder:
        folder.write(name, b"")
    assert names(tmp_path) == []


def test_writing_outside_the_block_is_a_mistake_of_the_caller(tmp_path):
    """Not a problem of the disk."""
    with pytest.raises(RuntimeError, match="within the block"):
        visint.io.OutputFolder(tmp_path).write("a", b"")


def test_one_of_two_runs_into_one_folder_proceeds(tmp_path):
    """The other is told, and nothing of the first is lost."""
    with visint.io.OutputFolder(tmp_path) as folder:
        folder.write("a.pfm", b"1")
        with pytest.raises(OutputError, match="another run is writing"):
            write_run(tmp_path, depth=b"2")
    assert tree(tmp_path) == {"a.pfm": b"1"}


def test_a_folder_made_by_another_run_meanwhile_is_judged_again(tmp_path):
    """A run there is replaced; other things are not."""
    out = tmp_path / "out"
    with visint.io.OutputFolder(out) as folder:
        folder.write("depth.pfm", b"2")
        write_run(out, depth=b"1")
    assert tree(out) == {"depth.pfm": b"2"}
    shutil.rmtree(out)
    with pytest.raises(OutputError, match="VI602"), visint.io.OutputFolder(out) as folder:  # noqa: PT012
        folder.write("depth.pfm", b"2")
        out.mkdir()
        (out / "mine").write_bytes(b"x")
    assert tree(out) == {"mine": b"x"}


LOOP = """
import json, sys, visint.io
while True:
    with visint.io.OutputFolder(sys.argv[1]) as folder:
        for i in range(4):
            folder.write(f"{i}.pfm", b"data")
        folder.write("run.json", json.dumps({"visint": "1", "files": list(folder.files)}).encode())
    print(flush=True)
"""


def test_a_killed_run_leaves_a_folder_that_the_next_one_takes(tmp_path):
    """kill -9 at any moment: never a record without its files, never a folder that is refused."""
    out, dice = tmp_path / "out", random.Random(5)
    for _ in range(8):
        run = subprocess.Popen([sys.executable, "-c", LOOP, out], stdout=subprocess.PIPE)
        run.stdout.readline()
        threading.Event().wait(dice.random() * 0.02)
        run.kill()
        run.communicate()
        if (out / "run.json").exists():
            assert len(list(out.glob("*.pfm"))) == 4
    write_run(out, depth=b"1")
    assert not list(out.glob(".*"))
    assert "depth.pfm" in names(out)
