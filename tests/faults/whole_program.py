#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Random clouds, options and commands: nothing crashes, hangs, writes NaN, swings wild or reports what is not so.

    whole_program.py BATTEN [CASES [SEED [FIRST]]]

Case k of a seed is the same every time. Needs numpy. What is wrong is printed with the command, and its
files kept; exit code 1. A thousand cases take some 15 minutes of one core."""
import csv
import json
import math
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import numpy as np

TIME_LIMIT = 5  # seconds of a fit
MOST_SECONDS, MOST_WALL = 40, 600  # of all processors, with reading, measuring and writing; on a busy machine
MEASURED = 1e-7  # of the size: what the report and this script may differ by
WILD = 0.5  # diagonals of the points' box by which a shape may leave it without a word


# Points of a shape, 3 × m, before noise.
def ground(r, m):
    x, y = r.uniform(0, 10, m), r.uniform(0, 8, m)
    return np.array([x, y, np.sin(0.4 * x) * np.cos(0.5 * y)])


def arch(r, m):
    a, y = r.uniform(-2, 2, m), r.uniform(0, 5, m)
    return np.array([3 * np.sin(a), y, 3 * np.cos(a)])


def tube(r, m):
    a, z = r.uniform(0, 2 * math.pi, m), r.uniform(0, 6, m)
    return np.array([2 * np.cos(a), 2 * np.sin(a), z])


def ball(r, m):
    p = r.normal(size=(3, m))
    return 4 * p / np.maximum(np.linalg.norm(p, axis=0), 1e-9)


def plane(r, m):
    return np.array([r.uniform(0, 3, m), r.uniform(0, 2, m), np.zeros(m)])


def two_sheets(r, m):
    p = ground(r, m)
    p[0, : m // 3] += 30
    return p


def scan_lines(r, m):
    line = r.integers(0, max(2, m // 40), m)
    x = r.uniform(0, 10, m)
    return np.array([x, line * 1.0, 0.05 * x * x])


def blob(r, m):
    return r.normal(size=(3, m))


def helix(r, m):
    t = np.sort(r.uniform(0, 10, m))
    return np.array([np.cos(t), np.sin(t), 0.3 * t])


def line(r, m):
    t = np.sort(r.uniform(0, 1, m))
    return np.array([t, 2 * t, 3 * t])


def flat_curve(r, m):
    t = np.linspace(0, 2 * math.pi * r.choice([0.7, 1]), m, endpoint=False)
    return np.array([(3 + np.cos(3 * t)) * np.cos(t), (3 + np.cos(3 * t)) * np.sin(t), np.zeros(m)])


def corner(r, m):
    t = np.linspace(-1, 1, m)
    return np.array([t, np.abs(t), np.zeros(m)])


# A can: three faces, two edges.
def can(r, m):
    a, z, part = r.uniform(0, 2 * math.pi, m), r.uniform(0, 4, m), r.uniform(size=m)
    radius = np.where(part < 0.6, 2, 2 * np.sqrt(r.uniform(size=m)))
    z[part >= 0.6] = 0
    z[part >= 0.8] = 4
    return np.array([radius * np.cos(a), radius * np.sin(a), z])


def box(r, m):
    p = r.uniform(-1, 1, (3, m))
    p[r.integers(0, 3, m), np.arange(m)] = r.choice([-1, 1], m)
    return p * np.array([[3], [2], [1]])


BODIES, SHEETS, CURVES = (can, box, ball), (ground, arch, tube, ball, plane, two_sheets, scan_lines, blob, can), (helix, line, flat_curve, corner)


def cloud_of(r, shapes):
    make = shapes[r.integers(len(shapes))]
    m = int(r.choice([0, 1, 2, 3, 5, 9, 20, 60, 200, 600, 1500], p=[0.01, 0.01, 0.02, 0.02, 0.04, 0.1, 0.15, 0.15, 0.2, 0.2, 0.1]))
    p = make(r, m)
    size = 10
    p = p + r.choice([0, 1e-3, 1e-2, 0.3]) * r.normal(size=p.shape)
    stray = r.uniform(size=m) < r.choice([0, 0, 0.02, 0.15])
    p[:, stray] += size * r.normal(size=(3, int(stray.sum())))
    if m > 4 and r.uniform() < 0.15:
        p[:, r.integers(0, m, m // 4)] = p[:, [0]]  # duplicates
    p = p * r.choice([1, 1, 1, 1e-6, 1e3])
    if r.uniform() < 0.15:
        p = p + np.array([[5e5], [5e6], [100]])
    if m > 3 and r.uniform() < 0.1:
        p[r.integers(3), r.integers(m)] = r.choice([math.nan, math.inf])
    return make.__name__, p


def write_cloud(path, p, two):
    rows = p[:2].T if two else p.T
    comma = path.endswith(".csv")
    with open(path, "w", encoding="ascii") as file:
        if path.endswith(".ply"):
            names = "xyz"[: rows.shape[1]]
            file.write(f"ply\nformat ascii 1.0\nelement vertex {len(rows)}\n")
            file.writelines(f"property double {name}\n" for name in names)
            file.write("end_header\n")
        file.writelines(("," if comma else " ").join(f"{x:.17g}" for x in row) + "\n" for row in rows)


def one_of(r, *choices):
    return choices[r.integers(len(choices))]


def options_of(r, table, chance):
    words = []
    for flag, values in table:
        if r.uniform() < chance:
            words.append(flag)
            if values:
                words.append(str(one_of(r, *values)))
    return words


FITTED = [("--tolerance", [1e-9, 1e-3, 0.05, 1, 100]), ("--loss", ["none", "huber", "cauchy", "tukey", "truncated"]),
          ("--smoothing", ["auto", 0, 1e-8, 1e-2, 1]), ("--seed", [1, 2, 99]), ("--origin", ["local", "1,2,3"]), ("--unit", ["m", "inch"]),
          ("--clean", ["none", "statistical", "statistical:4,1"]), ("--loss-scale", [1e-3, 0.1]), ("--uncertainty", None), ("--certify", None)]
SURFACE = FITTED + [("--control-points", ["4,4", "6,9", "20,20", "3,3", "60,4"]), ("--max-control-points", [16, 100]),
                    ("--optimize", ["none", "params", "weights", "knots", "params,weights,knots"]), ("--degree", [1, 2, "3,2", 5, "7,1"]),
                    ("--base", ["plane", "sheet", "revolution", "sphere", "torus", "wing"]), ("--closed", ["none", "u", "v", "uv"]),
                    ("--trim", ["none"]), ("--part", [1, 2, "all"]), ("--snap", None), ("--symmetric", ["x", "1,1,0,0"]),
                    ("--keep-outliers", None), ("--thin", [0.01, 0.5, 5])]
CURVE = FITTED + [("--control-points", [4, 7, 40]), ("--optimize", ["none", "params", "weights", "knots", "params,weights"]),
                  ("--degree", [1, 2, 4, 7]), ("--order", ["given", "unordered"]), ("--closed", ["yes", "no"]), ("--corners", ["none"]),
                  ("--distance", ["point", "tangent", "squared", "parameter"]), ("--component", [1, "all"]),
                  ("--method", ["local-parabolic", "local-conic", "local-cubic"]), ("--interpolate", None),
                  ("--parameterization", ["uniform", "centripetal", "foley", "universal"])]


PARTS = FITTED[:1] + FITTED[3:6] + [("--regularise", None), ("--labels", ["labels.csv", "labels.ply"])]
SOLID = FITTED[:1] + FITTED[2:6] + [("--kind", ["auto", "organic", "cad"]), ("--faces", [12, 60]), ("--layout-out", ["layout.obj"]),
                                    ("--mesh-out", ["mesh.ply"]), ("--keep-outliers", None)]


def fit_of(r, folder):
    kind = one_of(r, "surface", "surface", "surface", "curve", "curve", "primitive", "parts", "solid")
    two = kind in ("curve", "primitive") and r.uniform() < 0.3
    shapes = (flat_curve, corner) if two else CURVES if kind == "curve" or r.uniform() < 0.1 else SHEETS
    if kind in ("parts", "solid") and r.uniform() < 0.7:
        shapes = BODIES
    name, p = cloud_of(r, shapes)
    path = "cloud" + one_of(r, ".xyz", ".csv", ".ply")
    write_cloud(os.path.join(folder, path), p, two)
    words = ["fit", kind, path, "-o", "part.step" if kind == "solid" else "part.json", "--residuals", "points.csv", "--json"]
    if kind in ("parts", "solid"):
        words += ["--time-limit", str(TIME_LIMIT)] + options_of(r, PARTS if kind == "parts" else SOLID, 0.2)
    elif kind == "primitive":
        words += ["--kind", one_of(r, "auto", "line", "circle", "plane", "sphere", "cylinder", "cone", "torus")]
        words += options_of(r, FITTED[:1] + FITTED[3:4], 0.2)
    else:
        words += ["--time-limit", str(TIME_LIMIT)]
        words += options_of(r, SURFACE if kind == "surface" else CURVE, 0.12)
    return name, words


MIRRORS = {"x": np.array([1, 0, 0]), "1,1,0,0": np.array([1, 1, 0]) / math.sqrt(2)}
FOLLOWING = [["analyze", "part.json", "--json"], ["analyze", "part.json", "part.json", "--json"], ["info", "part.json", "--json"],
             ["convert", "part.json", "part.step"], ["convert", "part.json", "part.iges"], ["tessellate", "part.json", "-o", "mesh.stl"],
             ["section", "part.json", "--plane", "1,0,0.2,-1", "-o", "cut.json"], ["sample", "part.json", "-o", "sampled.xyz", "--count", "50"],
             ["compare", "part.json", "CLOUD", "--certify", "--align", "best", "--profile", "0.1", "--json"],
             ["compare", "part.json", "CLOUD", "--certificate", "proof.json", "--report", "page.html"],
             ["project", "part.json", "CLOUD", "--json"], ["info", "CLOUD", "--json"], ["edit", "part.json", "-o", "edited.json", "EDIT"],
             ["intersect", "part.json", "part.json", "--json"], ["make", "offset", "part.json", "-o", "offset.json", "--distance", "0.1"],
             ["make", "extrude", "part.json", "-o", "made.json", "--by", "0,0,2"], ["make", "revolve", "part.json", "-o", "made.json"],
             ["evaluate", "part.json", "--at", "0.3,0.4", "--derivatives", "2", "--json"], ["convert", "part.json", "part.brep"]]
EDITS = ["reverse", "swap", "elevate:by=1", "elevate:by=1,dir=v", "reduce:by=1,tolerance=0.1", "split:at=0.5", "split:at=0.5,dir=u", "decompose",
         "clamp", "unclamp", "insert-knot:at=0.3,dir=u", "insert-knot:at=0.3", "remove-knot:at=0.5,tolerance=1", "scale:1e6", "scale:-1,1,1",
         "translate:1e6,0,0", "extend:end=upper,by=1", "extend:end=lower,by=1,dir=v", "iso:at=0.5,dir=u", "to-bezier", "to-power",
         "reparameterize:to=0;7"]


class Wrong(Exception):
    pass


def strict(text):
    def refuse(word):
        raise Wrong(f"JSON holds {word}")

    return json.loads(text, parse_constant=refuse)


def limit_processor():
    resource.setrlimit(resource.RLIMIT_CPU, (MOST_SECONDS, MOST_SECONDS))


def run(batten, words, folder):
    begin = time.monotonic()
    try:
        done = subprocess.run([batten, *words], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=MOST_WALL, text=True,
                              errors="replace", preexec_fn=limit_processor)
    except subprocess.TimeoutExpired:
        raise Wrong(f"runs longer than {MOST_WALL} s") from None
    seconds = time.monotonic() - begin
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        raise Wrong(f"takes more than {MOST_SECONDS} s of the processor")
    if done.returncode not in (0, 1, 2, 3):
        raise Wrong(f"exit code {done.returncode}: {done.stderr[-300:]}")
    if done.returncode in (1, 2) and not done.stderr.strip():
        raise Wrong(f"exit code {done.returncode} without a word")
    if done.returncode in (0, 3) and "--json" in words:
        return done.returncode, strict(done.stdout), seconds
    return done.returncode, None, seconds


# The functions of a basis at a parameter: (span, values). [Cox & de Boor]
def basis_at(p, knots, t):
    n = len(knots) - p - 1
    t = min(max(t, knots[p]), knots[n])
    k = int(np.searchsorted(knots, t, side="right")) - 1
    k = min(max(k, p), n - 1)
    while knots[k] == knots[k + 1]:
        k -= 1
    values = [1.0]
    for r in range(1, p + 1):
        nxt = [0.0] * (r + 1)
        for j, value in enumerate(values):
            low, high = knots[k - r + 1 + j], knots[k + 1 + j]
            share = (t - low) / (high - low)
            nxt[j] += (1 - share) * value
            nxt[j + 1] += share * value
        values = nxt
    return k, np.array(values)


class Shape:
    def __init__(self, entry):
        self.surface = "degree_u" in entry
        points = np.array(entry["control_points"]["points"], float)
        if not np.isfinite(points).all():
            raise Wrong("control points are not finite")
        self.points = points if points.shape[1] == 3 else np.hstack([points, np.zeros((len(points), 1))])
        self.weights = np.array(entry["control_points"].get("weights", np.ones(len(points))), float)
        if not (self.weights > 0).all():
            raise Wrong("weights are not positive")
        names = (("degree_u", "knotvector_u"), ("degree_v", "knotvector_v")) if self.surface else (("degree", "knotvector"),)
        self.bases = [(entry[degree], np.array(entry[knots], float)) for degree, knots in names]
        for _, knots in self.bases:
            if not np.isfinite(knots).all() or (np.diff(knots) < 0).any():
                raise Wrong("a knot vector is not finite, or decreases")
        self.trimmed = bool(entry.get("trims"))

    def at(self, u, v=0.0):
        p, knots = self.bases[0]
        k, in_u = basis_at(p, knots, u)
        if not self.surface:
            index, functions = np.arange(k - p, k + 1), in_u
        else:
            q, other = self.bases[1]
            columns = len(other) - q - 1
            l, in_v = basis_at(q, other, v)
            index = (np.arange(k - p, k + 1)[:, None] * columns + np.arange(l - q, l + 1)).ravel()
            functions = np.outer(in_u, in_v).ravel()
        functions = functions * self.weights[index]
        return functions @ self.points[index] / functions.sum()

    def samples(self, per_direction):
        axes = [np.linspace(knots[p], knots[len(knots) - p - 1], per_direction) for p, knots in self.bases]
        if not self.surface:
            return np.array([self.at(u) for u in axes[0]])
        return np.array([self.at(u, v) for u in axes[0] for v in axes[1]])


def check_report(report, folder, mirror, of_own_face):
    shapes = [Shape(entry) for entry in strict(open(os.path.join(folder, "part.json"), encoding="utf-8").read())["shape"]["data"]]
    with open(os.path.join(folder, "points.csv"), encoding="ascii") as file:
        rows = list(csv.DictReader(file))
    shift = np.array(report["input"]["shift"] if report["input"].get("shift") else [0, 0, 0], float)
    points = np.array([[float(row[c]) for c in "xyz"] for row in rows])
    distances = np.array([float(row["distance"]) for row in rows])
    used = np.array([row["outlier"] == "0" for row in rows])
    if not (np.isfinite(points).all() and np.isfinite(distances).all()):
        raise Wrong("residuals are not finite")
    size = np.linalg.norm(points.max(0) - points.min(0))
    slack = MEASURED * size + 1e-14 * np.abs(points).max()
    # The named place is as far as is said.
    for k in np.linspace(0, len(rows) - 1, min(len(rows), 60)).astype(int):
        row = rows[k]
        shape = shapes[int(row.get("index") or 0)]
        foot = shape.at(float(row["u"]), float(row.get("v") or 0)) + shift
        measured = np.linalg.norm(foot - points[k])
        if abs(measured - abs(distances[k])) > slack:
            raise Wrong(f"point {k}: {abs(distances[k])} is said, {measured} to its place")
    # No sample of untrimmed shapes is nearer; points of parts are measured from their own face.
    sampled = [shape.samples(14 if shape.surface else 150) + shift for shape in shapes]
    samples = np.vstack(sampled)
    if not any(shape.trimmed for shape in shapes):
        for k in range(0, len(rows), max(1, len(rows) // 60)):
            others = sampled[int(rows[k].get("index") or 0)] if of_own_face else samples
            nearest = np.linalg.norm(others - points[k], axis=1).min()
            if nearest < abs(distances[k]) - slack:
                raise Wrong(f"point {k}: {abs(distances[k])} is said, a sample is {nearest} away")
    summaries = [("error_all", np.full(len(rows), True))]
    if "thinned_to" not in report["input"]:  # else "error" is of the points that thinning left
        summaries.append(("error", used))
    for field, counted in summaries:
        error = report[field]
        if error["points"] != counted.sum():
            raise Wrong(f"{field}.points {error['points']} of {counted.sum()}")
        if not counted.any():
            continue
        for name, value in (("max", np.abs(distances[counted]).max()), ("rms", math.sqrt((distances[counted] ** 2).mean()))):
            if abs(error[name] - value) > slack:
                raise Wrong(f"{field}.{name} {error[name]}, by the residuals {value}")
    # Nothing swings wild without a word.
    box = points[used] if used.any() else points
    if mirror is not None:
        box = np.vstack([box, box - 2 * np.outer(box @ mirror, mirror)])
    diagonal = np.linalg.norm(box.max(0) - box.min(0))
    beyond = np.maximum(box.min(0) - samples, samples - box.max(0)).max()
    told = [w for w in report["warnings"] if any(word in w for word in ("leaves", "without points", "beyond", "no points", "box", "far from"))]
    if beyond > WILD * diagonal + slack and not any(shape.trimmed for shape in shapes) and not told and "primitive" not in report["geometry"]:
        raise Wrong(f"leaves the box of its points by {beyond / max(diagonal, 1e-300):.2f} of its diagonal without a word")


def case(batten, seed, number, folder):
    r = np.random.default_rng([seed, number])
    name, words = fit_of(r, folder)
    try:
        code, report, seconds = run(batten, words, folder)
    except Wrong as wrong:
        raise Wrong(f"{name}: {' '.join(words)}\n  {wrong}") from None
    if code in (0, 3):
        try:
            if words[1] != "solid":
                mirror = MIRRORS.get(words[words.index("--symmetric") + 1]) if "--symmetric" in words else None
                check_report(report, folder, mirror, words[1] == "parts")
        except Wrong as wrong:
            raise Wrong(f"{name}: {' '.join(words)}\n  {wrong}") from None
        for _ in range(2):
            named = {"CLOUD": words[2], "EDIT": one_of(r, *EDITS), "part.json": words[words.index("-o") + 1]}
            following = [named.get(w, w) for w in one_of(r, *FOLLOWING)]
            try:
                run(batten, following, folder)
            except Wrong as wrong:
                raise Wrong(f"{name}: {' '.join(words)}\n  then {' '.join(following)}\n  {wrong}") from None
    elif any(os.path.exists(os.path.join(folder, name)) for name in ("part.json", "part.step")):
        raise Wrong(f"{name}: {' '.join(words)}\n  exit code {code}, and geometry was written")
    return code, seconds


def main():
    batten = os.path.abspath(sys.argv[1])
    cases, seed, first = (int(sys.argv[k]) if len(sys.argv) > k else value for k, value in ((2, 1000), (3, 1), (4, 0)))
    codes, found, slowest, begin = {}, 0, 0, time.monotonic()
    for number in range(first, first + cases):
        folder = tempfile.mkdtemp(prefix=f"batten-case-{number}-")
        try:
            code, seconds = case(batten, seed, number, folder)
            codes[code] = codes.get(code, 0) + 1
            slowest = max(slowest, seconds)
        except Wrong as wrong:
            found += 1
            print(f"case {number} (seed {seed}): {wrong}\n  kept in {folder}", flush=True)
            continue
        shutil.rmtree(folder)
    print(f"{cases} cases in {time.monotonic() - begin:.0f} s, the slowest fit {slowest:.1f} s; exit codes " +
          ", ".join(f"{code}: {count}" for code, count in sorted(codes.items())) + f"; {found} wrong")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
