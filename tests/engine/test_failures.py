"""Failures: each names node, module, version, level and turn; nothing is printed, nothing is left behind."""

from __future__ import annotations

import threading

import numpy as np
import pytest

from visint.arrays import Array, Image
from visint.engine import Options, run
from visint.errors import InputError, ModuleError
from visint.events import NodeFailed, RunFinished
from visint.fields import DepthEvidence
from visint.module import Module, Params, Ports
from visint.testing.toys.images import ImagePorts
from visint.testing.toys.scalars import MaybeValue, Value


class Thumb(Module[Params, ImagePorts, ImagePorts]):
    """Half the size of what it says."""

    name = "thumb"
    version = "2.7"

    def run(self, inputs, ctx):
        return ImagePorts(image=inputs.image[::2, ::2])


class ListPorts(Ports):
    images: tuple[Image[Array, "H W"], ...]


class ThumbOfMany(Module[Params, ListPorts, ImagePorts]):
    """Half the size of a list of images."""

    name = "thumb_of_many"

    def run(self, inputs, ctx):
        return ImagePorts(image=inputs.images[0][::2])


class Odd(Module[Params, ImagePorts, ImagePorts]):
    """Gives the outputs of something else."""

    name = "odd"

    def run(self, inputs, ctx):
        return {"image": inputs.image}


class Exits(Module[Params, MaybeValue, Value]):
    name = "exits"

    def run(self, inputs, ctx):
        raise SystemExit(3)


class Reads(Module[Params, MaybeValue, Value]):
    name = "reads"

    def run(self, inputs, ctx):
        raise InputError.of("VI302", "the table is broken")


class Presses(Module[Params, MaybeValue, Value]):
    name = "presses"

    def run(self, inputs, ctx):
        raise KeyboardInterrupt


class EvidenceOutputs(Ports):
    evidence: DepthEvidence


class SmallEvidence(Module[Params, ImagePorts, EvidenceOutputs]):
    name = "small_evidence"

    def run(self, inputs, ctx):
        return EvidenceOutputs(evidence=DepthEvidence.of(inputs.image[1:], 1.0, 1.0))


@pytest.fixture
def own(stage):
    stage.modules(own=[Thumb, ThumbOfMany, Odd, Exits, Reads, Presses, SmallEvidence])
    return stage


def one_node(uses, port="image", out="image", params=""):
    source = "[inputs.left]" if port == "images" else "inputs.left"
    return f"""
inputs: {{left: Image}}
nodes: {{culprit: {{uses: {uses}, in: {{{port}: {source}}}{params}}}}}
outputs: {{out: culprit.{out}}}
"""


class TestWhatIsNamed:
    def test_node_module_version_level_and_turn(self, stage, image):
        """A number that grows to 5 breaks the module at level 1, turn 1; the message says all of it."""
        with pytest.raises(ModuleError) as caught:
            stage.run(
                """
inputs: {left: Image}
loops: {levels: {over: pyramid, levels: 3}, turns: {inside: levels, times: 3}}
nodes:
  count: {uses: toy.counter, loop: turns, feedback: {value: {from: count.value}}}
  culprit: {uses: toy.fail, loop: turns, with: {at: 5, message: it is five}, in: {value: count.value}}
outputs: {out: culprit.value}
""",
                {"left": image},
            )
        (problem,) = caught.value.problems
        assert problem.code == "VI401"
        assert problem.fault == "plugin"
        assert "RuntimeError: it is five" in problem.found
        assert problem.where.path.startswith("node 'culprit', toy.fail (version 1")
        assert problem.where.path.endswith("level 1, turn 1")
        assert caught.value.exit_code == 4
        assert isinstance(caught.value.__cause__, RuntimeError)
        (failed,) = stage.of(NodeFailed)
        assert failed[:3] == ("culprit", 1, 1)
        assert stage.events[-1] == RunFinished("staged", stage.events[-1].seconds, failed=True)

    def test_version_of_the_module(self, own, image):
        with pytest.raises(ModuleError, match=r"node 'culprit', own\.thumb \(version 2\.7 of given in code\)"):
            own.run(one_node("own.thumb"), {"left": image})

    def test_an_error_of_visint_in_a_module_keeps_its_class_and_gets_a_place(self, own):
        """A module that meets a broken resource raises InputError; that it was this node is said, too."""
        with pytest.raises(InputError, match=r"VI302 node 'culprit', own.reads.*the table is broken"):
            own.run("nodes: {culprit: {uses: own.reads}}\noutputs: {out: culprit.value}")

    def test_exit_is_an_error_of_the_module(self, own):
        """A module that calls sys.exit does not end the program."""
        with pytest.raises(ModuleError, match=r"VI401.*culprit.*SystemExit: 3"):
            own.run("nodes: {culprit: {uses: own.exits}}\noutputs: {out: culprit.value}")

    def test_keyboard_interrupt_passes_through(self, own):
        """Ctrl-C is nobody's failure."""
        with pytest.raises(KeyboardInterrupt):
            own.run("nodes: {culprit: {uses: own.presses}}\noutputs: {out: culprit.value}")
        assert own.events[-1].failed


class TestWrongOutputs:
    @pytest.mark.parametrize(
        ("what", "said"),
        [
            ("dtype", "image wants Image float32.*this array is float64"),
            ("axes", r"this array has shape \(21, 13, 1\)"),
            ("type", "this is a list, not a numpy array"),
            ("port", "picture"),
            ("size", "H is 21 on port 'image' but 20 on port 'other'"),
        ],
    )
    def test_are_told_apart(self, stage, image, what, said):
        """A wrong dtype, axes, type, port or size is VI402, with what was wanted, and never the numbers."""
        with pytest.raises(ModuleError, match=f"VI402 node 'culprit', toy.wrong.*{said}") as caught:
            stage.run(one_node("toy.wrong", params=f", with: {{what: {what}}}"), {"left": image})
        assert str(image[0, 0])[:6] not in str(caught.value)

    def test_half_the_size_of_the_inputs(self, own, image):
        """Outputs that name the inputs' dims have the inputs' size."""
        with pytest.raises(
            ModuleError, match=r"VI402.*culprit.*H is 21 on input 'image' but 11 on output 'image'"
        ):
            own.run(one_node("own.thumb"), {"left": image})

    def test_half_the_size_of_a_list_of_inputs(self, own, image):
        """Lists name dims like any other port."""
        with pytest.raises(ModuleError, match=r"VI402.*H is 21 on input 'images' but 11 on output 'image'"):
            own.run(one_node("own.thumb_of_many", port="images"), {"left": image})

    def test_evidence_of_another_size(self, own, image):
        with pytest.raises(ModuleError, match=r"VI402.*H is 21 on input 'image' but 20 on output 'evidence'"):
            own.run(one_node("own.small_evidence", out="evidence"), {"left": image})

    def test_no_outputs_at_all(self, own, image):
        with pytest.raises(ModuleError, match=r"VI402.*run returned dict; it must return ImagePorts"):
            own.run(one_node("own.odd"), {"left": image})


class TestAliasing:
    TEXT = """
inputs: {{left: Image}}
nodes:
  base: {{uses: toy.image, in: {{image: inputs.left}}}}
  pen: {{uses: toy.scribble, in: {{image: {source}}}}}
  witness: {{uses: toy.image, in: {{image: {source}}}}}
outputs: {{pen: pen.image, witness: witness.image}}
"""

    @pytest.mark.parametrize("source", ["base.image", "inputs.left"])
    def test_writing_into_an_input_is_refused(self, stage, image, source):
        """It names the module; neither the caller's array nor a sibling's input changes."""
        before = image.copy()
        with pytest.raises(ModuleError, match=r"VI403 node 'pen', toy.scribble.*wrote into one of its inputs"):
            stage.run(self.TEXT.format(source=source), {"left": image})
        np.testing.assert_array_equal(image, before)
        assert image.flags.writeable

    def test_inputs_that_do_not_fit_each_other_are_told_at_the_node(self, stage, image):
        """A half-size image of a node beside a full-size one is refused before the module sees them."""
        text = """
inputs: {left: Image, right: Image}
nodes:
  same: {uses: toy.image, in: {image: inputs.right}}
  mean: {uses: toy.stack, in: {images: [inputs.left, same.image]}}
outputs: {out: mean.image}
"""
        with pytest.raises(ModuleError, match=r"VI402 node 'mean', toy.stack.*H is 21 .* but 10"):
            stage.run(text, {"left": image, "right": image[:10]})

    def test_graph_inputs_that_meet_in_a_node_are_compared_before_anything_runs(self, stage, image):
        """Sizes of inputs that one node takes must agree: the input's fault, not a plugin's."""
        text = """
inputs: {left: Image, right: Image}
nodes: {mean: {uses: toy.stack, in: {images: [inputs.left, inputs.right]}}}
outputs: {out: mean.image}
"""
        with pytest.raises(InputError, match="VI307: the inputs 'left' and 'right' are of different sizes"):
            stage.run(text, {"left": image, "right": image[:10]})


class TestAfterwards:
    def test_the_graph_runs_again(self, stage):
        """A failure leaves no state: the same graph gives the same failure, and its healthy twin its result."""
        graph = stage.graph("""
inputs: {x: Scalar}
loops: {turns: {times: 4}}
nodes:
  sum: {uses: toy.add, loop: turns, in: {a: inputs.x}, feedback: {b: {from: sum.sum, start: 0}}}
  culprit: {uses: toy.fail, loop: turns, with: {at: 10}, in: {value: sum.sum}}
outputs: {out: culprit.value}
""")
        for _ in range(2):
            with pytest.raises(ModuleError, match="turn 2"):
                stage.run(graph, {"x": 4.0})
            assert stage.run(graph, {"x": 1.0})["out"] == 4

    def test_nothing_is_printed_and_no_thread_lives_on(self, stage, image, capfd):
        before = threading.active_count()
        for threads in (1, 3):
            with pytest.raises(ModuleError):
                stage.run(one_node("toy.scribble"), {"left": image}, threads=threads)
        assert capfd.readouterr() == ("", "")
        assert threading.active_count() == before

    def test_an_observer_that_raises_is_not_blamed_on_a_module(self, stage):
        """What goes wrong in an observer comes out as it is."""

        def broken(event):
            raise LookupError("observer")

        with pytest.raises(LookupError, match="observer"):
            run(
                stage.graph("nodes: {one: {uses: toy.constant}}\noutputs: {out: one.value}"),
                options=Options(observers=(broken,)),
            )
