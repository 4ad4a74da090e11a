#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""FITPACK's splprep (through SciPy), SISL's s1961 where it was built, and batten on the same ordered points
in one run: control points, truth error, seconds; medians of five seeds, as a Markdown table. Only batten is
not told the noise. Needs numpy, scipy and a bench build; for SISL (libsisl-dev, AGPL) also
`cmake --build --preset bench --target sisl_curves`. Usage: fitpack_curves.py [FOLDER OF THE PROGRAMS]"""
import json
import os
import subprocess
import sys
import tempfile
import time

import numpy as np
from scipy.interpolate import BSpline, splev, splprep

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PROGRAMS = sys.argv[1] if len(sys.argv) > 1 else os.path.join(ROOT, "build/bench/bin")
CURVES, BATTEN, SISL = (os.path.join(PROGRAMS, name) for name in ("curve_fitting", "batten", "sisl_curves"))
SIGMA = 1e-4
SEEDS = range(1, 6)
CHORDS = 20000


def run(*words):
    return subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True).stdout


def fitpack(cloud, line):
    points = np.loadtxt(cloud)
    start = time.perf_counter()
    (knots, coefficients, degree), _ = splprep(points.T, s=points.size * SIGMA**2, k=3)
    seconds = time.perf_counter() - start
    np.savetxt(line, np.transpose(splev(np.linspace(0, 1, CHORDS + 1), (knots, coefficients, degree))), fmt="%.17g")
    return len(knots) - degree - 1, seconds


def sisl(tolerance, share):
    def fit(cloud, line):
        count, seconds = run(SISL, cloud, tolerance, share, line).split()
        return int(count), float(seconds)
    return fit


def batten(threads):
    def fit(cloud, line):
        out = line + ".json"
        report = json.loads(run(BATTEN, "fit", "curve", cloud, "-o", out, "--json", "--threads", threads))
        with open(out) as f:
            curve = json.load(f)["shape"]["data"][0]
        spline = BSpline(np.array(curve["knotvector"]), np.array(curve["control_points"]["points"]), curve["degree"])
        np.savetxt(line, spline(np.linspace(0, 1, CHORDS + 1)), fmt="%.17g")
        seconds = report["seconds"]
        return report["geometry"]["control_points"][0], seconds["total"] - seconds["read"] - seconds["write"]
    return fit


def main():
    tools = {"FITPACK splprep, s = 3Nσ²": fitpack, "batten, 1 thread": batten(1), "batten, 2 threads": batten(2)}
    if os.path.exists(SISL):
        # Tolerances by which it does best.
        for share in (0, 0.1):
            tools[f"SISL s1961, share {share}"] = {"2k": sisl(4e-4, share), "100k": sisl(1e-3, share)}
    print("| ordered helix, σ = 1e-4 | tool | control points | truth rms | truth max | back max | seconds |\n|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        run(CURVES, "clouds", folder)
        line = os.path.join(folder, "line.xyz")
        for size in ("2k", "100k"):
            rows = {name: [] for name in tools}
            for seed in SEEDS:
                cloud = os.path.join(folder, f"helix_{size}_{seed}.xyz")
                for name, tool in tools.items():
                    count, seconds = (tool[size] if isinstance(tool, dict) else tool)(cloud, line)
                    error = [float(word) for word in run(CURVES, "measure", "helix", line).split()]
                    rows[name].append([count, *error, seconds])
            for name, found in rows.items():
                count, rms, most, back, seconds = np.median(found, axis=0)
                print(f"| {size} | {name} | {count:.0f} | {rms:.2e} | {most:.2e} | {back:.2e} | {seconds:.3f} |", flush=True)


main()
