"""How evidence enters the map: cohere, then reconcile, by the spoke's own word or the policy's."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from visint.graph.callees import find_callee
from visint.graph.expansion import Evidence, Expansion, Path, Refs
from visint.graph.graph import Callee
from visint.graph.ports import reader_between
from visint.graph.spec import NodeSpec, SpokeSpec, StepSpec
from visint.module import PortSpec
from visint.names import did_you_mean, listed

__all__ = ["enter", "reconcile_fields"]

BUILT_IN = ("none", "replace")


class _Stage(NamedTuple):
    """A step at its place: the node to write for it, whose spoke it is of (none for a field's), and where."""

    node: str
    step: StepSpec
    path: Path
    spoke: str = ""


def enter(expansion: Expansion, name: str, spoke: SpokeSpec, port: PortSpec, stem: str) -> Refs:
    """Writes the steps by which one evidence port of a spoke enters the map; gives the fields to commit."""
    field = expansion.field_of(port)
    expansion.spoken_of[field] = None
    path = ("hub", "spokes", name)
    cohere = _step(expansion, port, "cohere", spoke.cohere, "none")
    evidence = Evidence(f"{name}.{port.name}", port)
    if cohere.uses != "none":
        stage = _Stage(f"{stem}_cohere", cohere, (*path, "cohere"), name)
        evidence = _cohered(expansion, stage, evidence)
    if field in expansion.hub.reconcile:
        expansion.pending.setdefault(field, []).append(evidence)
        return {}
    step = _step(expansion, port, "reconcile", spoke.reconcile, "replace")
    if step.uses == "none":
        return {}
    if step.uses == "replace":
        return _replacing(expansion, evidence, field, path)
    return _reconciled(expansion, _Stage(f"{stem}_reconcile", step, (*path, "reconcile"), name), [evidence])


def reconcile_fields(expansion: Expansion) -> None:
    """Writes the fields that are reconciled once a sweep, from all their evidence together."""
    for field, step in expansion.hub.reconcile.items():
        path = ("hub", "reconcile", field)
        where = expansion.draft.where(*path, key=True)
        evidence = expansion.pending.get(field, [])
        if not evidence:
            has = "fields with evidence: " + listed(expansion.spoken_of)
            near = did_you_mean(field, expansion.spoken_of) or next(iter(expansion.spoken_of), "depth")
            write = f"{near}: {{uses: {step.uses or 'plugin.module'}}}"
            expansion.draft.say("VI222", f"no spoke gives evidence on {field!r}", where, has, write)
        elif step.uses is None or step.uses in BUILT_IN:
            found = f"{field!r} is reconciled from all its evidence together, which takes a module"
            expansion.draft.say("VI222", found, where, write=f"{field}: {{uses: plugin.module}}")
        else:
            fields = _reconciled(expansion, _Stage(f"{field}_reconcile", step, path), evidence)
            expansion.commit(f"map_{field}", fields, None, path)


def _step(expansion: Expansion, port: PortSpec, what: str, own: StepSpec, otherwise: str) -> StepSpec:
    """The policy's step for a kind of evidence, with what the spoke says laid over it."""
    if own.uses is not None:
        return own
    policy = expansion.policy.get(port.kind, expansion.policy.get("*", {})).get(what, {})
    merged = {**policy.get("with", {}), **own.with_}
    return StepSpec(uses=policy.get("uses", otherwise), with_=merged, in_={**policy.get("in", {}), **own.in_})


def _replacing(expansion: Expansion, evidence: Evidence, field: str, path: Path) -> Refs:
    """The built-in ``replace``: evidence that is a value of its field takes the map's place where it speaks."""
    draft, port = expansion.draft, evidence.port
    stored = draft.fields.get(field)
    if stored is not None and port.kind in {stored.name, "Disparity" if field == "depth" else ""}:
        return {f"{field}_evidence": evidence.ref}
    found = f"{port} says something about {field or 'no field'!r}, but cannot simply replace it"
    choices = "give the hub a policy that knows it, or the spoke a step of its own"
    draft.say("VI222", found, draft.where(*path), choices, "reconcile: {uses: plugin.module}")
    return {}


def _cohered(expansion: Expansion, stage: _Stage, evidence: Evidence) -> Evidence:
    callee = _write(expansion, stage, [evidence])
    if callee is None:
        return evidence
    given = [out for out in callee.outputs.values() if out.evidence]
    if given:
        return Evidence(f"{stage.node}.{given[0].name}", given[0])
    found = f"{callee.id} gives no evidence, which a step of coherence must"
    expansion.draft.say("VI222", found, expansion.draft.where(*stage.path), write="cohere: {uses: none}")
    return evidence


def _reconciled(expansion: Expansion, stage: _Stage, evidence: Sequence[Evidence]) -> Refs:
    callee = _write(expansion, stage, evidence)
    return {} if callee is None else dict(_fields_of(expansion, stage, callee))


def _write(expansion: Expansion, stage: _Stage, evidence: Sequence[Evidence]) -> Callee | None:
    """Writes the node of a step."""
    step = stage.step
    callee = find_callee(expansion.draft, str(step.uses), expansion.draft.where(*stage.path, "uses"))
    if callee is None:
        return None
    taken = _taken(expansion, stage, callee, evidence)
    if taken is None:
        return None
    own = {**step.in_, **taken}
    refs = expansion.bound(callee, own, set(), _other_outputs(expansion, stage.spoke), stage.path)
    spoke = expansion.nodes.get(stage.spoke)
    node = NodeSpec(
        uses=str(step.uses),
        with_=step.with_,
        loop=expansion.hub.loop,
        levels=spoke.levels if spoke else None,
        in_=refs,
        of=stage.spoke or None,
    )
    expansion.add(stage.node, node, callee, stage.path)
    return callee


def _taken(expansion: Expansion, stage: _Stage, callee: Callee, evidence: Sequence[Evidence]) -> Refs | None:
    """Which port takes which evidence: the first of its very kind, else one for evidence of any kind.

    None, with a problem noted, if there is evidence that no port takes.
    """
    draft = expansion.draft
    refs: Refs = {}
    for ref, port in evidence:
        takes = [spec for spec in callee.inputs.values() if spec.evidence and reader_between(port, spec)]
        takes.sort(key=lambda spec: not spec.kind)
        free = [spec for spec in takes if spec.many or spec.name not in refs]
        if any(spec.name in stage.step.in_ for spec in takes):
            continue
        if free:
            name = free[0].name
            refs[name] = (*refs.get(name, ()), ref) if free[0].many else ref
        else:
            what = f"only one {port}, and {ref} is another" if takes else f"no {port}, which {ref} is"
            found = f"{callee.id} takes {what}"
            choices = f"inputs of {callee.id}: " + listed(f"{n}: {s}" for n, s in callee.inputs.items())
            draft.say(
                "VI222", found, draft.where(*stage.path), choices, f"{stage.path[-1]}: {{uses: plugin.module}}"
            )
            return None
    return refs


def _other_outputs(expansion: Expansion, spoke: str) -> dict[str, str]:
    callee = expansion.callees.get(spoke)
    outputs = callee.outputs.values() if callee else ()
    return {port.name: f"{spoke}.{port.name}" for port in outputs if not port.evidence}


def _fields_of(expansion: Expansion, stage: _Stage, callee: Callee) -> Iterator[tuple[str, str]]:
    """The outputs of a reconciler that are fields of the map, or the confidence of the one field it gives."""
    stored = expansion.draft.fields
    given = [
        field
        for field, kind in stored.items()
        if field in callee.outputs and callee.outputs[field].kind == kind.name
    ]
    if not given:
        where, fields = expansion.draft.where(*stage.path), "fields: " + listed(stored)
        write = f"{stage.path[-1]}: {{uses: plugin.module}}"
        expansion.draft.say("VI222", f"{callee.id} gives no field of the map", where, fields, write)
    for field in given:
        yield field, f"{stage.node}.{field}"
        own = f"{field}_confidence"
        confidence = own if own in callee.outputs else "confidence"
        if confidence in callee.outputs and (confidence == own or len(given) == 1):
            yield own, f"{stage.node}.{confidence}"
