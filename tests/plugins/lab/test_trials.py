"""Reproducing tables, benches and ablations, on small scenes with what is installed."""

import csv

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

import visint
from visint_lab import ablate, bench, demo, reproduce
from visint_lab.datasets.pair import Pair
from visint_lab.peers import Cost
from visint_lab.render.rendering import render
from visint_lab.scenes import names, scene
from visint_lab.trials import page
from visint_lab.trials.apart import reconstruct_apart
from visint_lab.trials.contest import Heat, standings
from visint_lab.trials.improvement import Outcome, RowResult, improvements
from visint_lab.trials.plot import quality_and_time
from visint_lab.trials.published import IMPROVEMENTS, TIMES, ImprovementTable, Row
from visint_lab.trials.reconstruction import Reconstruction, constant_plane, scored
from visint_lab.trials.systems import SystemVariant, installed, reconstruct
from visint_lab.trials.telling import rows_of

FREE = Cost(0.1, 0.1, 10.0)


def called(module, *words):
    app = typer.Typer()
    app.command()(module.command)
    return CliRunner().invoke(app, [str(word) for word in words], catch_exceptions=False)


@pytest.fixture(scope="module")
def pair():
    return Pair.of(render(scene("a/sphere/lambertian", 96), samples=1))


def test_the_truth_scores_perfectly(pair):
    """Depth, disparity and normals of the truth have no error."""
    found = Reconstruction.of("truth", pair.disparity, pair, FREE, normals=pair.normals)
    scores = scored(found, pair)
    for key in ("rmse", "s", "bad1", "mae"):
        assert scores[key] == pytest.approx(0, abs=1e-4)


def test_the_constant_plane_lies_at_the_median_depth(pair):
    """Its error is the spread of the true depth about its median, and its normals look at the camera."""
    floor = constant_plane(pair)
    spread = pair.depth[np.isfinite(pair.depth)] - np.nanmedian(pair.depth)
    assert scored(floor, pair)["rmse"] == pytest.approx(np.sqrt(np.mean(spread.astype(float) ** 2)), rel=1e-3)
    np.testing.assert_allclose(floor.normals[40, 40], [0, 0, -1], atol=1e-3)


def test_holes_of_an_object_are_not_filled_from_the_void(pair):
    """A wild value outside the object does not enter it."""
    wild = np.where(np.isfinite(pair.disparity), np.nan, np.float32(-500)).astype(np.float32)
    row = 48
    inside = np.nonzero(np.isfinite(pair.disparity[row]))[0]
    wild[row, inside[5]] = pair.disparity[row, inside[5]]
    found = Reconstruction.of("x", wild, pair, FREE)
    assert (found.disparity[row, inside] == pair.disparity[row, inside[5]]).all()
    assert found.density == pytest.approx(1 / np.isfinite(pair.disparity).sum())


def test_halving_the_squared_errors_is_a_reduction_of_50_percent():
    """100·(1 − ours/baseline) for shape and depth; the median over seeds stands in the table."""
    scores = {"stereo": {"s": 0.2, "mse": 4.0, "rmse": 2.0}, "joint": {"s": 0.1, "mse": 3.0, "rmse": 1.7}}
    scores["constant plane"] = {"s": 0.5, "rmse": 2.5}
    outcome = Outcome(None, scores, {"stereo": None, "joint": None}, "stereo")
    result = RowResult(Row("sphere", "x", 23.4, 35.7), [outcome])
    middle = result.middle("joint")
    assert (middle.shape, middle.depth) == pytest.approx((50, 25))
    assert result.middle("absent") is None
    head, rows = rows_of([result])
    assert head == ["", "published S/D", "joint S/D", "stereo rmse/S", "constant plane rmse/S"]
    assert rows == [["sphere", "23.4/35.7", "50.0/25.0", "2.00/0.20", "2.50/0.50"]]


def test_every_row_of_every_table_has_its_scene():
    """Rows name scenes that exist under the table's noise."""
    known = names()
    for table in IMPROVEMENTS.values():
        assert all(f"{row.scene}+{table.noise}" in known for row in table.rows), table.number
    assert all(table.scene in known for table in TIMES.values())


def test_the_published_figures_are_those_printed():
    """Spot checks, shape before depth, against the tables as quoted."""
    table = {row.label: (row.shape, row.depth) for row in IMPROVEMENTS["4.6"].rows}
    assert table["parallelepiped"] == (30.0, 41.3)
    assert table["torus"] == (15.8, 17.6)
    assert {row.label: (row.shape, row.depth) for row in IMPROVEMENTS["5.4"].rows}["two textures"] == (37, 18)


def test_a_table_runs_with_stereo_alone():
    """Without an integrated system a row has the errors of stereo and of a constant plane, nothing else."""
    row = Row("ball", "a/sphere/lambertian", 1, 2)
    table = ImprovementTable("x", "x", "no_such_system", "", (row,))
    (result,) = improvements(table, 64, [None], ["no_such_system"])
    assert len(result.outcomes[0].maps) == 1
    assert result.middle("no_such_system") is None


@pytest.mark.parametrize("number", ["5.2", pytest.param("5.4", marks=pytest.mark.slow)])
def test_reproduce_says_what_is_missing(number, tmp_path):
    """The verb prints the table, names absent systems and the errata, and writes CSV and a page."""
    try:
        scene("b/mozart/no", 64)
    except visint.InputError:
        pytest.skip("the Mozart range image is not there")
    done = called(reproduce, number, "--size", 64, "--out", tmp_path)
    assert done.exit_code == 0
    assert f"Table {number}" in done.stdout
    if not installed("uniform_bayesian"):
        assert "uniform_bayesian is not there yet" in done.stdout
    rows = list(csv.reader((tmp_path / "table.csv").read_text().splitlines()))
    assert len(rows) == 6
    html = (tmp_path / "table.html").read_text()
    assert "http" not in html.replace("http://www.w3.org", "")


def test_an_unknown_table_is_refused():
    """The error lists the tables there are."""
    with pytest.raises(visint.UsageError, match=r"4\.5, 4\.6"):
        called(reproduce, "9.9")


def test_a_system_runs_in_a_process_of_its_own(pair):
    """The same disparity as in this process, and its peak memory besides."""
    here = reconstruct("stereo_sgm", pair)
    apart = reconstruct_apart(SystemVariant("stereo_sgm"), pair)
    np.testing.assert_array_equal(here.disparity, apart.disparity)
    assert apart.density == here.density
    assert 30 < apart.cost.peak_mb < 2000


def test_standings_count_what_was_made_worse():
    """Against the first entrant, pair by pair; a failure counts as worse."""
    found = [
        Heat("one", "a", {"bad2": 0.1, "cpu": 1.0}),
        Heat("one", "b", {"bad2": 0.2, "cpu": 2.0}),
        Heat("two", "a", {"bad2": 0.3, "cpu": 1.0}),
        Heat("two", "b", {"bad2": 0.1, "cpu": 4.0}),
        Heat("three", "a", {"bad2": 0.3, "cpu": 1.0}),
        Heat("three", "b", {}, "it broke"),
    ]
    a, b = standings(found, "bad2")
    assert (a.worse, b.worse, b.pairs) == (0, 2, 3)
    assert b.medians["bad2"] == pytest.approx(0.15)
    assert b.means["cpu"] == pytest.approx(3.0)
    svg = quality_and_time((a, b), "bad2", "bad-2.0")
    assert svg.count("<circle") == 2


def test_bench_prints_one_line_an_entrant(tmp_path):
    """Medians by entrant on stdout; every pair's scores in scenes.csv."""
    words = ("run", "--on", "a/sphere/lambertian", "--peer", "none", "--size", 96, "--out", tmp_path)
    done = called(bench, *words)
    assert done.exit_code == 0
    assert "stereo_sgm" in done.stdout
    assert "constant plane" in done.stdout
    assert len(list(csv.reader((tmp_path / "scenes.csv").read_text().splitlines()))) == 3
    assert "<svg" in (tmp_path / "bench.html").read_text()


def test_ablate_says_when_there_is_nothing_to_leave_out():
    """A graph without spokes and controls is measured as it is."""
    done = called(ablate, "stereo_sgm", "b/sphere/checker", "--size", 64)
    assert done.exit_code == 0
    assert "nothing to leave out" in done.stdout


def test_demo_prints_where_the_report_is(tmp_path):
    """One line on stdout, a path that exists; how it compares with the truth goes to stderr."""
    done = called(demo, "--out", tmp_path / "run", "--size", 96)
    assert done.exit_code == 0
    assert done.stdout.strip() == str((tmp_path / "run" / "report.html").resolve())
    assert (tmp_path / "run" / "depth.pfm").exists()
    assert "bad-2.0" in done.stderr


def test_a_page_escapes_what_it_is_given():
    """Names cannot become markup."""
    assert "<script>" not in page.table(["<script>"], [["<script>"]])
