"""Every exception and error code.

::

    VisintError                 except VisintError: anything visint can tell you about
    ├── GraphError    (exit 2)  a graph file or a graph built in code is wrong
    ├── UsageError    (exit 2)  a command line or a call is wrong
    ├── InputError    (exit 3)  an image, a calibration or another input is wrong
    ├── PluginError   (exit 4)  an installed plugin is broken, missing or ambiguous
    ├── ModuleError   (exit 4)  a module failed, or broke the contract, while it ran
    ├── OutputError   (exit 5)  a result could not be written
    └── Cancelled   (exit 130)  the run was interrupted

An error carries one or more :class:`Problem`: all problems of a phase are told together.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import ClassVar, Literal, Self

__all__ = [
    "CODES",
    "Cancelled",
    "GraphError",
    "InputError",
    "ModuleError",
    "OutputError",
    "PluginError",
    "Problem",
    "UsageError",
    "VisintError",
    "Where",
]

Fault = Literal["graph", "input", "plugin", "usage", "output", "visint"]

CODES: dict[str, str] = {
    "VI101": "the graph file cannot be read",
    "VI102": "the graph file is not well-formed YAML or JSON",
    "VI103": "the graph file uses a YAML feature that graph files do not have",
    "VI104": "a key stands twice",
    "VI105": "a part of the graph file has the wrong form",
    "VI106": "the format version is missing or not known",
    "VI107": "the graph file is too large, too deep or too long",
    "VI108": "no graph of that name",
    "VI201": "no module of that name",
    "VI202": "a reference points nowhere",
    "VI203": "two joined ports are of different kinds",
    "VI204": "a required port is not fed",
    "VI205": "a parameter is wrong",
    "VI206": "the module has no port of that name",
    "VI207": "nodes feed each other in a circle without a feedback edge",
    "VI208": "no loop of that name, or loops inside each other in a circle",
    "VI209": "no field kind of that name",
    "VI210": "a loop has no bound",
    "VI211": "a path leaves a loop and comes back into it",
    "VI212": "two writers of one thing stand in no order",
    "VI213": "a node limited to some levels feeds a port that must always be fed",
    "VI214": "a feedback edge has no loop to go round in",
    "VI215": "a start value does not fit its port",
    "VI216": "an end condition of a loop is wrong",
    "VI217": "levels are asked for outside a pyramid, or are out of range",
    "VI218": "graphs call each other in a circle",
    "VI219": "a control, --set, --without or --stop-after names nothing",
    "VI220": "a port of a spoke could be bound in two ways",
    "VI221": "the hub's order and its spokes differ",
    "VI222": "the hub does not know what to do with this evidence",
    "VI223": "a name is taken twice, or is not a name",
    "VI301": "an input file is missing or not a file",
    "VI302": "an input file is broken or of another format",
    "VI303": "an input is larger than the limits",
    "VI304": "an input is missing or not wanted",
    "VI305": "an input has the wrong kind, type or shape",
    "VI306": "a calibration is wrong",
    "VI307": "inputs do not fit each other",
    "VI401": "a module raised an error",
    "VI402": "a module's output is not what it declared",
    "VI403": "a module broke the contract",
    "VI404": "a loop reached its bound without ending, and the graph says that this is a failure",
    "VI501": "a plugin could not be loaded",
    "VI502": "two distributions claim one name",
    "VI503": "a plugin was written for another version of the contract",
    "VI504": "no plugin of that name",
    "VI601": "a file could not be written",
    "VI602": "the output folder is not empty and is not a visint run",
    "VI603": "this type of array cannot be written in that format",
    "VI701": "the command line is wrong",
    "VI130": "interrupted",
}
"""Every error code with what it means; the reference page is made from this table."""


_NEXT: dict[str, str] = {
    "VI301": "the path of a file that is there",
    "VI302": "the file written anew, or another one",
    "VI303": "a smaller one: cropped, or every second row and column",
    "VI304": "visint show GRAPH   (what it is given)",
    "VI305": "the file written anew as what is wanted",
    "VI306": "the calibration of these images, whole",
    "VI307": "images of one size, and the calibration of that size",
    "VI401": "--debug   (where in the module), and tell whoever wrote it",
    "VI402": "tell whoever wrote the module: visint.testing.ModuleContract finds it",
    "VI403": "tell whoever wrote the module: visint.testing.ModuleContract finds it",
    "VI404": "on_exhausted: accept   (or more turns)",
    "VI501": "visint modules   (what is broken), then install it anew or remove it",
    "VI502": "pip uninstall one of the two",
    "VI503": "a version of the plugin for this visint",
    "VI504": "visint modules   (what is installed)",
    "VI601": "another folder",
    "VI603": "another format",
    "VI701": "visint VERB --help",
}
"""What to try next where a problem has no line to paste, by code."""


@dataclass(frozen=True, slots=True)
class Where:
    """A place: a file, a line and column in it (from 1), and the path of keys down to it."""

    file: str = ""
    line: int = 0
    column: int = 0
    path: str = ""

    def __str__(self) -> str:
        spot = f"{self.file}:{self.line}:{self.column}" if self.line else self.file
        return " ".join(part for part in (spot, self.path) if part)


@dataclass(frozen=True, slots=True)
class Problem:
    """One thing that is wrong: what was found and wanted, the choices there are, the line to write.

    Parameters
    ----------
    code
        A key of :data:`CODES`.
    found
        One sentence: what was found, what was wanted. Never the contents of an array.
    where
        Where it was found.
    choices
        Every valid choice, led by what they are: ``"outputs of 'depth' (stereo.depth): depth: Depth"``.
    write
        A line to paste.
    fault
        Whose fault it is.
    """

    code: str
    found: str
    where: Where = Where()
    choices: str = ""
    write: str = ""
    fault: Fault = "graph"

    def __str__(self) -> str:
        place = str(self.where)
        head = f"{self.code} {place}: {self.found}" if place else f"{self.code}: {self.found}"
        tail = "   ".join(
            part
            for part in (
                f"{self.choices}." if self.choices else "",
                f"Write: {self.write}"
                if self.write
                else f"Try: {_NEXT[self.code]}."
                if self.code in _NEXT
                else "",
                f"[{self.fault}]",
            )
            if part
        )
        return f"{_printable(head)}\n  {_printable(tail)}"


def _printable(text: str) -> str:
    """What a file brings into a message shall not steer a terminal."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


class VisintError(Exception):
    """The root of everything visint raises on purpose.

    ``str(error)`` is what a person should read; :attr:`problems` is the same, taken apart.
    """

    exit_code: ClassVar[int] = 4
    fault: ClassVar[Fault] = "visint"

    def __init__(self, problems: Problem | Iterable[Problem]) -> None:
        self.problems: tuple[Problem, ...] = (problems,) if isinstance(problems, Problem) else tuple(problems)
        super().__init__("\n".join(str(problem) for problem in self.problems))

    @classmethod
    def of(cls, code: str, found: str, *, where: str = "", choices: str = "", write: str = "") -> Self:
        """An error with one problem, whose fault follows from the class."""
        return cls(Problem(code, found, Where(where), choices, write, cls.fault))

    def __reduce__(self) -> tuple[type[VisintError], tuple[tuple[Problem, ...]]]:
        return type(self), (self.problems,)


class GraphError(VisintError):
    """The graph file, or a graph built in code, is wrong: mend the graph."""

    exit_code = 2
    fault = "graph"


class UsageError(VisintError):
    """The command line, or a call of the Python interface, is wrong."""

    exit_code = 2
    fault = "usage"


class InputError(VisintError):
    """An image, a calibration or another input is missing, broken or does not fit."""

    exit_code = 3
    fault = "input"


class PluginError(VisintError):
    """A plugin is missing, ambiguous, or failed to load: mend the installation."""

    exit_code = 4
    fault = "plugin"


class ModuleError(VisintError):
    """A module failed while it ran; names node, module, version, level and turn."""

    exit_code = 4
    fault = "plugin"


class OutputError(VisintError):
    """A result could not be written: disk, folder or format."""

    exit_code = 5
    fault = "output"


class Cancelled(VisintError):  # noqa: N818 - being interrupted is no error
    """The run was interrupted; nothing half-written is left."""

    exit_code = 130
    fault = "usage"
