"""Start-up by allow-list: what a call loads, in a fresh process each. Clocks differ; modules do not."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

HEAVY = ["numpy", "pydantic", "networkx", "cv2", "scipy", "numba"]
LATER = ["cv2", "scipy", "numba"]
TELL = "; import sys, json; sys.stderr.write(json.dumps(sorted({m.partition('.')[0] for m in sys.modules})))"
CALL = "from visint.cli.main import main; main({})"


def loaded(code):
    done = subprocess.run([sys.executable, "-c", code + TELL], capture_output=True, text=True, check=True)
    return set(json.loads(done.stderr)), done.stdout


@pytest.mark.parametrize(
    "code",
    ["import visint", "import visint.cli", CALL.format(["--help"]), CALL.format(["--version"])],
    ids=["import", "cli", "help", "version"],
)
def test_looking_loads_nothing_heavy(code):
    """``import visint`` and ``--help`` load none of the libraries that take time."""
    modules, _ = loaded(code)
    assert not modules & set(HEAVY)


def test_help_lists_plugins_verbs_without_importing_them():
    modules, out = loaded(CALL.format(["--help"]))
    assert "demo" in out
    assert not {"visint_lab", "visint_stereo"} & modules


def test_checking_and_showing_load_no_vision_library():
    """Of either shipped graph, the looped one too."""
    calls = [["check", "stereo_sgm"], ["check", "stereo"], ["show", "stereo"], ["schema", "--installed"]]
    modules, out = loaded("from visint.cli.main import main" + "".join(f"; main({each})" for each in calls))
    assert not modules & set(LATER)
    assert out.count(": sound") == 2
