"""The two refusals that every reader makes: a file is broken, or is not what is wanted."""

from __future__ import annotations

from visint.errors import InputError, OutputError, Problem, Where

__all__ = ["broken", "inexact", "unfit"]


def broken(name: str, found: str, *, line: int = 0, column: int = 1, choices: str = "") -> InputError:
    """VI302: the file ``name`` is damaged, cut off, or in another format."""
    return InputError(Problem("VI302", found, Where(name, line, column), choices, fault="input"))


def unfit(name: str, found: str, *, choices: str = "", write: str = "") -> InputError:
    """VI305: the file ``name`` is whole, and holds another kind, type or shape than is wanted."""
    return InputError(Problem("VI305", found, Where(name), choices, write, "input"))


def inexact(found: str) -> OutputError:
    """VI603: the array would lose something in this format."""
    return OutputError(Problem("VI603", found, fault="output"))
