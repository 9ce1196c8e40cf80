"""The command line: one file a verb; plugins add verbs of their own through ``visint.commands``."""

from visint.cli.main import main

__all__ = ["main"]
