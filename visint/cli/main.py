"""The program: verbs, what happens to errors, exit codes.

0 done; 1 some items failed; 2 usage or graph; 3 inputs; 4 module or engine; 5 disk or lock; 130 interrupted.
"""

from __future__ import annotations

import sys
import traceback
from collections.abc import Sequence

import typer

from visint.cli import check, modules, run, schema, show
from visint.cli.verbs import Verbs, listed_examples
from visint.errors import UsageError, VisintError

__all__ = ["application", "main"]

EPILOG = "--debug, anywhere, shows the traceback of an error. NO_COLOR is respected."


def application() -> typer.Typer:
    """The whole command line, plugins' verbs included."""
    app = typer.Typer(
        name="visint",
        help="Recover 3-D structure from a stereo pair by integrating vision modules.",
        epilog=EPILOG,
        cls=Verbs,
        no_args_is_help=True,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    app.callback()(_top)
    for verb in (run, check, show, modules, schema):
        name, about = verb.__name__.rpartition(".")[2], (verb.command.__doc__ or "").partition(".")[0]
        app.command(name=name, short_help=about, epilog=listed_examples(verb.EXAMPLES))(verb.command)
    return app


def _version(asked: bool) -> None:
    if asked:
        import visint

        typer.echo(visint.__version__)
        raise typer.Exit


_VERSION = typer.Option(False, "--version", callback=_version, is_eager=True, help="Print the version.")


def _top(version: bool = _VERSION) -> None:
    pass


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the program: leaves with its exit code, or gives it where ``arguments`` are given."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    debug = "--debug" in given
    if debug:
        given.remove("--debug")
    code = _run(given, debug)
    if arguments is None:
        sys.exit(code)
    return code


def _run(given: list[str], debug: bool) -> int:
    command = typer.main.get_command(application())
    try:
        left_with = command.main(given, prog_name="visint", standalone_mode=False)
    except SystemExit as left:
        if isinstance(left.__context__, BrokenPipeError):  # the reader went away, as `| head` does: its right
            return 0
        raise
    except (KeyboardInterrupt, typer.Abort):
        left_with = 130
    except Exception as error:
        if debug:
            traceback.print_exception(error)
        return _told(error)
    if left_with == 130:
        typer.echo("interrupted; nothing half-written is left", err=True)
    return left_with if isinstance(left_with, int) else 0


def _told(error: Exception) -> int:
    """Says what went wrong, in a few lines on stderr; gives the exit code."""
    if isinstance(error, VisintError):
        typer.echo(str(error), err=True)
        return error.exit_code
    show = getattr(error, "show", None)  # what click says of a wrong command line, whichever click it is
    if show is not None:
        show()
        return UsageError.exit_code
    said = " ".join(str(error).split())[:300]
    unforeseen = f"visint: an unexpected {type(error).__name__}: {said}\n  [visint]   see it whole: --debug"
    typer.echo(unforeseen, err=True)
    return VisintError.exit_code
