"""Calling a module: inputs filled without validating again what was validated when it was made."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from typing import Any, NamedTuple

from visint.engine.state import State
from visint.errors import ModuleError
from visint.module import Context, Params, Ports, PortSpec
from visint.registry.load import AnyModule

__all__ = ["Invoke", "Values", "invoke_module"]

Values = dict[str, Any]
Invoke = Callable[[Values, Context, State], Any]
_set = object.__setattr__


def invoke_module(module: type[AnyModule], params: Any) -> Invoke:
    """A function that calls ``module`` with ``params``, and gives its outputs as a mapping.

    What feeds a port was checked when it was made; only that ports naming the same dim agree, inputs and
    outputs together, is looked at here, for that no single value can know.
    """
    assert isinstance(params, Params)
    run = module(params).run
    inputs_type, outputs_type = module.Inputs, module.Outputs
    agree, fields, new = inputs_type.dims_agree, set(inputs_type.model_fields), inputs_type.__new__
    shared = _shared(inputs_type, outputs_type)

    def invoke(values: Values, context: Context, state: State) -> Mapping[str, Any]:  # noqa: ARG001 - one form
        try:
            agree(values)
        except ValueError as error:
            raise ModuleError.of("VI402", f"its inputs do not fit each other: {error}") from None
        inputs = new(inputs_type)
        _set(inputs, "__dict__", values)
        _set(inputs, "__pydantic_fields_set__", fields)
        _set(inputs, "__pydantic_extra__", None)
        _set(inputs, "__pydantic_private__", None)
        outputs = run(inputs, context)
        if type(outputs) is not outputs_type:
            raise ModuleError.of("VI402", _no_outputs(outputs, outputs_type))
        given = outputs.__dict__
        for dim in shared:
            dim.check(values, given)
        return given

    return invoke


class _Dim(NamedTuple):
    """A dim that inputs and outputs share: a port of either side that has it, and its axis there."""

    name: str
    source: PortSpec
    source_axis: int
    target: PortSpec
    target_axis: int

    def check(self, values: Values, given: Mapping[str, Any]) -> None:
        before = _first(values[self.source.name], self.source)
        after = _first(given[self.target.name], self.target)
        if before is None or after is None:
            return
        wanted, found = before.shape[self.source_axis], after.shape[self.target_axis]
        if wanted != found:
            ports = f"input {self.source.name!r} but {found} on output {self.target.name!r}"
            said = f"{self.name} is {wanted} on {ports}"
            raise ModuleError.of("VI402", said)


def _first(value: Any, port: PortSpec) -> Any:
    """The array on a port, the first of a list (all of a list agree); None if there is none."""
    if port.many:
        value = value[0] if value else None
    return value.value if port.evidence and value is not None else value


@lru_cache(maxsize=256)
def _shared(inputs: type[Ports], outputs: type[Ports]) -> tuple[_Dim, ...]:
    sources = {dim: (port, axis) for port, axis, dim in _dims(inputs)}
    targets = {dim: (port, axis) for port, axis, dim in _dims(outputs)}
    return tuple(_Dim(dim, *sources[dim], *targets[dim]) for dim in targets if dim in sources)


def _dims(ports: type[Ports]) -> Iterator[tuple[PortSpec, int, str]]:
    """(port, axis, name) of every named dim, those of the ports that are surest to hold an array last."""
    for port in sorted(ports.specs.values(), key=lambda port: (port.optional, port.many), reverse=True):
        if port.array is not None:
            yield from ((port, axis, dim) for axis, dim in enumerate(port.array.dims) if isinstance(dim, str))


def _no_outputs(outputs: object, wanted: type[Ports]) -> str:
    return f"run returned {type(outputs).__name__}; it must return {wanted.__name__}"
