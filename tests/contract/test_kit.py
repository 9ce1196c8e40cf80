"""The contract kit notices each offence, and nothing that is none."""

from __future__ import annotations

import importlib.util
import re
import sys
from pathlib import Path

import pytest

import visint.module
from visint.arrays import Array, Image
from visint.module import Context, Module, Params, Ports
from visint.testing import ModuleContract, sentences, watch

HERE = Path(__file__).parent


def load(name):
    """A file beside this one, as a module (the tests are no package)."""
    spec = importlib.util.spec_from_file_location(f"contract_{name}", HERE / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


OFFENDERS = load("offences").OFFENDERS
TESTS = [name for name in vars(ModuleContract) if name.startswith("test_")]


def failures(module, **attributes):
    """Test name → message of every test of the kit that this module fails."""
    contract = type("Contract", (ModuleContract,), {"module": module, **attributes})
    failed = {}
    for name in TESTS:
        try:
            getattr(contract(), name)()
        except Exception as reason:
            failed[name] = reason
    return failed


@pytest.mark.parametrize("offender", OFFENDERS, ids=lambda offender: offender.__name__)
def test_each_offence_is_noticed_by_its_own_test(offender):
    """Each of these modules breaks the contract in one way; the tests that notice are known."""
    failed = failures(offender)
    if offender.breaks == {"*"}:
        assert len(failed) >= len(TESTS) - 3
    else:
        assert set(failed) == offender.breaks, failed


@pytest.mark.parametrize("offender", OFFENDERS, ids=lambda offender: offender.__name__)
def test_messages_are_one_line_without_arrays(offender):
    """What the kit says fits a line and never prints an array."""
    for reason in failures(offender).values():
        assert len(str(reason)) < 400
        assert "array(" not in str(reason)


def test_the_messages_teach():
    """What was found, and what to do about it."""
    by_name = {offender.__name__: offender for offender in OFFENDERS}

    def said(name):
        return " | ".join(str(reason) for reason in failures(by_name[name]).values())

    assert "run fails where boundaries is None" in said("Demanding")
    assert "do it inside run" in said("EagerImport")
    assert "the inputs after the call differs in image" in said("Scribbler")
    assert "say instant = True" in said("Deaf")
    assert "swallows Cancelled" in said("Stubborn")
    assert "H is 12 in an output and 24 elsewhere" in said("Shrinks")
    assert "visint-offence.txt" in said("Writer")
    assert "per_turn = True" in said("Turning")
    assert "run fails on images without texture" in said("Divider")
    assert "the state of numpy.random" in said("Seeder")


def test_there_is_one_test_a_sentence():
    """Sentence n of the contract is held by test_n, whose docstring is that sentence."""
    for number, sentence in sentences().items():
        (test,) = [name for name in TESTS if name.startswith(f"test_{number}_")]
        assert " ".join(getattr(ModuleContract, test).__doc__.split()) == sentence
    assert len(sentences()) == 8


def test_the_sentences_are_numbered_without_a_gap():
    """And `sentences` reads all of them, wherever the text wraps."""
    numbered = re.findall(r"^\d+\.", visint.module.__doc__, re.MULTILINE)
    assert list(sentences()) == list(range(1, len(numbered) + 1))
    assert all(sentence.endswith(".") for sentence in sentences().values())


def test_an_instant_module_need_not_ask():
    """`instant = True` says that there is nothing to interrupt."""
    deaf = next(offender for offender in OFFENDERS if offender.__name__ == "Deaf")
    assert not failures(deaf, instant=True)


def test_smallest_raises_the_sizes():
    """A module that says how small its images may be is asked for nothing smaller."""
    big = next(offender for offender in OFFENDERS if offender.__name__ == "Big")
    assert not failures(big, smallest=(2, 2))


class OwnIn(Ports):
    thing: Path


class Out(Ports):
    image: Image[Array, "H W"]


class Own(Module[Params, OwnIn, Out]):
    """Takes a value of a class that visint does not know."""

    name = "own"

    def run(self, inputs: OwnIn, ctx: Context) -> Out:
        raise NotImplementedError


def test_ports_of_a_strangers_class_need_make_inputs():
    """The kit cannot invent a value of any class, and says what to write."""
    failed = failures(Own)
    assert "no sample of pathlib.Path for port 'thing'; write make_inputs yourself" in str(
        failed["test_1_run_is_a_function"]
    )


class TestWatch:
    def test_importing_is_no_offence(self):
        """Imports read files; that is not what sentence 7 means."""
        sys.modules.pop("colorsys", None)
        with watch.world() as touched:
            import colorsys  # noqa: F401
        assert touched == []

    def test_watches_nest_and_end(self, tmp_path):
        """The inner watch sees what happens in it; after the end nothing is noted."""
        with watch.world() as outer:
            with watch.world() as inner:
                (tmp_path / "a").write_text("a", encoding="utf-8")
            (tmp_path / "b").mkdir()
        (tmp_path / "c").mkdir()
        assert ["'" + str(tmp_path / "a") + "'" in line for line in inner] == [True]
        assert [line.split("(")[0] for line in outer] == ["os.mkdir"]

    def test_numbas_cache_apart(self, tmp_path):
        """Numba keeps compiled code in .nbi and .nbc files beside the source."""
        with watch.world() as touched:
            (tmp_path / "kernel.py310.1.nbc").write_bytes(b"")
            (tmp_path / "kernel.py310.nbi.tmp.1").write_bytes(b"")
        assert touched == []

    def test_imports_sees_cached_ones(self):
        """A second import of numpy is an import statement all the same."""
        with watch.imports() as seen:
            import numpy.linalg  # noqa: F401
        assert "numpy" in seen
