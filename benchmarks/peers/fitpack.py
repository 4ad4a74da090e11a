#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""FITPACK (through SciPy) and batten on the same clouds in one run: truth error, control points, seconds.
Needs numpy, scipy and a release build. Usage: fitpack.py [points]"""
import json
import os
import subprocess
import sys
import tempfile
import time

import numpy as np
from scipy.interpolate import BSpline, SmoothBivariateSpline

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BATTEN = os.path.join(ROOT, "build/release/bin/batten")
SIGMA = 1e-3


def franke(x, y):
    return (0.75 * np.exp(-((9 * x - 2) ** 2 + (9 * y - 2) ** 2) / 4) + 0.75 * np.exp(-((9 * x + 1) ** 2) / 49 - (9 * y + 1) / 10)
            + 0.5 * np.exp(-((9 * x - 7) ** 2 + (9 * y - 3) ** 2) / 4) - 0.2 * np.exp(-((9 * x - 4) ** 2) - (9 * y - 7) ** 2))


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 20000
    random = np.random.default_rng(1)
    x, y = random.random(count), random.random(count)
    z = franke(x, y) + random.normal(0, SIGMA, count)
    grid = np.linspace(0, 1, 201)
    gx, gy = np.meshgrid(grid, grid, indexing="ij")
    truth = franke(gx, gy)
    start = time.time()
    spline = SmoothBivariateSpline(x, y, z, bbox=[0, 1, 0, 1], s=count * SIGMA**2)
    seconds = time.time() - start
    error = spline(grid, grid) - truth
    print(f"{'FITPACK surfit':16} n {spline.get_coeffs().size:5}  vertical rms {np.sqrt((error**2).mean()):.2e}  max {abs(error).max():.2e}  {seconds:.2f} s (σ given)")
    with tempfile.TemporaryDirectory() as folder:
        cloud, out, truth_file = (os.path.join(folder, name) for name in ("cloud.xyz", "out.json", "truth.xyz"))
        np.savetxt(cloud, np.c_[x, y, z], fmt="%.17g")
        np.savetxt(truth_file, np.c_[gx.ravel(), gy.ravel(), truth.ravel()], fmt="%.17g")
        start = time.time()
        subprocess.run([BATTEN, "fit", "surface", cloud, "-o", out, "--quiet"], check=True)
        seconds = time.time() - start
        report = json.loads(subprocess.check_output([BATTEN, "compare", out, truth_file, "--json"]))
        with open(out) as f:
            s = json.load(f)["shape"]["data"][0]
        # The plane base keeps x and y linear in the parameters, so heights compare as FITPACK's do.
        points = np.array(s["control_points"]["points"]).reshape(s["size_u"], s["size_v"], 3)
        ku, kv = np.array(s["knotvector_u"]), np.array(s["knotvector_v"])
        x0, y0 = points[0, 0, 0], points[0, 0, 1]
        bu = BSpline.design_matrix(grid - x0, ku, s["degree_u"]).toarray()
        bv = BSpline.design_matrix(grid - y0, kv, s["degree_v"]).toarray()
        error = bu @ points[:, :, 2] @ bv.T - truth
        print(f"{'batten':16} n {s['size_u'] * s['size_v']:5}  vertical rms {np.sqrt((error**2).mean()):.2e}  max {abs(error).max():.2e}  {seconds:.2f} s (files included)"
              f"\n{'':16} orthogonal rms {report['error']['rms']:.2e}  max {report['error']['max']:.2e}")


main()
