"""The state of one run: values in slots, records, and who listens."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from threading import Event as Flag
from threading import Lock
from typing import Any

from visint.engine.frame import Frame
from visint.errors import Cancelled
from visint.events import Assumed, Event, Measured, Observer, Warned
from visint.fields.camera import Camera
from visint.results import records

__all__ = ["BLIND_GUESS", "Halt", "State", "emitter"]

BLIND_GUESS = 0.1
"""Disparity of the start plane as a share of the image width, where no search range is known."""


class Halt(Flag):
    """A flag of the run's own that stands for the caller's, too: setting it leaves the caller's as it is."""

    def __init__(self, callers: Flag) -> None:
        super().__init__()
        self._callers = callers

    def is_set(self) -> bool:
        """Whether either is set."""
        return super().is_set() or self._callers.is_set()


@dataclass(slots=True)
class State:
    """Everything a run changes while it goes on; nothing of it outlives the run but what the result takes.

    ``root`` is where the graph begins: in a sub-graph the level and the turns of the call, whose name and a
    dot are ``within``. ``seed`` is the run's, with the keys of the calls around. ``emit`` is None where nobody
    listens, so that no event is ever made for nobody.
    """

    slots: list[Any]
    seed: tuple[int, ...] = (0,)
    camera: Camera | None = None
    root: Frame = field(default_factory=Frame)
    within: str = ""
    warm: Mapping[str, Any] = field(default_factory=dict)
    cancel: Flag = field(default_factory=Flag)
    pools: Sequence[ThreadPoolExecutor] = ()
    emit: Callable[[Event], None] | None = None
    begun: dict[int, int] = field(default_factory=dict)  # cell → the level its value is at
    record: records.Record = field(default_factory=records.Record)

    def check(self) -> None:
        """Raises Cancelled if the run was interrupted."""
        if self.cancel.is_set():
            raise Cancelled.of("VI130", "the run was interrupted")

    def camera_at(self, level: int) -> Camera | None:
        """The camera there, or one for relative depth where none was given; None without images.

        Halved from full size either way: of odd sizes the focal length would not be half the width.
        """
        camera = self.camera
        if camera is None and self.root.size is not None:
            rows, columns = self.root.size
            camera = Camera.uncalibrated(columns, rows, (0, 2 * BLIND_GUESS * columns))
        if camera is not None:
            for _ in range(level - self.root.level):
                camera = camera.halved()
        return camera

    def note(self, node: str, frame: Frame, what: str, name: str, value: Any) -> None:
        """Records what a module says through its context."""
        place = (self.within + node, frame.level, frame.turn)
        if what == "measure":
            self.record.measures.append(records.Measure(*place, name, value))
        elif what == "assumed":
            self.record.note_assumed(records.Assumed(*place, name, value[0], value[1], frame.size))
        else:
            self.record.warnings.append(records.Warned(*place, name, value))
        if self.emit is not None:
            self.emit(_heard(what, place, name, value))

    def tell(self, event: Event) -> None:
        """Hands an event to whoever listens."""
        if self.emit is not None:
            self.emit(event)


def _heard(what: str, place: tuple[str, int, int], name: str, value: Any) -> Event:
    """The event that tells observers of what a module said."""
    if what == "assumed":
        return Assumed(*place, name, held=value[0], regions=value[1])
    return (Measured if what == "measure" else Warned)(*place, name, value)


def emitter(observers: Sequence[Observer], *, threaded: bool = False) -> Callable[[Event], None] | None:
    """One callable for all observers, one event at a time whatever runs side by side; None for none."""
    if not observers:
        return None
    if len(observers) == 1 and not threaded:
        return observers[0]
    lock = Lock()

    def emit(event: Event) -> None:
        with lock:
            for observer in observers:
                observer(event)

    return emit
