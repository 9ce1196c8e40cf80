"""The report: one page that holds everything, asks the network for nothing and cannot be injected into."""

from __future__ import annotations

import base64
import dataclasses
import hashlib
import json
import re
from html.parser import HTMLParser
from itertools import pairwise

import numpy as np
import pytest

from visint.fields import DepthEvidence, NormalsEvidence, SlopesEvidence
from visint.hookspecs import hookimpl
from visint.module import Module, Params, Ports
from visint.results import Measure, Record, Stop, Turn, Warned, pictures
from visint.results.report import report
from visint.results.report.maps import Map, figure
from visint.results.report.page import MOST_BYTES

VOID = {"meta", "link", "img", "br", "rect", "line", "polyline", "circle", "stop"}
HOSTILE = "\"><script>alert(1)</script><img src=x onerror=alert(1)>'&amp;${style}</style>"


class Page(HTMLParser):
    """A page taken apart: every element with its attributes, every text; refuses tags that do not close."""

    def __init__(self, text):
        super().__init__()
        self.elements, self.open, self.texts = [], [], []
        self.feed(text)
        self.close()
        assert not self.open

    def handle_starttag(self, tag, attrs):
        assert len(dict(attrs)) == len(attrs), f"an attribute twice in <{tag}>"
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] not in ("style", "script"):
            self.texts.append(data)

    @property
    def text(self):
        return " ".join(" ".join(self.texts).split())

    def all(self, tag):
        return [attrs for name, attrs in self.elements if name == tag]


@pytest.fixture(scope="module")
def met_page(met):
    return report(met)


@pytest.fixture(scope="module")
def taken(met_page):
    return Page(met_page)


class TestWhatItTells:
    def test_title_and_about(self, taken):
        assert "meeting – visint report" in taken.text
        assert "Two toy cues meet in the map." in taken.text

    def test_every_section_that_has_something_to_say(self, taken):
        names = [section["id"] for section in taken.all("section")]
        assert names == [
            *("warnings", "inputs", "surface", "outputs", "evidence", "assumptions", "convergence"),
            *("timings", "measures", "graph", "versions"),
        ]

    def test_each_map_is_a_picture_with_words(self, met_page, toys):
        """Inputs, outputs, each confidence once, and three pictures a spoke; keys of normals beside them."""
        alts = [alt for alt, _ in toys.pictures(met_page) if not alt.startswith("Key")]
        assert [alt.split(":")[0] for alt in alts] == [
            *("Image left", "Image right"),
            *("Depth depth", "Normals normals", "Boundaries boundaries", "Regions regions"),
            *("Confidence depth_confidence", "Disparity disparity"),
            "Confidence confidence of depth, normals and disparity",
            "Confidence confidence of boundaries and regions",
            *("Boundaries value", "Sigma sigma", "Confidence reliability"),
            *("Depth value", "Sigma sigma", "Confidence reliability"),
            *("Disparity value", "Sigma sigma", "Confidence reliability"),
        ]

    def test_range_unit_and_share_of_the_known(self, toys):
        """A black and a white half are at depth 2 and 1; without a camera the unit is relative."""
        image = np.zeros((4, 8), np.float32)
        image[:, 4:] = 1
        image[0] = np.nan
        page = report(toys.run(toys.CUE, image=image))
        assert "1 to 2 relative, 75 % known" in page
        assert "Colour bar: blue is 1 relative, red is 2 relative" in page

    def test_depth_has_the_cameras_unit_and_disparity_pixels(self, met_page):
        assert re.search(r"Depth depth: [\d.]+ to [\d.]+ mm, 100 % known", met_page)
        assert re.search(r"Disparity disparity: [\d.]+ to [\d.]+ px, 100 % known", met_page)

    def test_kinds_of_boundary_are_counted_and_keyed(self):
        """A key names the kinds that there are, no other; a map without any says so."""
        kinds = np.array([[0, 1, 1], [0, 5, 0]], np.uint8)
        page = str(figure(Map("kinds", "BoundaryKinds", kinds), 100))
        assert "2 pixels limb, 1 pixel mark" in page
        assert "swatch limb" in page
        assert "swatch convex" not in page
        assert "no boundaries" in str(figure(Map("kinds", "BoundaryKinds", 0 * kinds), 100))

    def test_why_each_loop_ended(self, taken):
        assert taken.text.count("map.depth changed by less than 0.001") == 3
        assert "every level was done" in taken.text
        assert "Relative change of map.depth per turn of sweeps" in taken.text

    def test_a_line_a_level(self, met, taken):
        """One point a turn that was compared; the bound is drawn too."""
        lines = [line["points"].split() for line in taken.all("polyline")]
        assert len(lines) == 3
        assert sum(map(len, lines)) == len(met.trace)
        assert [line for line in taken.all("line") if line.get("class") == "bound"]

    def test_calls_and_a_bar_a_node(self, met, taken):
        bars = [bar for bar in taken.all("rect") if bar.get("height") == "8" and "fill" not in bar]
        shares = [float(bar["width"]) for bar in bars]
        assert len(shares) == len({timing.node for timing in met.record.timings()})
        assert max(shares) == 100
        calls = sum(timing.calls for timing in met.record.timings())
        assert f"called {calls} times" in taken.text

    def test_warnings_in_words_and_measures(self, taken):
        assert "this is only a toy" in taken.text
        assert "measured seen 0 1 1 1" in taken.text

    def test_the_graph_its_parameters_and_versions(self, met, taken):
        assert " ".join(met.graph.to_yaml().split()) in taken.text
        assert " ".join(met.graph.expanded().split()) in taken.text
        assert "near: 700.0" in taken.text
        for library in ("numpy", "pluggy", "python"):
            assert library in taken.text

    def test_inputs_that_are_no_images(self, taken):
        assert "light Light not given" in taken.text
        assert "baseline 100" in taken.text

    def test_the_same_run_gives_the_same_page(self, toys, met):
        """But for the timings, which are made equal here."""
        again = toys.meeting()
        timed = dataclasses.replace(again.record, seconds=met.record.seconds)
        assert report(dataclasses.replace(again, record=timed, seconds=met.seconds)) == report(met)


class TestPictures:
    def test_every_picture_decodes_at_its_stated_size(self, met_page, taken, toys):
        shown = toys.pictures(met_page)
        sizes = [(int(image["height"]), int(image["width"])) for image in taken.all("img")]
        assert len(shown) == len(sizes) > 15
        assert [picture.shape[:2] for _, picture in shown] == sizes

    def test_pixels_are_those_of_the_map(self, met, met_page, toys):
        """Small pictures are kept without loss."""
        shown = dict(toys.pictures(met_page))
        depth = next(picture for alt, picture in shown.items() if alt.startswith("Depth depth"))
        np.testing.assert_array_equal(depth, pictures.of_scalar(met["depth"], *pictures.span(met["depth"])))
        left = next(picture for alt, picture in shown.items() if alt.startswith("Image left"))
        np.testing.assert_array_equal(left, pictures.of_image(met.inputs["left"]))

    def test_unknown_pixels_are_grey_and_said_to_be(self, toys):
        image = toys.scene(12, 16)
        image[3:6, 2:9] = np.nan
        page = report(toys.run(toys.CUE, image=image))
        shown = next(picture for alt, picture in toys.pictures(page) if alt.startswith("Depth"))
        assert (shown[3:6, 2:9] == pictures.UNKNOWN).all()
        assert not (shown[8:] == pictures.UNKNOWN).all(axis=-1).any()
        assert 'class="swatch unknown"' in page

    def test_large_pictures_are_reduced(self, toys):
        page = report(toys.run(toys.CUE, image=np.full((30, 2600), 0.5, np.float32)))
        assert {picture.shape[1] for _, picture in toys.pictures(page)} == {
            1280,
            480,
        }  # evidence is shown small

    def test_720p_stays_below_three_megabytes(self, met):
        """Noise everywhere is the worst that can come: pictures are reduced until the page fits."""
        rng = np.random.default_rng(0)
        noise = rng.random((720, 1280), np.float32)
        said = DepthEvidence.of(noise, noise + 0.1, noise)
        result = dataclasses.replace(
            met,
            inputs={**met.inputs, "left": noise, "right": noise},
            outputs={f"map{i}": noise for i in range(4)},
            kinds={f"map{i}": "Depth" for i in range(4)},
            confidence={"map0": noise},
            evidence={"one": said, "two": said},
        )
        page = report(result)
        assert 1_000_000 < len(page.encode()) <= MOST_BYTES == 3_000_000

    def test_smooth_maps_at_720p_keep_every_pixel(self, toys, met):
        image = toys.scene(720, 1280)
        result = dataclasses.replace(
            met,
            inputs={**met.inputs, "left": image, "right": image},
            outputs={"depth": image},
            kinds={"depth": "Depth"},
            confidence={"depth": image},
            evidence={},
        )
        page = report(result)
        assert len(page.encode()) < MOST_BYTES
        assert {shape[:2] for shape in (p.shape for _, p in toys.pictures(page))} == {(720, 1280)}


class TestOffline:
    def test_it_asks_for_nothing(self, taken):
        """Addresses are data or places in the page; no frame, form or handler is there."""
        forbidden = {"iframe", "object", "embed", "form", "input", "base", "audio", "video"}
        assert not forbidden & {tag for tag, _ in taken.elements}
        for tag, attrs in taken.elements:
            assert not [name for name in attrs if name.startswith("on")]
            for name in ("src", "href", "xlink:href", "action", "srcset", "poster"):
                assert attrs.get(name, "#").startswith(("data:", "#")), (tag, attrs[name])

    def test_the_style_asks_for_nothing(self, met_page):
        styles = re.findall(r"<style>(.*?)</style>", met_page, re.DOTALL)
        assert len(styles) == 2  # the page's and the drawing's
        assert not [style for style in styles if re.search(r"url\(|@import|https?:|//", style)]

    def test_its_one_script_is_named_by_its_digest(self, met_page, taken):
        """The policy forbids every other, and this one knows no way to the network and none to run text."""
        (script,) = re.findall(r"<script>(.*?)</script>", met_page, re.DOTALL)
        assert taken.all("script") == [{}]
        digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
        assert f"script-src 'sha256-{digest}';" in met_page
        network, text = (
            r"fetch|XMLHttp|WebSocket|import\(|localStorage|cookie",
            r"eval|Function\(|HTML|\.write\(",
        )
        assert not re.search(f"{network}|{text}", script)
        assert "</" not in script

    def test_its_policy_forbids_the_rest(self, taken):
        policy = next(meta["content"] for meta in taken.all("meta") if "http-equiv" in meta)
        parts = dict(part.strip().split(" ", 1) for part in policy.split(";"))
        assert parts["default-src"] == "'none'"
        assert parts["img-src"] == "data:"
        assert parts["script-src"].startswith("'sha256-")
        assert "unsafe-inline" not in parts["script-src"]


class TestAccess:
    def test_headings_descend_one_by_one(self, taken):
        levels = [int(tag[1]) for tag, _ in taken.elements if re.fullmatch("h[1-6]", tag)]
        assert levels.count(1) == 1
        assert all(after - before <= 1 for before, after in pairwise(levels))

    def test_landmarks_and_language(self, taken):
        for tag in ("header", "nav", "main", "footer"):
            assert len(taken.all(tag)) == 1
        assert taken.all("html") == [{"lang": "en"}]

    def test_names_point_to_what_is_there_once(self, taken):
        ids = [attrs["id"] for _, attrs in taken.elements if "id" in attrs]
        assert len(set(ids)) == len(ids)
        pointed = [a["href"][1:] for a in taken.all("a")]
        pointed += [attrs["aria-labelledby"] for _, attrs in taken.elements if "aria-labelledby" in attrs]
        pointed += [rect["fill"][5:-1] for rect in taken.all("rect") if "fill" in rect]
        assert set(pointed) <= set(ids)

    def test_everything_seen_is_also_said(self, taken):
        """Pictures have words, drawings a label or are ornaments, tables captions and heads of rows."""
        assert all(image["alt"] for image in taken.all("img"))
        assert all("aria-label" in svg or svg.get("aria-hidden") == "true" for svg in taken.all("svg"))
        assert len(taken.all("caption")) == len(taken.all("table"))
        assert {head["scope"] for head in taken.all("th")} == {"row", "col"}

    def test_what_scrolls_can_be_reached_by_keyboard(self, taken):
        wide = [div for div in taken.all("div") if div.get("class") == "wide"]
        assert wide
        assert all(div["tabindex"] == "0" and div["role"] == "region" and div["aria-label"] for div in wide)


class Nothing(Ports):
    """No port."""


class Shouts(Module[Params, Nothing, Nothing]):
    """A toy that warns and measures in hostile words."""

    name = "shouts"
    version = HOSTILE

    def run(self, inputs, ctx):
        ctx.warn(HOSTILE, HOSTILE)
        ctx.measure(HOSTILE, float("nan"))
        return Nothing()


class Stranger:
    """The plugin that brings it."""

    visint_contract = 1

    @hookimpl
    def visint_modules(self):
        return [Shouts]


class TestHostile:
    def page(self, toys):
        graph = (
            f"visint: 1\nname: shouting\nabout: {json.dumps(HOSTILE)}\ninputs: {{said: Text, image: Image}}\n"
        )
        graph += "nodes: {shout: {uses: mad.shouts}, cue: {uses: toy.cue, in: {image: inputs.image}}}\n"
        graph += "outputs: {depth: cue.evidence}"
        image = toys.scene(8, 9)
        result = toys.run(graph, {"mad": Stranger()}, said=HOSTILE, image=image)
        record = Record(
            turns=[Turn(HOSTILE, 0, 1, 0.5)],
            stops=[Stop(HOSTILE, 0, 2, "held")],
            warnings=[*result.warnings, Warned(HOSTILE, 0, 0, HOSTILE, HOSTILE)],
            measures=[*result.measures, Measure(HOSTILE, 0, 0, HOSTILE, float("inf"))],
        )
        record.seconds[HOSTILE, 0] = [1, 0.5]
        return report(
            dataclasses.replace(
                result,
                outputs={HOSTILE: image, "said": HOSTILE, "depth": result["depth"]},
                kinds={HOSTILE: HOSTILE, "said": "Text", "depth": "Depth"},
                confidence={HOSTILE: image},
                evidence={HOSTILE: DepthEvidence.of(image, 1.0, 1.0)},
                record=record,
            )
        )

    def test_names_and_texts_stay_text(self, toys):
        page = self.page(toys)
        taken = Page(page)
        assert page.count("<script") == len(taken.all("script")) == 1
        assert "alert(1)" not in page.partition("<script>")[2]
        assert not [attrs for _, attrs in taken.elements if "onerror" in attrs]
        assert all(image["src"].startswith("data:image/") for image in taken.all("img"))
        assert taken.text.count(" ".join(HOSTILE.split())) >= 10

    def test_nothing_is_filled_in_twice(self, toys):
        """A text that looks like a place in the template is a text."""
        page = self.page(toys)
        assert page.count("color-scheme: light dark;") == 1
        assert "${style}" in page


class TestDegenerate:
    @pytest.mark.parametrize("size", [(1, 1), (1, 40), (40, 1)])
    def test_thin_images(self, toys, size):
        page = report(toys.run(toys.CUE, image=toys.scene(*size), camera=toys.camera(size)))
        assert all(picture.size for _, picture in toys.pictures(page))
        Page(page)

    def test_nothing_is_known(self, toys):
        image = np.full((6, 8), np.nan, np.float32)
        page = report(toys.run(toys.CUE, image=image, camera=toys.camera((6, 8))))
        assert "nothing is known" in page
        shown = [picture for alt, picture in toys.pictures(page) if alt.startswith(("Depth", "Normals"))]
        assert len(shown) == 3  # as output, as what the cue said, and normals
        assert all((picture == pictures.UNKNOWN).all() for picture in shown)

    def test_a_constant_needs_no_colour_bar(self, toys):
        page = report(toys.run(toys.CUE, image=np.ones((6, 8), np.float32)))
        assert "1 relative everywhere" in page
        assert "Colour bar" not in page

    def test_numbers_alone(self, toys):
        taken = Page(report(toys.run(toys.SCALARS)))
        assert not taken.all("img")
        assert "answer Scalar 2.5" in taken.text
        assert "inputs" not in [section["id"] for section in taken.all("section")]

    def test_empty_and_odd_outputs(self, met):
        """No kind is a reason to fail: vectors, empty arrays, unknown kinds, objects, infinite numbers."""
        outputs = {
            "slopes": np.ones((4, 5, 2), np.float32),
            "features": np.zeros((4, 5, 7), np.float32),
            "empty": np.zeros((0, 5), np.float32),
            "flow": np.full((4, 5, 2), np.inf, np.float32),
            "labels": np.arange(20, dtype=np.int64).reshape(4, 5),
            "flags": np.ones((4, 5, 2), bool),
            "weights": np.linspace(0, 1, 3),
            "long": np.zeros(99),
            "thing": object(),
            "yes": True,
            "endless": float("inf"),
            "unknown": float("nan"),
        }
        kinds = {name: name.title() for name in outputs} | {"flow": "flow.Flow"}
        text = Page(report(dataclasses.replace(met, outputs=outputs, kinds=kinds, confidence={}))).text
        for said in (
            "slopes · 1.414 mm/px everywhere",
            "empty Empty float32 array of 0 × 5",
            "weights Weights 0, 0.5, 1",
            "long Long float64 array of 99",
            "thing Thing an object of class object",
            "yes Yes yes",
            "endless Endless ∞",
            "unknown Unknown unknown",
        ):
            assert said.replace(" · ", " ") in text

    def test_evidence_of_vectors(self, met):
        """Normals are said in colours, their sigma in radians; slopes by their length."""
        value = np.zeros((4, 5, 3), np.float32)
        value[..., 2] = -1
        said = {
            "normals": NormalsEvidence.of(value, 0.1, 1.0),
            "slopes": SlopesEvidence.of(
                value[..., :2], np.linspace(1, 2, 20, dtype=np.float32).reshape(4, 5), 1.0
            ),
        }
        text = Page(report(dataclasses.replace(met, evidence=said))).text
        assert "0.1 rad everywhere" in text
        assert "1 to 2 mm/px" in text

    def test_a_run_that_took_no_time(self, met):
        record = Record()
        record.seconds["shade", 0] = [1, 0.0]
        assert "0 ms" in report(dataclasses.replace(met, record=record, seconds=0.0))

    def test_a_change_of_zero_and_of_nothing(self, met):
        """0 has no logarithm and NaN no place: the first lies on the floor, the second is left out."""
        turns = [Turn("sweeps", 0, 1, float("nan")), Turn("sweeps", 0, 2, 0.5), Turn("sweeps", 0, 3, 0.0)]
        record = Record(turns=turns, stops=[Stop("sweeps", 0, 4, "exhausted")])
        taken = Page(report(dataclasses.replace(met, record=record)))
        (line,) = taken.all("polyline")
        assert len(line["points"].split()) == 2
        assert "it did not converge" in taken.text
