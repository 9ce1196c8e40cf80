"""The contract of :mod:`visint.module` as tests, one a numbered sentence, for any module.

In a test file of your own, ``class TestLaplacian(ModuleContract): module = Laplacian``, run by pytest.
"""

from __future__ import annotations

import re
import time
import warnings
from collections.abc import Callable, Iterator, Mapping
from typing import Any, ClassVar

import numpy as np

import visint.module
from visint.errors import Cancelled
from visint.fields import Evidence
from visint.fields.assumptions import check_names
from visint.module import Context, Module, Params, Ports, PortSpec
from visint.names import is_name
from visint.testing import samples, watch
from visint.testing.samples import Content, Size

__all__ = ["ModuleContract", "sentences"]


def sentences() -> Mapping[int, str]:
    """The numbered sentences of the contract, read from the docstring of :mod:`visint.module`."""
    found = re.findall(r"^(\d+)\. (.+)$", visint.module.__doc__ or "", re.MULTILINE)
    return {int(number): sentence for number, sentence in found}


class ModuleContract:
    """Tests of one module. Subclass it under a name that pytest collects and say which ``module``.

    Examples
    --------
    ::

        class TestLaplacian(ModuleContract):
            module = Laplacian

    Inputs are made from the declared ports. Override :meth:`make_inputs` where they should mean something,
    :meth:`make_params` where the defaults will not do.
    """

    module: ClassVar[type[Module[Any, Any, Any]]]
    """The class under test."""
    size: ClassVar[Size] = (24, 31)
    """(rows, columns) of the inputs."""
    smallest: ClassVar[Size] = (1, 1)
    """The smallest (rows, columns) that the module promises to take; raise it only if its docstring does."""
    listed: ClassVar[int] = 3
    """How many values a list on a port holds: 2 for a module that wants a pair."""
    instant: ClassVar[bool] = False
    """True for a module that calls no library long enough to be worth interrupting."""

    def make_params(self) -> Params | None:
        """The parameters of the module under test; None for the defaults."""
        return None

    def make_inputs(self, size: Size, content: Content = "noise", seed: int = 0) -> Any:
        """Inputs of ``size`` (rows, columns) and ``content``; other ones for another ``seed``.

        Every optional port should be filled. Called again it must return equal inputs.
        """
        return samples.sample_inputs(self.module.Inputs, size, content, seed, listed=self.listed)

    def test_0_it_declares_itself(self) -> None:
        """A name, a line on what it recovers, and three models."""
        module = self.module
        assert is_name(module.name), f"{module.__qualname__}.name is {module.name!r}, which is no name"
        assert (module.__doc__ or "").strip(), f"{module.__qualname__} has no docstring"
        assert module.Outputs.specs, f"{module.__qualname__} has no outputs"
        assert all(is_name(port) for port in (*module.Inputs.specs, *module.Outputs.specs))

    def test_1_run_is_a_function(self) -> None:
        """``run`` is a function of its inputs, its parameters and the context."""
        module = self._made()
        first = self._run(module, self.make_inputs(self.size))
        self._run(module, self.make_inputs(self.size, seed=1))
        _same(first, self._run(module, self.make_inputs(self.size)), "called again with equal inputs")
        _same(first, self._run(self._made(), self.make_inputs(self.size)), "of a second instance")

    def test_2_inputs_are_left_alone(self) -> None:
        """It never modifies its inputs; they arrive read-only."""
        inputs = self.make_inputs(self.size)
        before = _bytes_of(inputs)
        assert all(not array.flags.writeable for array in _arrays(inputs)), "inputs must arrive read-only"
        self._run(self._made(), inputs)
        _equal(before, _bytes_of(inputs), "the inputs after the call")

    def test_3_outputs_are_as_declared(self) -> None:
        """Its outputs have the declared kind, dtype and dims."""
        inputs = self.make_inputs(self.size)
        self._declared(inputs, self._run(self._made(), inputs))

    def test_4_nothing_is_kept_between_turns(self) -> None:
        """What it keeps between turns it returns as an output and gets back by a feedback edge."""
        module = self._made()
        first = self._run(module, self.make_inputs(self.size))
        handed_out = _bytes_of(first)
        for seed in (1, 2):
            self._run(module, self.make_inputs(self.size, seed=seed))
            _equal(handed_out, _bytes_of(first), "an output after later calls")
        _same(first, self._run(module, self.make_inputs(self.size)), "after calls with other inputs")

    def test_5_init_is_cheap(self) -> None:
        """``__init__`` is cheap."""
        self._made()
        with watch.imports() as imported:
            times = [_seconds(self._made) for _ in range(5)]
        assert min(times) < 0.01, f"__init__ takes {1000 * min(times):.1f} ms; 10 ms are allowed"
        assert not imported & watch.HEAVY, f"__init__ imports {imported & watch.HEAVY}; do it inside run"
        heavy = _heavy_globals(self.module)
        assert not heavy, f"{self.module.__module__} imports {heavy} at its top; do it inside run"

    def test_6_optional_inputs_may_be_none(self) -> None:
        """Every optional input may be None."""
        inputs = self.make_inputs(self.size)
        optional = [name for name, spec in type(inputs).specs.items() if spec.optional]
        for absent in [[name] for name in optional] + [optional] * bool(optional):
            without = type(inputs)(**{**inputs.__dict__, **dict.fromkeys(absent)})
            try:
                outputs = self._run(self._made(), without)
            except Exception as reason:
                raise AssertionError(f"run fails where {', '.join(absent)} is None: {reason!r}") from reason
            self._declared(without, outputs)

    def test_7_it_leaves_the_world_alone(self) -> None:
        """It opens no file and no socket and has no global state (numba's cache apart)."""
        inputs = self.make_inputs(self.size)
        self._run(self._made(), inputs)  # imports and compiles what it needs
        before = watch.global_state()
        with watch.world() as touched:
            self._run(self._made(), inputs)
        assert not touched, f"run touches the world outside: {'; '.join(touched[:5])}"
        after = watch.global_state()
        changed = [what for what, state in before.items() if after[what] != state]
        assert not changed, f"run changes {', '.join(changed)}"

    def test_8_it_can_be_interrupted(self) -> None:
        """It calls ``ctx.check()`` between long library calls."""
        if self.instant:
            return
        asked: list[bool] = []

        def cancelled() -> bool:
            asked.append(True)
            return True

        try:
            self._run(self._made(), self.make_inputs(self.size), cancelled)
        except Cancelled:
            return
        assert asked, "run never calls ctx.check(); say instant = True if it has nothing to interrupt"
        raise AssertionError("run swallows Cancelled, so that nobody can interrupt it")

    def test_assumptions_are_declared(self) -> None:
        """It declares known assumptions, and speaks through ``ctx.assumed`` of those only, region by region."""
        check_names(self.module.assumptions)
        said: list[tuple[str, Any, Any]] = []
        self._run(self._made(), self.make_inputs(self.size), assumed=said)
        for name, held, regions in said:
            assert name in self.module.assumptions, f"run speaks of {name!r}, which it does not declare"
            fits = regions is None or len(held) > int(np.max(regions, initial=0))
            assert fits, f"run says of {name!r} less than one flag a region"

    def test_any_size(self) -> None:
        """One row, one column, odd sides and a single pixel are images too."""
        for size in _sizes(self.smallest):
            inputs = self.make_inputs(size)
            self._declared(inputs, self._sturdy(inputs, f"{size[0]} × {size[1]} pixels"))

    def test_no_texture(self) -> None:
        """A grey image without any texture is an image too."""
        inputs = self.make_inputs(self.size, "grey")
        self._declared(inputs, self._sturdy(inputs, "images without texture"))

    def test_unknown_pixels(self) -> None:
        """Depth and its like may be NaN here, there and everywhere."""
        for content in ("holes", "unknown"):
            inputs = self.make_inputs(self.size, content)
            self._declared(inputs, self._sturdy(inputs, f"unknown pixels ({content})"))

    def _made(self) -> Module[Any, Any, Any]:
        return self.module(self.make_params())

    def _run(
        self,
        module: Module[Any, Any, Any],
        inputs: Any,
        cancelled: Callable[[], bool] | None = None,
        assumed: list[tuple[str, Any, Any]] | None = None,
    ) -> Ports:
        def note(what: str, name: str, value: Any) -> None:
            if assumed is not None and what == "assumed":
                assumed.append((name, *value))

        size = next((array.shape[:2] for array in _arrays(inputs) if array.ndim > 1), None)
        context = Context(size=size, seed=(7,), per_turn=self.module.per_turn, cancelled=cancelled, note=note)
        outputs = module.run(inputs, context)
        assert isinstance(outputs, self.module.Outputs), f"run returns {type(outputs).__qualname__}"
        return outputs

    def _sturdy(self, inputs: Any, given: str) -> Ports:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error", RuntimeWarning)
                return self._run(self._made(), inputs)
        except Exception as reason:
            raise AssertionError(f"run fails on {given}: {reason!r}") from reason

    def _declared(self, inputs: Any, outputs: Ports) -> None:
        """Outputs hold what they declare, and dims of one name agree between inputs and outputs too."""
        lengths = dict(_lengths(inputs))
        for name, spec in type(outputs).specs.items():
            value = outputs.__dict__[name]
            assert value is not None or spec.optional, f"output {name!r} is None and not optional"
            for one in _each(value, spec):
                if spec.array is not None:
                    spec.array.check(one.value if spec.evidence else one)
                if spec.evidence:
                    type(one).model_validate(one.__dict__)
        for dim, length in _lengths(outputs):
            wanted = lengths.setdefault(dim, length)
            assert length == wanted, f"{dim} is {length} in an output and {wanted} elsewhere"


def _each(value: Any, spec: PortSpec) -> tuple[Any, ...]:
    if value is None:
        return ()
    return tuple(value) if spec.many else (value,)


def _lengths(ports: Ports) -> Iterator[tuple[str, int]]:
    """(dim, length) of every named dim of every array."""
    for name, spec in type(ports).specs.items():
        if spec.array is None:
            continue
        for one in _each(ports.__dict__[name], spec):
            shape = one.value.shape if spec.evidence else one.shape
            yield from ((d, n) for d, n in zip(spec.array.dims, shape, strict=True) if isinstance(d, str))


def _leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """(path, value) of everything inside ports, evidence and lists."""
    if isinstance(value, Ports | Evidence):
        for name, part in value.__dict__.items():
            yield from _leaves(part, f"{path}.{name}" if path else name)
    elif isinstance(value, tuple):
        for i, part in enumerate(value):
            yield from _leaves(part, f"{path}[{i}]")
    else:
        yield path, value


def _arrays(ports: Ports) -> list[Any]:
    return [leaf for _, leaf in _leaves(ports) if isinstance(leaf, np.ndarray)]


def _bytes_of(ports: Ports) -> dict[str, object]:
    """Every leaf in a form that compares bit by bit, NaN included."""
    return {
        path: (leaf.dtype, leaf.shape, leaf.tobytes()) if isinstance(leaf, np.ndarray) else repr(leaf)
        for path, leaf in _leaves(ports)
    }


def _same(first: Ports, second: Ports, when: str) -> None:
    _equal(_bytes_of(first), _bytes_of(second), f"the result {when}")


def _equal(before: Mapping[str, object], after: Mapping[str, object], what: str) -> None:
    differing = [path for path in before if before[path] != after.get(path)]
    assert not differing, f"{what} differs in {', '.join(differing)}"


def _seconds(call: Callable[[], object]) -> float:
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def _heavy_globals(module: type[object]) -> set[str]:
    """Heavy packages that the file of ``module`` has imported at its top."""
    import sys

    named = vars(sys.modules[module.__module__]).values()
    homes = {str(getattr(value, "__module__", None) or getattr(value, "__name__", "")) for value in named}
    return {home.partition(".")[0] for home in homes} & watch.HEAVY


def _sizes(smallest: Size) -> list[Size]:
    rows, columns = smallest
    wanted = [(1, 1), (1, 17), (17, 1), (2, 2), (13, 7), (16, 9)]
    return sorted({(max(h, rows), max(w, columns)) for h, w in wanted})
