# SPDX-License-Identifier: MIT
"""The types: the package under mypy's strict rules, what a user's program sees of them, and the stub of the part in C++."""
import importlib.util
import os
import subprocess
import sys

import pytest

import batten
from conftest import ROOT

PACKAGES = os.path.dirname(os.path.dirname(os.path.abspath(batten.__file__)))
MYPY = importlib.util.find_spec("mypy")
CACHE = os.environ.get("BATTEN_MYPY_CACHE", os.devnull)
USER = """
import numpy as np
import batten
fit = batten.fit_surface(np.zeros((9, 3)), tolerance=0.1, degree=(3, 2), progress=lambda stage, fraction: None)
reveal_type(fit.surface(0.5, [0.1, 0.2]))
reveal_type(fit.report)
reveal_type(batten.read_geometry("x.step")[0])
reveal_type(batten.make.sphere(1.0).split("u", 0.5))
batten.fit_surface(np.zeros((9, 3)), tolerance="small")
"""


@pytest.mark.skipif(not MYPY, reason="the types are not checked: mypy is not installed")
def test_types(tmp_path):
    (tmp_path / "user.py").write_text(USER)
    environment = {**os.environ, "MYPYPATH": PACKAGES, "PYTHONPATH": PACKAGES}
    settings = ["--config-file", os.path.join(ROOT, "python", "mypy.ini"), "--cache-dir", CACHE]
    run = subprocess.run(
        [sys.executable, "-m", "mypy", *settings, "-p", "batten"], env=environment, capture_output=True, text=True, cwd=tmp_path
    )
    assert run.returncode == 0, run.stdout
    run = subprocess.run(
        [sys.executable, "-m", "mypy", *settings, "user.py"], env=environment, capture_output=True, text=True, cwd=tmp_path
    )
    lines = run.stdout.splitlines()
    assert len([line for line in lines if ": error:" in line]) == 1 and 'argument "tolerance"' in run.stdout.lower()
    notes = [line for line in lines if "Revealed" in line]
    for note, words in zip(notes, ("ndarray", "dict[builtins.str, Any]", "Geometry", "Tuple[batten._surface.Surface")):
        assert words.lower() in note.lower()


ALLOWED = (
    "Floats Pair Four Tell Contents Faces SewingNumbers Body Body.__init__ Points Points.__init__ Fit Fit.__init__ Solid Solid.__init__"
).split()


@pytest.mark.skipif(not MYPY, reason="the stubs are not checked: mypy is not installed")
def test_stubs_are_what_there_is(tmp_path):
    (tmp_path / "allowed").write_text("".join(f"batten._core.{name}\n" for name in ALLOWED))  # aliases; made by no caller
    words = ["-m", "mypy.stubtest", "batten._core", "--mypy-config-file", os.path.join(ROOT, "python", "mypy.ini")]
    environment = {**os.environ, "MYPYPATH": PACKAGES, "PYTHONPATH": PACKAGES}
    run = subprocess.run(
        [sys.executable, *words, "--allowlist", str(tmp_path / "allowed")], env=environment, capture_output=True, text=True, cwd=tmp_path
    )
    assert run.returncode == 0, run.stdout
