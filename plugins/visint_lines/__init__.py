"""Line drawings: parsed, measured against depth and labelled; superquadrics fitted to regions."""

from __future__ import annotations

from typing import Any

from visint.hookspecs import hookimpl

visint_contract = 1


@hookimpl
def visint_modules() -> list[Any]:
    """The modules of this plugin; imported here so that finding the plugin costs nothing."""
    from visint_lines.label import Label
    from visint_lines.measure import Features
    from visint_lines.parse import Parse
    from visint_lines.superquadric.module import SuperquadricFit
    from visint_lines.trace import Trace

    return [Features, Label, Parse, SuperquadricFit, Trace]


@hookimpl
def visint_fields() -> list[Any]:
    """Diagrams and labels as values between modules: their coordinates scale with the level."""
    from visint_lines.field_kinds import KINDS

    return list(KINDS)


@hookimpl
def visint_writers() -> dict[str, Any]:
    """``labels.json`` and ``labels.svg`` of an output named ``labels``."""
    from visint_lines.drawing import svg
    from visint_lines.record import diagram_record, fits_record, labels_record

    return {
        "lines.Superquadrics": lambda name, value: {f"{name}.json": fits_record(value)},
        "lines.Diagram": lambda name, value: {f"{name}.json": diagram_record(value)},
        "lines.Labels": lambda name, value: {f"{name}.json": labels_record(value), f"{name}.svg": svg(value)},
    }
