"""Where data lies."""

from __future__ import annotations

import os
from pathlib import Path

from visint.errors import InputError

__all__ = ["data_folder"]


def data_folder(part: str = "") -> Path:
    """The folder ``part`` of the data, whose root the environment variable ``VISINT_DATA`` names.

    Without it the folder ``../shared/data`` beside the working folder is tried.

    Raises
    ------
    InputError
        If it is not there.
    """
    root = Path(os.environ.get("VISINT_DATA", "../shared/data"))
    folder = root / part
    if not folder.is_dir():
        raise InputError.of(
            "VI301", f"there is no folder {part or root.name!r} of data", write="VISINT_DATA=FOLDER visint …"
        )
    return folder
