# SPDX-License-Identifier: MIT
"""The interpreter goes on while fits are at work; several run at once; Ctrl-C ends them at once; progress tells."""
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest

import batten
from conftest import SANITIZED, helix, sheet


def longest_silence(work):
    """The longest pause of another thread's loop while `work` runs, and how long that took."""
    stop, beats = threading.Event(), []

    def beat():
        while not stop.is_set():
            beats.append(time.perf_counter())
            time.sleep(0.001)

    thread = threading.Thread(target=beat)
    thread.start()
    begin = time.perf_counter()
    work()
    took = time.perf_counter() - begin
    stop.set()
    thread.join()
    during = [b for b in beats if begin <= b <= begin + took]
    return max(np.diff([begin, *during, begin + took])), took


@pytest.mark.parametrize(
    "work",
    [
        lambda: batten.fit_surface(sheet(20000, 1e-3), threads=1),
        lambda: batten.make.torus(3, 1).closest(np.random.default_rng(1).normal(size=(40000, 3)), threads=1),
        lambda: batten.make.torus(3, 1).tessellate(5e-4),
        lambda: batten.make.torus(3, 1).curvature(np.random.default_rng(1).random(900000), 0.3, threads=1),
    ],
    ids=["fit", "closest", "tessellate", "curvature"],
)
def test_the_lock_is_released(work):
    silence, took = longest_silence(work)
    assert took > 0.05 and silence < 0.5 * took


def test_fits_at_once_are_as_one_by_one():
    clouds = [sheet(500, 1e-3, seed) for seed in range(4)]
    alone = [batten.fit_surface(cloud).surface for cloud in clouds]
    together = [None] * 4

    def fit(k):
        together[k] = batten.fit_surface(clouds[k]).surface

    threads = [threading.Thread(target=fit, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert together == alone


def test_files_are_written_at_once(tmp_path):
    s = batten.make.sphere(1)
    threads = [threading.Thread(target=s.to_step, args=(tmp_path / f"{k}.step",)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len({(tmp_path / f"{k}.step").read_bytes() for k in range(4)}) == 1


def test_one_surface_is_asked_by_many_threads():
    s = batten.make.torus(3, 1)
    u = np.linspace(0, 1, 5000)
    results = [None] * 6

    def ask(k):
        results[k] = (s(u, 0.3), s.closest(np.zeros((5, 3)) + [1, k, 0]).distances)

    threads = [threading.Thread(target=ask, args=(k,)) for k in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(r[0], results[0][0]) for r in results)


CALLS = {
    "surface": "batten.fit_surface(points)",
    "progress": "batten.fit_surface(points, progress=lambda stage, fraction: None)",
    "closest": "batten.make.torus(3, 1).closest(np.concatenate([points] * 4))",
    "tessellate": "batten.make.torus(3, 1).tessellate(1e-7)",
}


@pytest.mark.parametrize("call", CALLS)
def test_ctrl_c_raises_within_three_tenths(call):
    program = textwrap.dedent(
        f"""
        import os, signal, threading, time
        import numpy as np
        import batten
        xy = np.random.default_rng(1).random((400000, 2))
        points = np.column_stack([xy, 0.1 * np.sin(20 * xy[:, 0]) * np.cos(17 * xy[:, 1]) + 1e-3 * np.random.default_rng(2).normal(size=len(xy))])
        sent = []
        def interrupt():
            time.sleep(0.3)
            sent.append(time.perf_counter())
            os.kill(os.getpid(), signal.SIGINT)
        threading.Thread(target=interrupt).start()
        try:
            {CALLS[call]}
            print("finished")
        except KeyboardInterrupt:
            print("interrupted", time.perf_counter() - sent[0])
        assert batten.fit_curve([[0, 0], [1, 1], [2, 0], [3, 1], [4, 4]]).ok  # what comes after works
        """
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=100)
    assert run.returncode == 0, run.stderr
    word, seconds = run.stdout.split()
    assert word == "interrupted" and (float(seconds) < 0.3 or SANITIZED)


def test_ctrl_c_that_nobody_catches_ends_the_program():
    program = "import numpy as np, batten, os, threading, signal\n" + (
        "threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()\n"
        "batten.make.torus(3, 1).tessellate(1e-7)\n"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=100)
    assert run.returncode == -signal.SIGINT and "KeyboardInterrupt" in run.stderr


def test_progress_tells_how_far_it_is():
    told = []
    batten.fit_surface(sheet(5000, 1e-3), progress=lambda stage, fraction: told.append((stage, fraction)))
    fractions = [fraction for _, fraction in told]
    assert fractions == sorted(fractions) and fractions[0] == 0 and fractions[-1] == 1
    assert {stage for stage, _ in told} <= {"prepare", "order", "parameterize", "solve", "refine", "optimize", "measure"}


@pytest.mark.parametrize(
    "call",
    [
        lambda tell: batten.fit_surface(sheet(3000), progress=tell),
        lambda tell: batten.fit_curve(helix(300), progress=tell),
        lambda tell: batten.fit_primitive(batten.make.sphere(1).sample(500), progress=tell),
        lambda tell: batten.compare(batten.make.sphere(1), sheet(50), progress=tell),
    ],
)
def test_what_progress_raises_comes_out(call):
    class Enough(Exception):
        pass

    def tell(stage, fraction):
        raise Enough

    with pytest.raises(Enough):
        call(tell)


def test_progress_that_says_no_ends_the_fit():
    points = sheet(60000, 1e-3)
    points[:, 2] += 0.05 * np.sin(40 * points[:, 0]) * np.sin(35 * points[:, 1])

    def until(limit):
        return lambda stage, fraction: fraction < limit

    with pytest.raises(batten.Cancelled):
        batten.fit_surface(points, progress=lambda stage, fraction: False)
    begin = time.perf_counter()
    try:
        fit = batten.fit_surface(points, tolerance=1e-5, progress=until(0.7))
        assert fit.report["termination"] == "cancelled" and not fit.ok
    except batten.Cancelled:
        pass
    assert time.perf_counter() - begin < 60


def test_the_bar_of_our_own(capsys, monkeypatch):
    from batten import _progress

    monkeypatch.setattr(_progress, "PATIENCE", 0)
    monkeypatch.setitem(sys.modules, "tqdm", None)
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    batten.fit_surface(sheet(3000, 1e-3), progress=True)
    assert "|" in capsys.readouterr().err


def test_the_bar_of_tqdm(monkeypatch):
    import types

    told = []

    class Bar:
        n = 0.0

        def __init__(self, **keywords):
            assert keywords["total"] == 100

        def set_description(self, text, refresh):
            told.append(text)

        def update(self, by):
            self.n += by

        def close(self):
            told.append(self.n)

    monkeypatch.setitem(sys.modules, "tqdm", types.ModuleType("tqdm"))
    auto = types.ModuleType("tqdm.auto")
    auto.tqdm = Bar
    monkeypatch.setitem(sys.modules, "tqdm.auto", auto)
    batten.fit_surface(sheet(300), progress=True)
    assert told[-1] == pytest.approx(100) and len(told) > 1
