"""Every step of every write fails once: exit 5, nothing half-written, and the next run gives the same bytes."""

from __future__ import annotations

import shutil

import pytest

from visint.io.faults import failing

CHANGES = {"profile.json", "report.html"}
"""What tells the time."""
KINDS = ["ENOSPC", "EIO", "EACCES", "short"]


def visible(contents):
    """The files of a folder by name, but for those that tell the time."""
    return {name: data for name, data in contents.items() if name.rpartition("/")[2] not in CHANGES}


@pytest.fixture(scope="module")
def pairs(pair, tmp_path_factory):
    """Five folders with a pair each, of which each is shifted otherwise."""
    import cv2

    root = tmp_path_factory.mktemp("pairs")
    for number in range(5):
        folder = root / f"pair{number}"
        folder.mkdir()
        left, right = (cv2.imread(getattr(pair, side), 0)[:24, :32] for side in ("left", "right"))
        cv2.imwrite(str(folder / "left.png"), left)
        cv2.imwrite(str(folder / "right.png"), right[:, number:] if number else right)
        shutil.copy(folder / "left.png", folder / "right.png")
    return root


@pytest.fixture
def batch(visint, pairs):
    """Runs the graph on every pair, one folder after the other; the exit codes."""

    def call(out):
        codes = []
        for folder in sorted(pairs.iterdir()):
            inputs = [
                "--left",
                folder / "left.png",
                "--right",
                folder / "right.png",
                "--disparity-range",
                "0,6",
            ]
            done = visint("run", "stereo_sgm", *inputs, "--out", f"{out}/{folder.name}", "-q")
            assert "Traceback" not in done.err
            assert (done.out == "") or done.code == 0
            codes.append(done.code)
        return codes

    return call


@pytest.fixture
def unbroken(batch, tmp_path, files):
    """(files, steps) of a batch in which nothing fails."""
    with failing() as faults:
        assert batch("whole") == [0] * 5
    return visible(files.contents(tmp_path / "whole")), len(faults.steps)


def one_fault(batch, at, kind, tmp_path, files, unbroken):
    """A batch into a new folder in which one step fails, and the same batch again."""
    out = tmp_path / f"{kind}-{at}"
    with failing(at, kind) as faults:
        codes = batch(out)
    left = files.contents(out) if out.exists() else {}
    assert not [name for name in left if ".visint-" in name or ".part" in name], (at, kind)
    for name, data in visible(left).items():
        assert unbroken[name] == data, (at, kind, name)
    if faults.failed:
        assert codes.count(5) == 1, (at, kind, codes)
        whole = {name.partition("/")[0] for name in left}
        assert len(whole) >= 4, (at, kind)  # all five where the very last step failed: all is there by then
        assert all(f"{folder}/run.json" in left for folder in whole)
    assert batch(out) == [0] * 5
    assert visible(files.contents(out)) == unbroken, (at, kind)
    shutil.rmtree(out)
    return faults.failed


@pytest.mark.parametrize("kind", KINDS)
def test_a_fault_in_some_writes(batch, tmp_path, files, unbroken, kind):
    """A step early, amid and late in a batch of five pairs."""
    wanted, steps = unbroken
    assert steps > 150
    for at in (2, steps // 2, steps - 1):
        one_fault(batch, at, kind, tmp_path, files, wanted)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_a_fault_in_every_write(batch, tmp_path, files, unbroken, kind):
    """Each step of all five pairs, one after the other."""
    wanted, steps = unbroken
    failed = sum(one_fault(batch, at, kind, tmp_path, files, wanted) for at in range(1, steps + 1))
    assert failed > 150 if kind == "short" else failed == steps


@pytest.mark.parametrize("kind", KINDS)
def test_a_former_run_stays_where_a_new_one_fails(visint, pair, tmp_path, files, kind):
    """Every step of one run over a former one: the former files, or all of the new ones."""
    arguments = ["run", "stereo_sgm", *pair.images, "--disparity-range", "0,8", "--out", "out", "-q"]
    assert visint(*arguments).code == 0
    was = files.contents(tmp_path / "out")
    with failing() as count:
        assert visint(*arguments, "--seed", "1").code == 0
    new = visible(files.contents(tmp_path / "out"))
    shutil.rmtree(tmp_path / "out")
    assert visint(*arguments).code == 0
    for at in range(1, len(count.steps) + 1, 3):
        with failing(at, kind) as faults:
            done = visint(*arguments, "--seed", "1")
        now = visible(files.contents(tmp_path / "out"))
        if faults.failed and done.code == 5:
            assert now in (visible(was), new), (at, count.steps[at - 1])
        else:
            assert done.code == 0
            assert now == new
            assert visint(*arguments).code == 0
