"""One node at work: its ports filled from slots, its module called, its outputs checked and put into slots."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from time import perf_counter
from typing import Any

from pydantic import ValidationError

from visint import io
from visint.arrays import read_only
from visint.engine.commit import map_call
from visint.engine.frame import Frame
from visint.engine.invoke import Invoke, Values, invoke_module
from visint.engine.state import State
from visint.errors import Cancelled, ModuleError, Problem, VisintError, Where
from visint.events import NodeFailed, NodeFinished, NodeStarted
from visint.graph.graph import Node, Reader
from visint.module import Context
from visint.schedule import Step
from visint.schedule.order import per_turn

__all__ = ["Call"]

_context = object.__new__
_event = tuple.__new__
"""Makes a named tuple in a third of the time that calling its class takes."""
SubGraph = Callable[[Node], Invoke]


def _value(evidence: Any) -> Any:
    return evidence.value


def _luminance(color: Any) -> Any:
    return read_only(io.luminance(color))


_READERS: Mapping[Reader, Callable[[Any], Any]] = {"value": _value, "luminance": _luminance}


def read_as(value: Any, reader: Reader) -> Any:
    """``value`` as an edge reads it; lists member by member, None as None."""
    if value is None or reader == "plain":
        return value
    if isinstance(value, tuple):
        return tuple(read_as(one, reader) for one in value)
    return _READERS[reader](value)


class Call:
    """A step made ready to run, in any number of runs: everything that does not change is worked out once."""

    __slots__ = (
        "_defaults",
        "_has_lists",
        "_invoke",
        "_key",
        "_levels",
        "_lists",
        "_name",
        "_never_none",
        "_outs",
        "_per_turn",
        "_singles",
        "node",
    )

    def __init__(self, step: Step, sub_graph: SubGraph) -> None:
        self.node = step.node
        self._singles = tuple((port, slot) for port, slot in step.ins if isinstance(slot, int))
        self._lists = tuple((port, slot) for port, slot in step.ins if not isinstance(slot, int))
        inputs = step.node.callee.inputs
        self._never_none = tuple(p for p, _ in self._singles if inputs[p].many and not inputs[p].optional)
        self._has_lists = bool(self._lists or self._never_none)
        self._outs = tuple((slot, port, reader) for slot, port, reader in step.outs)  # unpacked quicker
        self._levels = None if step.node.levels is None else frozenset(step.node.levels)
        self._per_turn = step.node.callee.module is None or per_turn(step.node)
        self._key = (step.key,)
        self._name = step.node.name
        self._defaults = _defaults(step.node)
        self._invoke = _by_level(step.node, sub_graph)

    def __call__(self, state: State, frame: Frame) -> None:
        """Runs the node once.

        Raises
        ------
        ModuleError
            Naming node, module, version, level and turn.
        Cancelled
            If the run was interrupted.
        """
        slots = state.slots
        if self._levels is not None and frame.level not in self._levels:
            for slot, _, _ in self._outs:
                slots[slot] = None
            return
        if state.cancel.is_set():
            state.check()
        values = self._defaults.copy()
        for port, source in self._singles:
            values[port] = slots[source]
        if self._has_lists:
            self._fill_lists(values, slots)
        outputs = self._timed(state, frame, values)
        for slot, port, reader in self._outs:
            slots[slot] = outputs[port] if reader == "plain" else read_as(outputs[port], reader)

    def _fill_lists(self, values: Values, slots: list[Any]) -> None:
        for port in self._never_none:
            if values[port] is None:
                values[port] = ()  # a list that a node limited to some levels gives is empty elsewhere
        for port, sources in self._lists:
            values[port] = tuple([one for slot in sources if (one := slots[slot]) is not None])

    def _timed(self, state: State, frame: Frame, values: Values) -> Any:
        name, level, emit = state.within + self._name, frame.level, state.emit
        turn = frame.turns[-1] if frame.turns else 0
        started = perf_counter()
        if emit is not None:
            emit(_event(NodeStarted, (name, level, turn, started)))
        context = _context(Context)  # slot by slot: keywords would take a tenth of the whole call
        context.level, context.size, context._turns = level, frame.size, frame.turns
        context._seed, context._per_turn = state.seed + self._key, self._per_turn
        context._note, context._cancelled = partial(state.note, self._name, frame), state.cancel.is_set
        try:
            outputs = self._invoke(values, context, state)
        except BaseException as error:
            failure = self._failure(error, frame)
            state.tell(NodeFailed(name, level, turn, str(failure)))
            raise failure from (None if failure is error else error)
        seconds = perf_counter() - started
        spent, key = state.record.seconds, (name, level)
        if (total := spent.get(key)) is None:
            spent[key] = [1, seconds]
        else:
            total[0] += 1
            total[1] += seconds
        if emit is not None:
            emit(_event(NodeFinished, (name, level, turn, started, seconds, outputs)))
        return outputs

    def _failure(self, error: BaseException, frame: Frame) -> BaseException:
        if isinstance(error, Cancelled | KeyboardInterrupt) or not isinstance(error, Exception | SystemExit):
            return error
        callee = self.node.callee
        place = f"level {frame.level}, turn {frame.turn}"
        origin = f" of {callee.origin}" if callee.origin else ""
        module = f"{callee.id} (version {callee.version}{origin})" if callee.version else callee.id
        where = Where(path=f"node {self.node.name!r}, {module}, {place}")
        if isinstance(error, VisintError):
            return type(error)(replace(each, where=_inside(where, each.where)) for each in error.problems)
        code, found = _said(error)
        return ModuleError(Problem(code, found, where, fault="plugin"))


def _inside(node: Where, place: Where) -> Where:
    """Where a problem is: at the node, and at a place of its own in there (a sub-graph's node, a line)."""
    return Where(path=f"{node.path}: {place}" if str(place) else node.path)


def _said(error: BaseException) -> tuple[str, str]:
    """The code of a failure and what is said of it."""
    if isinstance(error, ValidationError):
        items = error.errors(include_input=False, include_url=False)
        said = "; ".join(f"{'.'.join(map(str, e['loc']))} {e['msg']}".strip() for e in items)
        return "VI402", f"{error.title}: {said.replace('Value error, ', '')}"
    text = " ".join(str(error).split()) or "no message"
    if isinstance(error, ValueError) and "read-only" in text:
        return "VI403", f"it wrote into one of its inputs ({text}); copy it first"
    return "VI401", f"{type(error).__name__}: {_without_arrays(text)}"


def _without_arrays(text: str) -> str:
    """A module's message without the contents of arrays, which numpy prints between brackets."""
    return re.sub(r"(array\()?\[[-+\d.\seEnaif,\[\]]{12,}(\]\)?|\.\.\.).*", "[…]", text)[:300]


def _defaults(node: Node) -> Values:
    module = node.callee.module
    if module is None:
        return dict.fromkeys(node.callee.inputs)
    fields = module.Inputs.model_fields
    return {
        name: None if info.is_required() else info.get_default(call_default_factory=True)
        for name, info in fields.items()
    }


def _by_level(node: Node, sub_graph: SubGraph) -> Invoke:
    if node.callee.graph is not None:
        return sub_graph(node)
    if node.callee.module is None:
        return map_call(node)
    module = node.callee.module
    usual = invoke_module(module, node.params)
    if not node.at:
        return usual
    at = {level: invoke_module(module, params) for level, params in node.at.items()}
    return lambda values, context, state: at.get(context.level, usual)(values, context, state)
