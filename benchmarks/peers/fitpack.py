#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""One job of FITPACK through SciPy, for `compare`: prints a line of name=value (seconds on the wall and of the
processor, numbers, errors against the truth). Clouds are raw doubles x y z. Errors of `least_squares` are vertical,
those of `smooth` along the normals of the truth, to first order. Needs numpy and scipy.
Usage: fitpack.py least_squares CLOUD.f64 NET    heights over x y at uniform knots, NET × NET (LSQBivariateSpline)
       fitpack.py smooth CLOUD.f64 SIGMA         heights, knots from the noise (SmoothBivariateSpline)
       fitpack.py curve CLOUD.f64 SIGMA LINE.f64 points in a row, knots from the noise (splprep); many points of it
       fitpack.py grid LINES                     Franke's function on a grid, interpolated (RectBivariateSpline)"""
import statistics
import sys
import time
import warnings

import numpy as np
from scipy.interpolate import LSQBivariateSpline, RectBivariateSpline, SmoothBivariateSpline, splev, splprep

SIDE = 201
CHORDS = 20000


def franke(x, y):
    return (0.75 * np.exp(-((9 * x - 2) ** 2 + (9 * y - 2) ** 2) / 4) + 0.75 * np.exp(-((9 * x + 1) ** 2) / 49 - (9 * y + 1) / 10)
            + 0.5 * np.exp(-((9 * x - 7) ** 2 + (9 * y - 3) ** 2) / 4) - 0.2 * np.exp(-((9 * x - 4) ** 2) - (9 * y - 7) ** 2))


def run(job):
    """As the other programs do: at most five runs, no more once a second of processor time has gone."""
    wall, cpu = [], []
    while not wall or (len(wall) < 5 and sum(cpu) < 1):
        start, begin = time.perf_counter(), time.process_time()
        result = job()
        cpu.append(time.process_time() - begin)
        wall.append(time.perf_counter() - start)
    print(f"wall={statistics.median(wall):.6g} cpu={statistics.median(cpu):.6g}", end="")
    return result


def read(path):
    return np.fromfile(path).reshape(-1, 3)


def print_heights(spline, side=SIDE, along_normals=False, largest=True):
    lines = np.linspace(0, 1, side)
    x, y = np.meshgrid(lines, lines, indexing="ij")
    error = spline(lines, lines) - franke(x, y)
    if along_normals:
        step = 1e-5
        dx = (franke(x + step, y) - franke(x - step, y)) / (2 * step)
        dy = (franke(x, y + step) - franke(x, y - step)) / (2 * step)
        error /= np.sqrt(1 + dx**2 + dy**2)
    print(f" numbers={spline.get_coeffs().size} rms={np.sqrt((error**2).mean()):.4e}" + (f" max={abs(error).max():.4e}" if largest else ""))


def least_squares(cloud, net):
    x, y, z = read(cloud).T
    knots = np.linspace(0, 1, int(net) - 2)[1:-1]
    print_heights(run(lambda: LSQBivariateSpline(x, y, z, knots, knots, bbox=[0, 1, 0, 1])))


def smooth(cloud, sigma):
    x, y, z = read(cloud).T
    squares = z.size * float(sigma) ** 2
    print_heights(run(lambda: SmoothBivariateSpline(x, y, z, bbox=[0, 1, 0, 1], s=squares)), along_normals=True)


def curve(cloud, sigma, line):
    points = read(cloud)
    (knots, coefficients, degree), _ = run(lambda: splprep(points.T, s=points.size * float(sigma) ** 2, k=3))
    np.transpose(splev(np.linspace(0, 1, CHORDS + 1), (knots, coefficients, degree))).tofile(line)
    print(f" numbers={len(knots) - degree - 1}")


def grid(lines):
    places = np.linspace(0, 1, int(lines))
    heights = franke(*np.meshgrid(places, places, indexing="ij"))
    print_heights(run(lambda: RectBivariateSpline(places, places, heights)), min(4 * (int(lines) - 1), 2000) + 1, largest=False)


JOBS = {"least_squares": (least_squares, 2), "smooth": (smooth, 2), "curve": (curve, 3), "grid": (grid, 1)}
name, words = (sys.argv[1] if len(sys.argv) > 1 else ""), sys.argv[2:]
if name not in JOBS or len(words) != JOBS[name][1]:
    sys.exit(__doc__)
warnings.simplefilter("ignore")
JOBS[name][0](*words)
