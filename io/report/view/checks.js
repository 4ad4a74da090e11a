// SPDX-License-Identifier: MIT
// What was asked for beside the distances: standard deviations, proofs, form, alignment and profile.

const kDecisions = {
  conforms: ["good", "Conforms"], undecided: ["none", "Cannot be decided"], does_not_conform: ["bad", "Does not conform"],
};

// Of a profile tolerance: { kind, title, text } as verdicts have them.
function profileVerdict(data) {
  const p = data.report.profile;
  const scale = lengthScale(data);
  const [kind, title] = kDecisions[p.decision];
  let text = "Distances of " + scale.signedText(p.lowest) + " to " + scale.signedText(p.highest) + ", each \u00b1 " +
    scale.text(p.uncertainty) + ", in a zone of " + plain(p.zone[0]) + " to " + plain(p.zone[1]) + kNarrowSpace + data.unit + ".";
  if (p.out > 0) text += " " + counted(p.out, "point") + " out of it for sure.";
  if (p.doubtful > 0) text += " " + counted(p.doubtful, "point") + " too near to its sides to tell.";
  return { kind, title, text };
}

function profileTable(data) {
  const p = data.report.profile;
  if (!p) return null;
  const scale = lengthScale(data);
  return table("Profile tolerance", [
    ["decision", kDecisions[p.decision][1].toLowerCase()],
    ["zone", plain(p.zone[0]) + " to " + plain(p.zone[1]) + kNarrowSpace + data.unit],
    ["lowest", scale.signedText(p.lowest)],
    ["highest", scale.signedText(p.highest)],
    ["uncertainty (two std. dev.)", scale.text(p.uncertainty)],
    ["out of the zone for sure", count(p.out)],
    ["too near to its sides to tell", count(p.doubtful)],
  ]);
}

function alignmentTable(data) {
  const a = data.report.alignment;
  if (!a) return null;
  const scale = lengthScale(data);
  const trace = a.rotation[0][0] + a.rotation[1][1] + a.rotation[2][2];
  const sine = Math.hypot(a.rotation[2][1] - a.rotation[1][2], a.rotation[0][2] - a.rotation[2][0], a.rotation[1][0] - a.rotation[0][1]) / 2;
  return table("Alignment of the points", [
    ["turned by", significant(Math.atan2(sine, (trace - 1) / 2) * 180 / Math.PI) + "\u00b0"],
    ["then moved by", vector(a.translation, worldWriter(data))],
    ["freedoms determined", count(a.determined) + " of 6"],
    ["rms before and after", scale.number(a.rms_before) + " \u2192 " + scale.text(a.rms_after)],
  ]);
}

function uncertaintyTable(data) {
  const u = data.report.uncertainty;
  if (!u) return null;
  if (u.sigma_median === null) return table("Standard deviations", [["of the shape", u.coverage_note]]);
  const length = (v) => significant(v) + kNarrowSpace + data.unit;
  const power = data.kind === "curve" ? "" : "\u00b2";
  return table("Standard deviations along the normal", [
    ["median", length(u.sigma_median)],
    ["largest", length(u.sigma_max)],
    ["moved by fairness, at most", length(u.bias_max)],
    ["of one point", length(u.point_noise)],
    u.inflation > 1 ? ["variances raised for shared noise", significant(u.inflation) + " times"] : null,
    ["not supported by points", significant(u.unsupported_area) + kNarrowSpace + data.unit + power + " (" + percent(u.unsupported_share) + ")"],
    ["covers", u.coverage_note],
  ]);
}

function proofTable(data) {
  const c = data.report.certified;
  if (!c) return null;
  const length = (v) => significant(v, 6) + kNarrowSpace + data.unit;
  return table("Proved", [
    ["every point is nearer than", length(c.max_upper)],
    ["some point is farther than", length(c.max_lower)],
    c.proved_within === undefined ? null : ["within the tolerance, out of it, open", [c.proved_within, c.proved_out, c.undecided].map(count).join(", ")],
    data.kind === "curve" ? null : ["no folds", c.folds_proved_absent ? "proved" : "not proved"],
    c.mesh_chord === undefined ? null : ["the mesh is nearer than", c.mesh_chord === null ? "not proved" : length(c.mesh_chord)],
    ["not proved", c.unproved.join("; ")],
  ]);
}

function formTable(data) {
  const f = data.report.form;
  if (!f) return null;
  const length = (v) => significant(v) + kNarrowSpace + data.unit;
  return table(f.name[0].toUpperCase() + f.name.slice(1), [
    ["minimum zone", length(f.minimum_zone) + (f.deviation > 0 ? " \u00b1 " + length(f.deviation) : "")],
    ["about least squares", length(f.least_squares)],
    ["points", count(f.points)],
  ]);
}

function checkTables(data) {
  const tables = { profile: profileTable, form: formTable, alignment: alignmentTable, uncertainty: uncertaintyTable, proof: proofTable };
  return Object.entries(tables).map(([name, make]) => [name, make(data)]);
}
