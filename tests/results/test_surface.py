"""The surface in the report: its grid gives the points back; drawings of plugins are pictures and no more."""

from __future__ import annotations

import base64
import dataclasses
import json
import re
from html import unescape

import numpy as np
import pytest

from visint.fields.geometry import back_project
from visint.hookspecs import hookimpl
from visint.results.report import report


def grid_of(page):
    """What the page says of the grid, and its heights with unknown NaN."""
    told = json.loads(unescape(re.search(r'data-grid="([^"]*)"', page)[1]))
    data = base64.b64decode(re.search(r'data-heights="([^"]*)"', page)[1])
    words = np.frombuffer(data, "<u2").reshape(told["rows"], told["columns"])
    heights = told["low"] + (told["high"] - told["low"]) * (words.astype(float) - 1) / 65533
    return told, np.where(words == 0, np.nan, heights)


class TestGrid:
    def test_points_come_back(self, met):
        """As the script makes them: within a ten-thousandth of the depth."""
        told, nearness = grid_of(report(met))
        assert (told["model"], told["step"]) == ("perspective", 1)
        z = 1 / nearness
        v, u = np.mgrid[: told["rows"], : told["columns"]] * told["step"]
        points = np.stack([(u - told["cx"]) * z / told["f"], (v - told["cy"]) * z / told["f"], z], axis=-1)
        truth = back_project(met["depth"], met.camera)
        drawn = np.isfinite(z)
        assert drawn.mean() > 0.95
        assert np.abs(points - truth)[drawn].max() < 1e-4 * np.nanmax(met["depth"])

    def test_large_maps_are_thinned(self, met, toys):
        """720p becomes at most 320 columns, of pixels that are there."""
        depth = 500 + 100 * toys.scene(720, 1280)
        camera = toys.camera((720, 1280))
        result = dataclasses.replace(
            met, outputs={"depth": depth}, kinds={"depth": "Depth"}, inputs={"camera": camera}, confidence={}
        )
        told, nearness = grid_of(report(result))
        assert (told["rows"], told["columns"], told["step"]) == (180, 320, 4)
        np.testing.assert_allclose(1 / nearness, depth[::4, ::4], rtol=1e-4)

    def test_unknown_and_wild_depth_is_left_open(self, met):
        """NaN, and what lies far outside the rest."""
        depth = np.full((20, 30), 500, np.float32)
        depth += np.linspace(0, 50, 30, dtype=np.float32)
        depth[3, 4], depth[5, 6] = np.nan, 1e6
        result = dataclasses.replace(met, outputs={"depth": depth}, kinds={"depth": "Depth"}, confidence={})
        _, nearness = grid_of(report(result))
        assert np.isnan(nearness[3, 4])
        assert np.isnan(nearness[5, 6])
        assert np.isnan(nearness).sum() == 2

    def test_a_plane_without_any_range(self, met):
        depth = np.full((20, 30), 500, np.float32)
        result = dataclasses.replace(met, outputs={"depth": depth}, kinds={"depth": "Depth"}, confidence={})
        np.testing.assert_allclose(1 / grid_of(report(result))[1], 500, rtol=1e-4)

    def test_a_relief_is_seen_in_parallel(self, met):
        """A quarter as high as wide, and said to be: its scale is not known."""
        relief = np.linspace(-1, 1, 40, dtype=np.float32) + np.zeros((30, 1), np.float32)
        result = dataclasses.replace(met, outputs={"relief": relief}, kinds={"relief": "Relief"}, confidence={})
        page = report(result)
        told, heights = grid_of(page)
        assert told["model"] == "parallel"
        assert told["high"] - told["low"] == 10
        assert "known up to scale and tilt" in page
        assert np.nanmin(np.diff(heights, axis=1)) > 0

    @pytest.mark.parametrize("depth", [np.full((6, 8), np.nan, np.float32), np.ones((1, 8), np.float32)])
    def test_nothing_to_draw_is_no_section(self, met, depth):
        result = dataclasses.replace(met, outputs={"depth": depth}, kinds={"depth": "Depth"}, confidence={})
        assert 'class="surface"' not in report(result)


HOSTILE = b'<svg xmlns="http://www.w3.org/2000/svg" onload="alert(1)"><script>alert(1)</script></svg>'


class Draws:
    """A plugin whose writer draws."""

    visint_contract = 1
    drawn = HOSTILE
    names = ("depth",)

    @hookimpl
    def visint_writers(self):
        return {"Depth": lambda name, value: {f"{one}.svg": self.drawn for one in self.names} | {"x.txt": b""}}


class TestDrawings:
    def page(self, toys, plugin):
        where = toys.catalog({"pen": plugin})
        where.plugin("pen")  # a plugin is asked once something of it is used
        return report(toys.run_in(toys.CUE, where, image=toys.scene(8, 9)))

    def test_a_drawing_is_a_picture_of_its_bytes(self, toys):
        """As the source of an image nothing in it runs; no byte of it stands in the page itself."""
        page = self.page(toys, Draws())
        source = re.search(r'src="data:image/svg\+xml;base64,([^"]*)"', page)[1]
        assert base64.b64decode(source, validate=True) == HOSTILE
        assert "alert" not in page
        assert "Drawing depth.svg" in page

    def test_drawings_that_are_too_large_together(self, toys):
        """The first two fit, the third is named: a report has its bound whatever plugins draw."""
        plugin = Draws()
        plugin.names = ("a", "b", "c")
        plugin.drawn = b"<svg>" + b" " * 390_000
        page = self.page(toys, plugin)
        assert page.count("image/svg") == 2
        assert "<strong>c.svg</strong> too large" in page

    def test_a_drawing_that_is_too_large_is_named(self, toys):
        plugin = Draws()
        plugin.drawn = b"<svg>" + b" " * 500_000
        page = self.page(toys, plugin)
        assert "image/svg" not in page
        assert "too large for the report" in page
