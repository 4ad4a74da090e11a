# SPDX-License-Identifier: MIT
"""What the documents say works: the guide's examples, the notebook, docstrings, the time of an import."""
import ast
import importlib.util
import inspect
import json
import os
import re
import shutil
import subprocess
import sys

import numpy as np
import pytest

import batten
from conftest import ROOT, SANITIZED

GUIDE = open(os.path.join(ROOT, "docs", "python.md"), encoding="utf-8").read()
EXAMPLES = re.findall(r"```python\n(.*?)```", GUIDE, re.S)
PACKAGES = os.path.dirname(os.path.dirname(os.path.abspath(batten.__file__)))
NOTEBOOK = os.path.join(ROOT, "examples", "scan_to_step.ipynb")


def test_examples_of_the_guide(tmp_path, monkeypatch, capsys):
    assert len(EXAMPLES) == 10
    monkeypatch.chdir(tmp_path)
    names = {"__name__": "__main__"}
    for number, example in enumerate(EXAMPLES, 1):  # each goes on where the one before ended, as a reader does
        exec(compile(example, f"docs/python.md, example {number}", "exec"), names)
        if number == 9:
            assert abs(names["fit"].surface.control_points[0, 0] - names["corner"][0]).max() < 1e-3
    assert {"sheet.step", "sheet.html", "sheet.ply", "pin.step", "off.ply", "all.json", "ring.step", "ring.brep"} <= {p.name for p in tmp_path.iterdir()}
    assert batten.read_geometry("pin.step")[0].classify()[0] == "cylinder"
    assert names["solid"].genus == 1 and names["solid"].volume == pytest.approx(2 * np.pi**2 * 10 * 4**2, rel=0.01)
    assert names["sewing"].watertight


def test_links_of_the_guide():
    headings = {re.sub(r"[^\w\- ]", "", h.lower()).replace(" ", "-") for h in re.findall(r"^## (.*)$", GUIDE, re.M)}
    assert set(re.findall(r"\]\(#([^)]+)\)", GUIDE)) <= headings


def notebook_cells():
    return ["".join(cell["source"]) for cell in json.load(open(NOTEBOOK, encoding="utf-8"))["cells"] if cell["cell_type"] == "code"]


def test_the_notebook_as_a_script(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("BATTEN_DATA", os.path.join(ROOT, "data"))
    names = {"__name__": "__main__"}
    for cell in notebook_cells():
        body = ast.parse(cell).body
        exec(compile(ast.Module(body, []), NOTEBOOK, "exec"), names)
    assert (tmp_path / "panel.step").exists() and names["fit"].ok
    assert names["fit"]._repr_html_().startswith("<iframe")


@pytest.mark.skipif(
    not (importlib.util.find_spec("nbconvert") and importlib.util.find_spec("ipykernel")),
    reason="the notebook ran as a script; in Jupyter it needs python3-nbconvert and python3-ipykernel",
)
def test_the_notebook_in_jupyter(tmp_path):
    environment = {**os.environ, "BATTEN_DATA": os.path.join(ROOT, "data"), "JUPYTER_ALLOW_INSECURE_WRITES": "1"}
    given = shutil.copy(NOTEBOOK, tmp_path / "given.ipynb")  # Jupyter works where the notebook is
    words = ["-m", "nbconvert", "--to", "notebook", "--execute", str(given), "--output", "done"]
    environment["PYTHONPATH"] = PACKAGES
    run = subprocess.run([sys.executable, *words], env=environment, capture_output=True, text=True, timeout=120, cwd=tmp_path)
    assert run.returncode == 0, run.stderr[-2000:]
    done = json.load(open(tmp_path / "done.ipynb"))
    shown = [output for cell in done["cells"] for output in cell.get("outputs", [])]
    assert any("<iframe" in "".join(o.get("data", {}).get("text/html", [])) for o in shown)


def documented():
    for name in batten.__all__:
        thing = getattr(batten, name)
        if inspect.isfunction(thing):
            yield name, thing
        elif inspect.isclass(thing):
            yield name, thing
            for method, function in vars(thing).items():
                if not method.startswith("_") or method == "__call__":
                    yield f"{name}.{method}", function
    for name in batten.make.__all__:
        yield "make." + name, getattr(batten.make, name)


DOCUMENTED = dict(documented())


@pytest.mark.parametrize("name", DOCUMENTED)
def test_docstrings(name):
    thing = DOCUMENTED[name]
    if isinstance(thing, (classmethod, staticmethod)):
        thing = thing.__func__
    if isinstance(thing, property):
        assert len(inspect.getdoc(thing)) > 10
        return
    if not inspect.isfunction(thing) and not inspect.isclass(thing):
        return  # the fields of tuples, which their class documents
    text = inspect.getdoc(thing)
    assert text and text.splitlines()[0].strip()
    if inspect.isclass(thing):
        fields = getattr(thing, "_fields", ())
        assert all(re.search(rf"^(\w+, )*{field}(, \w+)* : ", text, re.M) for field in fields)
        return
    signature = inspect.signature(thing)
    asked = [p for p in signature.parameters if p not in ("self", "cls")]
    for parameter in asked:
        assert re.search(rf"^(\*\*|[\w, ]*\b){parameter}\b[\w, ]* : |^\*\*{parameter}$", text, re.M), parameter
    if asked:
        assert "Parameters\n----------" in text
    if signature.return_annotation not in ("None", None, inspect.Signature.empty):
        assert "Returns\n-------" in text


def test_an_import_takes_little_and_little_with_it():
    clock = "time.process_time()"  # whatever else the machine does
    program = f"import numpy, sys, time; begin = {clock}; import batten; print({clock} - begin); print(*sys.modules)"
    runs = [subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout for _ in range(3)]
    assert min(float(run.split()[0]) for run in runs) < 0.15 or SANITIZED
    assert not {"scipy", "matplotlib", "tqdm", "pandas"} & set(runs[0].split())
