"""The contract's types: ports that agree, modules that say what they are, a context that can be trusted."""

from __future__ import annotations

from typing import Any, Generic, TypeVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from visint.arrays import SPECS, Array, Depth, Disparity, Image, Normals, Scalars
from visint.errors import Cancelled, ModuleError
from visint.fields import Camera, DepthEvidence, Light
from visint.module import Context, Module, Params, Ports, PortSpec


class Own:
    """A stranger's class."""


class FocusInputs(Ports):
    images: tuple[Image[Array, "H W"], ...]
    prior: Depth[Array, "H W"] | None = None
    evidence: tuple[DepthEvidence, ...] = ()


class Everything(Ports):
    image: Image[Array, "H W"]
    light: Light | None = None
    camera: Camera | None = None
    number: float = 1.0
    whole: int = 1
    flag: bool = True
    text: str = ""
    depth: DepthEvidence | None = None
    many: tuple[DepthEvidence, ...] = ()
    own: Own | None = None
    list_of_lights: tuple[Light, ...] = ()
    distances: Scalars[Array, "K"] | None = None


def image(rows, columns):
    return np.zeros((rows, columns), np.float32)


def evidence(rows, columns):
    return DepthEvidence.of(image(rows, columns) + 1, 0.1, 1.0)


class TestPortSpecs:
    @pytest.mark.parametrize(
        ("name", "spec"),
        [
            ("image", PortSpec("image", "Image", SPECS["Image"])),
            ("light", PortSpec("light", "Light", optional=True)),
            ("camera", PortSpec("camera", "Camera", optional=True)),
            ("number", PortSpec("number", "Scalar")),
            ("whole", PortSpec("whole", "Scalar")),
            ("flag", PortSpec("flag", "Flag")),
            ("text", PortSpec("text", "Text")),
            ("depth", PortSpec("depth", "Depth", SPECS["Depth"], optional=True, evidence=True)),
            ("many", PortSpec("many", "Depth", SPECS["Depth"], many=True, evidence=True)),
            ("list_of_lights", PortSpec("list_of_lights", "Light", many=True)),
        ],
    )
    def test_of_each_kind_of_port(self, name, spec):
        assert Everything.specs[name] == spec

    def test_a_strangers_class_is_named_in_full(self):
        assert Everything.specs["own"].kind == f"{__name__}.Own"

    def test_the_order_is_that_of_declaration(self):
        assert list(Everything.specs)[:3] == ["image", "light", "camera"]

    @pytest.mark.parametrize(
        ("name", "text"),
        [
            ("image", "Image float32 (H, W)"),
            ("light", "Light?"),
            ("depth", "Depth evidence?"),
            ("many", "[Depth evidence]"),
            ("list_of_lights", "[Light]"),
        ],
    )
    def test_words(self, name, text):
        assert str(Everything.specs[name]) == text

    def test_an_optional_list_says_so(self):
        class Lists(Ports):
            images: tuple[Image[Array, "H W"], ...] | None = None

        spec = Lists.specs["images"]
        assert spec.many
        assert spec.optional
        assert str(spec) == "[Image float32 (H, W)]?"

    @pytest.mark.parametrize(
        ("annotation", "complaint"),
        [
            (int | str, "a port has one kind, or one kind and None"),
            (tuple[float, float], r"a list of values is spelled tuple\[..., ...\]"),
            (Any, r'is no port type; write for instance Depth\[Array, "H W"\]'),
            (list[float], "is no port type"),
            (np.ndarray, "is no port type"),
            (Array, "is no port type"),
            ("Missing", "'Missing' is not known at run time; import it outside TYPE_CHECKING"),
            (dict[str, float], "is no port type"),
            (tuple, "is no port type"),
        ],
        ids=str,
    )
    def test_what_is_no_port(self, annotation, complaint):
        """Said when the class is made, with the port's name: not in the middle of a run."""
        with pytest.raises(TypeError, match=f"port 'odd': .*{complaint}"):
            type("Odd", (Ports,), {"__annotations__": {"odd": annotation}, "__module__": __name__})


class TestPortValues:
    def test_arrays_come_out_read_only(self):
        taken = FocusInputs(images=[image(2, 3)]).images
        assert isinstance(taken, tuple)
        assert not taken[0].flags.writeable

    def test_nothing_is_cast(self):
        with pytest.raises(ValidationError, match="wants Image float32"):
            Everything(image=np.zeros((2, 2)))

    def test_unknown_ports_are_refused(self):
        with pytest.raises(ValidationError, match="lihgt"):
            Everything(image=image(2, 2), lihgt=Light.unknown())

    def test_errors_never_show_an_array(self):
        """However small it is."""
        with pytest.raises(ValidationError) as refused:
            Everything(image=np.full((1, 1), 0.123456), number="x")
        assert "0.123456" not in str(refused.value)
        assert "input_value" not in str(refused.value)

    def test_ports_are_frozen(self):
        with pytest.raises(ValidationError, match="frozen"):
            Everything(image=image(2, 2)).number = 2

    @pytest.mark.parametrize("value", [2, 2.0, np.float64(2), np.float32(2)])
    def test_numbers_of_every_width(self, value):
        taken = Everything(image=image(1, 1), number=value).number
        assert taken == 2
        assert isinstance(taken, float)


class TestDimsAgree:
    def test_a_half_size_prior_beside_full_size_images_is_refused(self):
        """Both sizes and both ports are named; pydantic's own types would let it pass."""
        with pytest.raises(ValidationError, match="H is 8 on port 'images' but 4 on port 'prior'"):
            FocusInputs(images=(image(8, 6), image(8, 6)), prior=image(4, 3))

    def test_columns_too(self):
        with pytest.raises(ValidationError, match="W is 6 on port 'images' but 5 on port 'prior'"):
            FocusInputs(images=(image(8, 6),), prior=image(8, 5))

    def test_within_a_list(self):
        with pytest.raises(ValidationError, match="H is 8 on port 'images' but 7 on port 'images'"):
            FocusInputs(images=(image(8, 6), image(8, 6), image(7, 6)))

    def test_evidence_and_lists_of_evidence(self):
        with pytest.raises(ValidationError, match="H is 8 on port 'images' but 4 on port 'evidence'"):
            FocusInputs(images=(image(8, 6),), evidence=(evidence(8, 6), evidence(4, 6)))

    def test_what_agrees_or_is_not_there_is_taken(self):
        FocusInputs(images=(image(8, 6),))
        FocusInputs(images=(), prior=image(4, 4))
        FocusInputs(images=(image(8, 6),), prior=image(8, 6), evidence=(evidence(8, 6),))

    def test_one_array_may_name_a_dim_twice(self):
        class Square(Ports):
            image: Image[Array, "N N"]

        Square(image=image(3, 3))
        with pytest.raises(ValidationError, match="N is 3 on port 'image' but 4 on port 'image'"):
            Square(image=image(3, 4))

    def test_other_names_are_other_dims(self):
        class Two(Ports):
            fine: Image[Array, "H W"]
            coarse: Image[Array, "h w"]

        Two(fine=image(8, 6), coarse=image(4, 3))

    def test_a_list_of_a_dim_nobody_else_names(self):
        class Alone(Ports):
            images: tuple[Image[Array, "H W"], ...]

        with pytest.raises(ValidationError, match="W is 3"):
            Alone(images=(image(2, 3), image(2, 4)))

    def test_three_components_are_no_dim(self):
        class Both(Ports):
            normals: Normals[Array, "H W 3"]
            disparity: Disparity[Array, "H W"]

        Both(normals=np.zeros((3, 2, 3), np.float32), disparity=image(3, 2))

    def test_a_subclass_checks_its_own_ports_and_the_inherited(self):
        class More(FocusInputs):
            mask: Image[Array, "H W"]

        assert set(More.specs) == {*FocusInputs.specs, "mask"}
        with pytest.raises(ValidationError, match="on port 'mask'"):
            More(images=(image(8, 6),), mask=image(2, 2))

    @given(st.lists(st.tuples(st.integers(1, 3), st.integers(1, 3)), min_size=1, max_size=4))
    def test_a_list_is_taken_exactly_if_all_agree(self, sizes):
        images = tuple(image(*size) for size in sizes)
        if len(set(sizes)) == 1:
            FocusInputs(images=images)
        else:
            with pytest.raises(ValidationError):
                FocusInputs(images=images)


class ScaleParams(Params):
    factor: float = 2.0


class ScaleInputs(Ports):
    image: Image[Array, "H W"]


class Scale(Module[ScaleParams, ScaleInputs, ScaleInputs]):
    """A test's own module."""

    name = "scale"

    def run(self, inputs, ctx):
        return ScaleInputs(image=inputs.image * np.float32(self.params.factor))


class TestModule:
    def test_the_brackets_name_the_models(self):
        assert (Scale.Params, Scale.Inputs, Scale.Outputs) == (ScaleParams, ScaleInputs, ScaleInputs)

    def test_params_default_and_are_given(self):
        assert Scale().params == ScaleParams()
        assert Scale(ScaleParams(factor=3)).run(ScaleInputs(image=image(1, 1) + 1), Context()).image == 3

    def test_params_refuse_what_they_do_not_know(self):
        """A misspelled parameter must not be a default in silence."""
        with pytest.raises(ValidationError, match="facter"):
            ScaleParams(facter=3)
        with pytest.raises(ValidationError, match="frozen"):
            Scale().params.factor = 3

    def test_a_subclass_of_a_module_inherits_them(self):
        class Faster(Scale):
            name = "faster"

        assert Faster.Inputs is ScaleInputs
        assert Faster.version == "1"
        assert not Faster.per_turn

    def test_run_must_be_written(self):
        class Empty(Module[Params, ScaleInputs, ScaleInputs]):
            name = "empty"

        with pytest.raises(TypeError, match="abstract"):
            Empty()

    def test_the_bare_contract_can_be_params(self):
        """A module without parameters says `Params`, and still refuses any."""
        with pytest.raises(ValidationError):
            Params(anything=1)

    def test_a_generic_family_of_modules(self):
        """A class between Module and the modules may leave a model open; its subclasses fill it in."""
        some = TypeVar("some", bound=Params)

        class Family(Module[some, ScaleInputs, ScaleInputs], Generic[some]):
            def run(self, inputs, ctx):
                return inputs

        class Member(Family[ScaleParams]):
            name = "member"

        assert Member.Params is ScaleParams
        assert Member.Inputs is ScaleInputs
        assert Member().params.factor == 2

    @pytest.mark.parametrize("models", [(int, ScaleInputs, ScaleInputs), (Params, Params, ScaleInputs)])
    def test_the_brackets_hold_models(self, models):
        """Params, then two kinds of Ports: said when the class is made."""
        with pytest.raises(TypeError, match=r"Wrong: .* is no subclass of P\w+; write Module\[Params, Inputs"):

            class Wrong(Module[models]):
                name = "wrong"


class TestContext:
    def test_scale_is_two_to_the_level(self):
        assert [Context(level=level).scale for level in range(4)] == [1, 2, 4, 8]

    def test_check_is_silent_until_the_run_is_cancelled(self):
        Context().check()
        Context(cancelled=lambda: False).check()
        with pytest.raises(Cancelled, match="VI130"):
            Context(cancelled=lambda: True).check()

    def test_turn_is_that_of_the_innermost_loop(self):
        assert Context(turns=(4, 1)).turn == 1
        assert Context().turn == 0

    def test_only_a_module_that_says_so_may_ask_for_the_turn(self):
        """The engine lifts the others out of loops: what they read there would be wrong."""
        quiet = Context(per_turn=False)
        for ask in ("turn", "rng"):
            with pytest.raises(ModuleError, match=rf"VI403: ctx.{ask} is for .*\n  Write: per_turn = True"):
                getattr(quiet, ask)

    def test_random_numbers_are_the_runs_the_nodes_the_levels_and_the_turns(self):
        """Equal seeds, levels and turns give equal numbers; any other gives others."""

        def drawn(**where):
            return Context(**where).rng.random(3).tolist()

        first = drawn(seed=(1, 7), level=1, turns=(2, 3))
        assert first == drawn(seed=(1, 7), level=1, turns=(2, 3))
        others = [
            drawn(seed=(2, 7), level=1, turns=(2, 3)),
            drawn(seed=(1, 8), level=1, turns=(2, 3)),
            drawn(seed=(1, 7), level=2, turns=(2, 3)),
            drawn(seed=(1, 7), level=1, turns=(1, 3)),
            drawn(seed=(1, 7), level=1, turns=(2, 4)),
        ]
        assert all(first != other for other in others)

    def test_each_call_starts_anew(self):
        ctx = Context(seed=(3,))
        assert ctx.rng.random() == ctx.rng.random()

    def test_notes_reach_the_engine(self):
        notes = []
        ctx = Context(note=lambda *note: notes.append(note))
        ctx.measure("residual", np.float32(0.5))
        ctx.warn("no_texture", "nothing to match")
        assert notes == [("measure", "residual", 0.5), ("warning", "no_texture", "nothing to match")]
        assert type(notes[0][2]) is float

    def test_without_an_engine_nobody_listens(self):
        ctx = Context()
        ctx.measure("residual", 0.5)
        ctx.warn("no_texture", "nothing to match")
        assert ctx.size is None

    def test_it_has_no_room_for_state(self):
        """What a module keeps it returns; the context is no place for it."""
        with pytest.raises(AttributeError):
            Context().memory = 3
