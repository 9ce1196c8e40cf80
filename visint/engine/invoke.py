"""Calling a module: inputs filled without validating again what was validated when it was made."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from operator import itemgetter
from typing import Any, NamedTuple

from pydantic import BaseModel

from visint.engine.state import State
from visint.errors import ModuleError
from visint.module import Context, Params, Ports, PortSpec
from visint.ports import always
from visint.registry.load import AnyModule

__all__ = ["Invoke", "Values", "invoke_module"]

Values = dict[str, Any]
Invoke = Callable[[Values, Context, State], Any]
Check = Callable[[Values, Mapping[str, Any]], None]
_set_values, _set_fields, _set_extra, _set_private = (
    BaseModel.__dict__[slot].__set__
    for slot in ("__dict__", "__pydantic_fields_set__", "__pydantic_extra__", "__pydantic_private__")
)


def invoke_module(module: type[AnyModule], params: Any) -> Invoke:
    """A function that calls ``module`` with ``params``, and gives its outputs as a mapping.

    What feeds a port was checked when it was made; only that ports naming the same dim agree, inputs and
    outputs together, is looked at here, for that no single value can know.
    """
    assert isinstance(params, Params)
    run = module(params).run
    inputs_type, outputs_type = module.Inputs, module.Outputs
    agree = None if inputs_type.dims_agree is always else inputs_type.dims_agree
    fields, new = set(inputs_type.model_fields), inputs_type.__new__
    shared = _shared(inputs_type, outputs_type)

    def invoke(values: Values, context: Context, state: State) -> Mapping[str, Any]:  # noqa: ARG001 - one form
        if agree is not None:
            _fit_each_other(agree, values)
        inputs = new(inputs_type)
        _set_values(inputs, values)
        _set_fields(inputs, fields)
        _set_extra(inputs, None)
        _set_private(inputs, None)
        outputs = run(inputs, context)
        if type(outputs) is not outputs_type:
            raise ModuleError.of("VI402", _no_outputs(outputs, outputs_type))
        given = outputs.__dict__
        for check in shared:
            check(values, given)
        return given

    return invoke


def _fit_each_other(agree: Callable[[Values], None], values: Values) -> None:
    try:
        agree(values)
    except ValueError as error:
        raise ModuleError.of("VI402", f"its inputs do not fit each other: {error}") from None


def _alike(source: PortSpec, target: PortSpec, dims: tuple[_Dim, ...]) -> Check:
    """A check that two ports agree in the dims that both name."""
    before_of, after_of = _array_on(source), _array_on(target)
    aligned = all(dim.source_axis == dim.target_axis for dim in dims)

    def check(values: Values, given: Mapping[str, Any]) -> None:
        before, after = before_of(values), after_of(given)
        if before is None or after is None or (aligned and before.shape == after.shape):
            return
        for name, i, j in dims:
            wanted, found = before.shape[i], after.shape[j]
            if wanted != found:
                ports = f"input {source.name!r} but {found} on output {target.name!r}"
                raise ModuleError.of("VI402", f"{name} is {wanted} on {ports}")

    return check


class _Dim(NamedTuple):
    """A dim that two ports share, and its axis on either."""

    name: str
    source_axis: int
    target_axis: int


def _array_on(port: PortSpec) -> Callable[[Mapping[str, Any]], Any]:
    if port.many or port.evidence:
        return lambda values: _first(values[port.name], port)
    return itemgetter(port.name)


def _first(value: Any, port: PortSpec) -> Any:
    """The array on a port, the first of a list (all of a list agree); None if there is none."""
    if port.many:
        value = value[0] if value else None
    return value.value if port.evidence and value is not None else value


@lru_cache(maxsize=256)
def _shared(inputs: type[Ports], outputs: type[Ports]) -> tuple[Check, ...]:
    """One check a pair of ports, for the dims that inputs and outputs share."""
    sources = {dim: (port, axis) for port, axis, dim in _dims(inputs)}
    targets = {dim: (port, axis) for port, axis, dim in _dims(outputs)}
    pairs: dict[tuple[str, str], tuple[_Dim, ...]] = {}
    for dim, (target, j) in targets.items():
        if dim in sources:
            source, i = sources[dim]
            pair = source.name, target.name
            pairs[pair] = (*pairs.get(pair, ()), _Dim(dim, i, j))
    return tuple(_alike(inputs.specs[a], outputs.specs[b], dims) for (a, b), dims in pairs.items())


def _dims(ports: type[Ports]) -> Iterator[tuple[PortSpec, int, str]]:
    """(port, axis, name) of every named dim, those of the ports that are surest to hold an array last."""
    for port in sorted(ports.specs.values(), key=lambda port: (port.optional, port.many), reverse=True):
        if port.array is not None:
            yield from ((port, axis, dim) for axis, dim in enumerate(port.array.dims) if isinstance(dim, str))


def _no_outputs(outputs: object, wanted: type[Ports]) -> str:
    return f"run returned {type(outputs).__name__}; it must return {wanted.__name__}"
