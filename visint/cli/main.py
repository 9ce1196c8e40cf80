"""The program: verbs, what happens to errors, exit codes.

0 done; 1 some items failed; 2 usage or graph; 3 inputs; 4 module or engine; 5 disk or lock; 130 interrupted.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

import typer

from visint.cli import check, modules, run, schema, show
from visint.cli.verbs import Verbs
from visint.errors import VisintError

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
        app.command(name=verb.__name__.rpartition(".")[2], epilog=verb.EXAMPLES)(verb.command)
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
    """Runs the program and leaves with its exit code."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    debug = "--debug" in given
    if debug:
        given.remove("--debug")
    code = _run(given, debug)
    if arguments is None:
        sys.exit(code)
    return code


def _run(given: list[str], debug: bool) -> int:
    try:
        left_with = typer.main.get_command(application()).main(given, prog_name="visint", standalone_mode=False)
        return left_with if isinstance(left_with, int) else 0
    except VisintError as error:
        if debug:
            raise
        typer.echo(str(error), err=True)
        return error.exit_code
    except (KeyboardInterrupt, typer.Abort):
        typer.echo("interrupted; nothing half-written is left", err=True)
        return 130
    except BrokenPipeError:  # the reader of our output went away, as `| head` does
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except Exception as error:
        return _unforeseen(error, debug)


def _unforeseen(error: Exception, debug: bool) -> int:
    show = getattr(error, "show", None)  # what click says of a wrong command line, whichever click it is
    if show is not None:
        show()
        return 2
    if debug:
        raise error
    told = f"visint: an unexpected {type(error).__name__}: {error}\n  [visint]   see it whole: --debug"
    typer.echo(told, err=True)
    return 4
