#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""One job of batten through its Python module, for `compare`: prints a line of name=value (seconds on the wall and of the
processor, numbers, errors against the truth), as `jobs` does for the same in C++. Clouds are raw doubles x y z.
Usage: batten_module.py surface CLOUD.f64 THREADS          Franke's heights, fitted; orthogonal distances of the truth
       batten_module.py curve CLOUD.f64 THREADS LINE.f64   points in a row, fitted; many points of it
       batten_module.py evaluate SHEET.f64 COUNT THREADS   points at random parameters of a bicubic sheet"""
import statistics
import sys
import time

import numpy as np

import batten

CHORDS = 20000


def franke(x, y):
    return (0.75 * np.exp(-((9 * x - 2) ** 2 + (9 * y - 2) ** 2) / 4) + 0.75 * np.exp(-((9 * x + 1) ** 2) / 49 - (9 * y + 1) / 10)
            + 0.5 * np.exp(-((9 * x - 7) ** 2 + (9 * y - 3) ** 2) / 4) - 0.2 * np.exp(-((9 * x - 4) ** 2) - (9 * y - 7) ** 2))


def run(job):
    """As the other programs do: at most five runs, no more once a second of processor time has gone."""
    wall, cpu = [], []
    result = None
    while not wall or (len(wall) < 5 and sum(cpu) < 1):
        result = None  # let go before the next, as in C++
        start, begin = time.perf_counter(), time.process_time()
        result = job()
        cpu.append(time.process_time() - begin)
        wall.append(time.perf_counter() - start)
    print(f"wall={statistics.median(wall):.6g} cpu={statistics.median(cpu):.6g}", end="")
    return result


def surface(cloud, threads):
    points = np.fromfile(cloud).reshape(-1, 3)
    fit = run(lambda: batten.fit_surface(points, threads=int(threads)))
    lines = np.linspace(0, 1, 201)
    x, y = np.meshgrid(lines, lines, indexing="ij")
    errors = batten.compare(fit.surface, np.column_stack([x.ravel(), y.ravel(), franke(x, y).ravel()])).distances
    print(f" numbers={fit.surface.weights.size} rms={np.sqrt((errors**2).mean()):.4e} max={np.abs(errors).max():.4e}")


def curve(cloud, threads, line):
    points = np.fromfile(cloud).reshape(-1, 3)
    made = run(lambda: batten.fit_curve(points, threads=int(threads))).curve
    made(np.linspace(*made.domain, CHORDS + 1)).tofile(line)
    print(f" numbers={len(made.control_points)}")


def evaluate(sheet, count, threads):
    numbers = np.fromfile(sheet)
    n, m = (int(x) for x in numbers[:2])
    knots_u, knots_v, net = np.split(numbers[2:], [n + 4, n + m + 8])
    made = batten.Surface(3, knots_u, knots_v, net.reshape(n, m, 3))
    u, v = np.random.default_rng(1).random((2, int(count)))
    points = run(lambda: made(u, v, threads=int(threads)))
    print(f" rms={np.linalg.norm(points) / np.sqrt(len(points)):.4e}")


JOBS = {"surface": (surface, 2), "curve": (curve, 3), "evaluate": (evaluate, 3)}
name, words = (sys.argv[1] if len(sys.argv) > 1 else ""), sys.argv[2:]
if name not in JOBS or len(words) != JOBS[name][1]:
    sys.exit(__doc__)
JOBS[name][0](*words)
