// SPDX-License-Identifier: MIT
// The words and numbers of the report: title, verdict, key figures, warnings, tables, command.

function lengthScale(data) {
  const e = data.report.error || {};
  const sensible = [data.tolerance, e.p95, e.rms, data.limit].find((v) => v > 0);
  return new Scale(sensible, data.unit);
}

function isComparison(data) {
  return /^\S+\s+compare\b/.test(data.report.command || "");
}

// The errors that the tolerance is held against.
function judgedError(report) {
  const other = report.parameter_error;
  if (other && other.tolerance !== null && (report.error || {}).tolerance === null) return other;
  return report.error || {};
}

// { kind: "good" | "bad" | "none", title, text }
function verdictOf(data) {
  const r = data.report;
  const e = judgedError(r);
  const scale = lengthScale(data);
  const T = data.tolerance;
  if (r.profile) return profileVerdict(data);
  const within = (data.signed ? "\u00b1" : "") + plain(T) + kNarrowSpace + data.unit;
  if (T !== null && r.tolerance_reached === true) {
    return {
      kind: "good", title: "Tolerance reached",
      text: "All " + counted(e.points, "point") + " used lie within " + within + "; the farthest is " +
            scale.text(e.max) + " away.",
    };
  }
  if (T !== null && r.tolerance_reached === false) {
    const out = e.out_of_tolerance;
    return {
      kind: "bad", title: "Tolerance not reached",
      text: count(out) + " of " + counted(e.points, "point") + " used (" + percent(out / e.points) + ") " +
            (out === 1 ? "lies" : "lie") + " outside " + within + "; the farthest is " + scale.text(e.max) + " away.",
    };
  }
  const noise = (r.input || {}).noise;
  let text = "The rms deviation of " + counted(e.points, "point") + " is " + scale.text(e.rms);
  if (noise > 0 && r.termination === "noise_reached") {
    text += ", at the noise of the points, which is estimated as " + scale.text(noise) + ".";
  } else if (noise > 0) {
    text += "; the noise of the points is estimated as " + scale.text(noise) + ".";
  } else {
    text += ".";
  }
  return { kind: "none", title: "No tolerance was asked for", text };
}

function joined(values, between = "\u2009\u00d7\u2009") {
  return values === undefined || values === null ? kNone : [].concat(values).map(count).join(between);
}

function netText(data) {
  const g = data.report.geometry || {};
  const several = g.kind === "curve" && (g.control_points || []).length > 1;
  return joined(g.control_points, several ? " + " : undefined);
}

// The report's parts are of the geometry, with errors, or of the cloud, with a share of it.
function partsOfGeometry(report) {
  return (report.parts || []).filter((part) => part.share === undefined);
}

function partsOfCloud(report) {
  return (report.parts || []).filter((part) => part.share !== undefined);
}

// [label, value, unit or note] of the figures at the top.
function keyFigures(data) {
  const r = data.report, e = r.error || {}, g = r.geometry || {}, input = r.input || {};
  const scale = lengthScale(data);
  const figures = [
    ["rms deviation", scale.number(e.rms), data.unit],
    ["95 % within", scale.number(e.p95), data.unit],
    ["largest", scale.number(e.max), data.unit],
  ];
  if (data.tolerance !== null) figures.push(["in tolerance", percent(e.within_tolerance), ""]);
  figures.push(["points used", count(input.used), input.points !== input.used ? "of " + count(input.points) : ""]);
  figures.push(["outliers", count(input.outliers), ""]);
  const parts = partsOfGeometry(r).length;
  if (parts > 1) {
    figures.push(["parts", count(parts), ""]);
    return figures;
  }
  figures.push(["control points", netText(data), ""]);
  figures.push(["degree", joined(g.degree), ""]);
  if (g.kind === "surface") figures.push(["trim loops", count(g.trims || 0), ""]);
  return figures;
}

function header(data) {
  const r = data.report;
  const verdict = verdictOf(data);
  const what = isComparison(data) ? "Comparison of geometry and points" :
    data.kind === "curve" ? "Curve fitted to points" : "Surface fitted to points";
  const about = ["batten " + (r.version || "")];
  if (data.date) about.unshift(data.date);
  const element = html("header", "",
    html("div", "heading",
      html("div", "", html("p", "what", what), html("h1", "", data.title)),
      html("p", "about", about.join(" \u00b7 "))),
    html("div", "verdict " + verdict.kind,
      html("span", "verdict-mark", { good: "\u2713", bad: "!", none: "\u2013" }[verdict.kind]),
      html("div", "", html("strong", "", verdict.title), html("p", "", verdict.text))));
  const warnings = (r.doubt || []).map((d) => "Doubtful: " + d.words).concat(r.warnings || []);
  if (warnings.length > 0) {
    element.append(html("div", "warnings",
      html("strong", "", warnings.length === 1 ? "Warning" : warnings.length + " warnings"),
      html("ul", "", warnings.map((w) => html("li", "", w)))));
  }
  element.append(html("dl", "key", keyFigures(data).map(([label, value, unit]) =>
    html("div", "", html("dt", "", label), html("dd", "", value, unit ? " " : null, unit ? html("span", "unit", unit) : null)))));
  return element;
}

// A table of [label, value…] rows; rows without any value are left out.
function table(title, rows, heads = null) {
  const kept = rows.filter((row) => row && row.slice(1).some((v) => v !== kNone && v !== "" && v !== null && v !== undefined));
  if (kept.length === 0) return null;
  const body = html("tbody", "", kept.map((row) => html("tr", "",
    html("th", "", row[0]), row.slice(1).map((v) => html("td", "", v === null || v === undefined ? kNone : v)))));
  body.querySelectorAll("th").forEach((th) => th.setAttribute("scope", "row"));
  const element = html("table", heads ? "numbers" : "facts");
  if (heads) {
    const head = html("tr", "", html("td"), heads.map((h) => html("th", "", h)));
    head.querySelectorAll("th").forEach((th) => th.setAttribute("scope", "col"));
    element.append(html("thead", "", head));
  }
  element.append(body);
  return html("section", heads ? "card" : "card facts-card", html("h2", "", title), element);
}

function deviationTable(data) {
  const r = data.report;
  const columns = [["points used", r.error], ["all points", r.error_all], ["at their parameters", r.parameter_error]]
    .filter(([, e]) => e);
  const scale = lengthScale(data);
  const sides = data.signed && data.kind !== "curve";  // the report's distances from curves have no sign
  const row = (label, value) => [label, ...columns.map(([, e]) => value(e))];
  const unit = data.unit ? " [" + data.unit + "]" : "";
  const length = (label, field) => row(label + unit, (e) => scale.number(e[field]));
  const signed = (label, field) => row(label + unit, (e) => scale.signed(e[field]));
  return table("Deviations", [
    length("rms", "rms"), length("mean distance", "mean"), length("median", "p50"), length("95 % within", "p95"),
    length("99 % within", "p99"), length("largest", "max"),
    sides ? signed("signed, 5 % below", "signed_p5") : null,
    sides ? signed("signed, 95 % below", "signed_p95") : null,
    data.tolerance === null ? null : row("in tolerance", (e) => e.tolerance === null ? kNone : percent(e.within_tolerance)),
    data.tolerance === null ? null : row("out of tolerance", (e) => e.tolerance === null ? kNone : count(e.out_of_tolerance)),
    row("points", (e) => count(e.points)),
  ], columns.map(([name]) => name));
}

// Of several geometries, how far the points nearest to each are.
function partsTable(data) {
  const parts = partsOfGeometry(data.report);
  if (parts.length < 2) return null;
  const scale = lengthScale(data);
  const unit = data.unit ? " [" + data.unit + "]" : "";
  const heads = ["points", "rms" + unit, "95 % within" + unit, "largest" + unit];
  if (data.tolerance !== null) heads.push("out of tolerance");
  return table("Parts", parts.map((part, i) => {
    const row = [part.name || part.geometry + " " + (i + 1), count(part.points)];
    row.push(...["rms", "p95", "max"].map((field) => (part.points > 0 ? scale.number(part[field]) : kNone)));
    if (data.tolerance !== null) row.push(count(part.out_of_tolerance));
    return row;
  }), heads);
}

// The faces of a part, and what they have in common.
function facesTable(data) {
  const faces = data.report.faces || [];
  if (faces.length === 0) return null;
  const scale = lengthScale(data);
  const unit = data.unit ? " [" + data.unit + "]" : "";
  const kSkipped = ["fitted as", "because"];
  return table("Faces", faces.map((face) => [
    face.index + " " + face.kind, count(face.points), scale.number(face.rms), scale.number(face.max),
    face.primitive
      ? primitiveRows(face.primitive, data).filter(([name]) => !kSkipped.includes(name))
        .map(([name, text]) => name + "\u2002" + text).join("; ")
      : kNone,
  ]), ["points", "rms" + unit, "largest" + unit, "numbers"]);
}

function relationsTable(data) {
  const relations = data.report.relations || [];
  if (relations.length === 0) return null;
  const size = (relation, v) => (["parallel", "perpendicular"].includes(relation.kind)
    ? significant(v * 180 / Math.PI, 2) + "\u00b0" : significant(v, 2) + kNarrowSpace + data.unit);
  return table("Relations of faces", relations.map((relation) => [
    relation.kind, relation.faces.join(", "), size(relation, relation.deviation), size(relation, relation.allowed),
    relation.kept ? "yes" : "no",
  ]), ["faces", "off by", "chance explains", "kept"]);
}

function cloudPartsTable(data) {
  const parts = partsOfCloud(data.report);
  if (parts.length === 0) return null;
  const world = worldWriter(data);
  const unit = data.unit ? " [" + data.unit + "]" : "";
  return table("Parts of the cloud", parts.map((part, i) => [
    String(i + 1), count(part.points), percent(part.share),
    part.box[1].map((v, d) => world(v - part.box[0][d])).join("\u2009\u00d7\u2009"),
    part.used ? "yes" : part.refused ? "refused: " + part.refused : "no",
  ]), ["points", "of all", "size" + unit, "used"]);
}

function vector(values, write) {
  return values.map(write).join(",\u2002");
}

function worldWriter(data) {
  const decimals = Math.min(9, Math.max(0, 4 - Math.floor(Math.log10(data.size))));
  return (v) => (v === null || !isFinite(v) ? kNone : fixed(v, decimals));
}

function inputTable(data) {
  const input = data.report.input;
  if (!input) return null;
  const world = worldWriter(data);
  const box = input.bounding_box;
  const extent = box && box[0].every((v) => v !== null) ? box[1].map((v, i) => v - box[0][i]) : null;
  const length = (v) => (v > 0 ? significant(v, 3) + kNarrowSpace + data.unit : kNone);
  const shifted = (input.shift || []).some((v) => v !== 0);
  return table("Points", [
    [(input.files || []).length > 1 ? "files" : "file", (input.files || []).join(", ")],
    ["read", count(input.points)],
    input.thinned_to ? ["thinned to", count(input.thinned_to)] : null,
    ["used", count(input.used)],
    ["outliers set aside", count(input.outliers)],
    input.duplicates > 0 ? ["duplicates merged", count(input.duplicates)] : null,
    input.non_finite > 0 ? ["not finite, dropped", count(input.non_finite)] : null,
    ["spacing", length(input.spacing)],
    ["noise, estimated", length(input.noise)],
    extent ? ["extent", extent.map(world).join("\u2009\u00d7\u2009") + kNarrowSpace + data.unit] : null,
    extent ? ["lowest corner", vector(box[0], world)] : null,
    extent ? ["highest corner", vector(box[1], world)] : null,
    shifted ? ["subtracted in the file", vector(input.shift, world)] : null,
  ]);
}

function yesNo(values) {
  return [].concat(values === undefined ? [] : values).map((v) => (v ? "yes" : "no")).join(", ");
}

// The numbers of a primitive with their standard deviations.
function primitiveRows(primitive, data) {
  const deviations = primitive.standard_deviations || {};
  const world = worldWriter(data);
  const rows = [["fitted as", primitive.kind], ["because", primitive.why]];
  const angle = (v) => fixed(v * 180 / Math.PI, 4) + "\u00b0";
  const lengths = ["radius", "major_radius", "minor_radius"];
  for (const name of lengths) {
    if (primitive[name] === undefined) continue;
    const sigma = deviations[name];
    const text = world(primitive[name]) + (sigma > 0 ? " \u00b1 " + significant(sigma, 2) : "") + kNarrowSpace + data.unit;
    rows.push([name.replace("_", " "), text]);
  }
  for (const name of ["half_angle", "sweep"]) {
    if (typeof primitive[name] === "number") rows.push([name.replace("_", " "), angle(primitive[name])]);
  }
  for (const name of ["center", "apex", "point"]) {
    if (primitive[name]) rows.push([name === "center" ? "centre" : name, vector(primitive[name], world)]);
  }
  for (const name of ["axis", "direction", "normal"]) {
    if (primitive[name]) rows.push([name, vector(primitive[name], (v) => fixed(v, 6))]);
  }
  return rows;
}

function creasesText(creases, data) {
  if (creases.edges === 0) return "none";
  const degrees = (angle) => significant(angle * 180 / Math.PI, 3) + "\u00b0";
  return count(creases.edges) + " of length " + plain(creases.length) + kNarrowSpace + data.unit + ", at " +
    degrees(creases.least_angle) + " to " + degrees(creases.greatest_angle);
}

function geometryTable(data) {
  const g = data.report.geometry;
  if (!g) return null;
  const names = data.surfaces.concat(data.curves).map((s) => s.name);
  return table("Geometry", [
    ["file", g.file],
    ["kind", (g.rational ? "rational " : "") + (g.kind || "")],
    names.length > 1 ? ["parts", count(names.length)] : null,
    ...(g.primitive ? primitiveRows(g.primitive, data) : []),
    g.base ? ["parametrised over", g.base] : null,
    g.base_why ? ["because", g.base_why] : null,
    g.distortion > 0 ? ["distortion of lengths", percent(g.distortion)] : null,
    ["degree", joined(g.degree)],
    ["control points", netText(data)],
    ["closed", yesNo(g.closed)],
    g.kind === "surface" ? ["trim loops", count(g.trims || 0)] : null,
    g.creases ? ["sharp edges", creasesText(g.creases, data)] : null,
    (g.poles || []).some(Boolean) ? ["ends are poles", yesNo(g.poles)] : null,
  ]);
}

function runTable(data) {
  const r = data.report;
  const o = r.optimize;
  const scale = lengthScale(data);
  const rows = [];
  if (!isComparison(data)) {
    rows.push(["ended because", (r.end && r.end.words) || kNone]);
    if (o) {
      rows.push(["joint optimisation", (o.ran ? "ran" : "did not run") + (o.why ? ": " + o.why : "")]);
      if (o.ran) {
        rows.push(["its rounds", count(o.iterations)]);
        rows.push(["rms before and after", scale.number(o.rms_before) + " \u2192 " + scale.text(o.rms_after)]);
      }
    }
  }
  const names = { read: "reading", prepare: "preparing", parameterize: "parametrising", solve: "solving",
    project: "foot points", refine: "refining", optimize: "joint optimisation", trim: "trimming", write: "writing",
    total: "in all" };
  for (const [field, label] of Object.entries(names)) {
    const value = (r.seconds || {})[field];
    if (value >= 0.0005) rows.push([label, seconds(value)]);
  }
  if (r.threads > 0) rows.push(["threads", count(r.threads)]);
  if (r.peak_memory_bytes > 0) rows.push(["memory at most", significant(r.peak_memory_bytes / 1e6, 3) + kNarrowSpace + "MB"]);
  if (r.version) rows.push(["batten", r.version]);
  return table("Run", rows);
}

function roundsTable(data) {
  const rounds = data.report.iterations || [];
  if (rounds.length === 0) return null;
  const scale = lengthScale(data);
  const rows = rounds.map((r, i) =>
    [String(i + 1), r.stage, controlPointsText(r.control_points), scale.number(r.rms), scale.number(r.max), seconds(r.seconds)]);
  const unit = data.unit ? " [" + data.unit + "]" : "";
  const section = table("", rows, ["stage", "control points", "rms" + unit, "max" + unit, "time"]);
  const details = html("details", "rounds", html("summary", "", "All " + counted(rounds.length, "round") + " in numbers"));
  details.append(section.querySelector("table"));
  details.querySelector("table").classList.add("wide");
  return details;
}

// The command with a button that copies it.
function commandCard(data) {
  const command = data.report.command;
  if (!command) return null;
  const block = html("code", "", command);
  const button = html("button", "copy", "Copy");
  button.type = "button";
  button.addEventListener("click", async () => {
    const range = document.createRange();
    range.selectNodeContents(block);
    getSelection().removeAllRanges();
    getSelection().addRange(range);
    let copied = false;
    try {
      await navigator.clipboard.writeText(command);
      copied = true;
    } catch (refused) {
      copied = document.execCommand("copy");
    }
    button.textContent = copied ? "Copied" : "Selected";
    setTimeout(() => { button.textContent = "Copy"; }, 1600);
  });
  return html("section", "card command", html("h2", "", "Command"),
    html("p", "note", "This command makes the result and this report again."), html("div", "terminal", html("pre", "", block), button));
}
