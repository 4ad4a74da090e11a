// SPDX-License-Identifier: MIT
// What the page shows, read from the JSON in it ("batten-view-1"): arrays of numbers are base64 of
// little-endian binary, coordinates are relative to `center`.

function bytesOf(base64) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(base64);
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

const kArrayKinds = {
  f32: Float32Array, u32: Uint32Array, i32: Int32Array, i16: Int16Array, u16: Uint16Array, u8: Uint8Array,
};

// An array that was {"f32": "…"}, …; of a missing one an empty array.
function numbersOf(encoded) {
  if (!encoded) return new Float32Array(0);
  if (Array.isArray(encoded)) return Float32Array.from(encoded);
  for (const [kind, Kind] of Object.entries(kArrayKinds)) {
    if (typeof encoded[kind] === "string") {
      const bytes = bytesOf(encoded[kind]);
      return new Kind(bytes.buffer, 0, Math.floor(bytes.byteLength / Kind.BYTES_PER_ELEMENT));
    }
  }
  return new Float32Array(0);
}

function netOf(net) {
  if (!net || !net.points) return null;
  return { size: net.size, points: numbersOf(net.points) };
}

function surfaceOf(s, i) {
  return {
    name: s.name || "surface " + (i + 1),
    positions: numbersOf(s.positions),
    normals: numbersOf(s.normals),
    uv: numbersOf(s.uv),
    triangles: numbersOf(s.triangles),
    deviation: numbersOf(s.deviation),
    gap: numbersOf(s.gap),
    sigma: numbersOf(s.sigma),
    gaussian: numbersOf(s.gaussian),
    mean: numbersOf(s.mean),
    trims: (s.trims || []).map(numbersOf),
    edges: (s.edges || []).map(numbersOf),
    knotLines: (s.knot_lines || []).map(numbersOf),
    net: netOf(s.net),
  };
}

function curveOf(c, i) {
  return {
    name: c.name || "curve " + (i + 1),
    points: numbersOf(c.points),
    parameters: numbersOf(c.parameters),
    curvature: numbersOf(c.curvature),
    normals: numbersOf(c.normals),
    closed: Boolean(c.closed),
    net: netOf(c.net),
    knots: numbersOf(c.knots),
  };
}

function cloudOf(cloud) {
  if (!cloud) return null;
  const points = numbersOf(cloud.points);
  if (points.length === 0) return null;
  const n = points.length / 3;
  const outlier = cloud.outlier ? numbersOf(cloud.outlier) : new Uint8Array(n);
  return {
    points,
    deviation: numbersOf(cloud.deviation),
    outlier,
    outliers: outlier.reduce((sum, o) => sum + (o ? 1 : 0), 0),
    foot: cloud.foot ? numbersOf(cloud.foot) : null,
    shown: cloud.shown === undefined ? n : cloud.shown,
    total: cloud.total === undefined ? n : cloud.total,
  };
}

// null where the page holds none.
function readViewData(text) {
  const json = JSON.parse(text);
  if (json === null) return null;
  const data = {
    title: json.title || "",
    date: json.date || "",
    kind: json.kind,
    unit: json.unit || "",
    center: json.center || [0, 0, 0],
    size: json.size > 0 ? json.size : 1,
    report: json.report || {},
    tolerance: json.tolerance > 0 ? json.tolerance : null,
    limit: json.limit > 0 ? json.limit : 1,
    signed: Boolean(json.signed),
    surfaces: (json.surfaces || []).map(surfaceOf),
    curves: (json.curves || []).map(curveOf),
    plan: json.plan || { u: [1, 0, 0], v: [0, 1, 0] },
    cloud: cloudOf(json.cloud),
    histogram: json.histogram && (json.histogram.counts || []).length > 0 ? json.histogram : null,
  };
  data.box = boxOf(data);
  return data;
}

// The box of the geometry, and of the cloud where there is no geometry: outliers far away must not
// shrink the part to a dot.
function boxOf(data) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  const include = (points) => {
    for (let i = 0; i < points.length; ++i) {
      const axis = i % 3;
      if (points[i] < low[axis]) low[axis] = points[i];
      if (points[i] > high[axis]) high[axis] = points[i];
    }
  };
  data.surfaces.forEach((s) => include(s.positions));
  data.curves.forEach((c) => include(c.points));
  if (!(high[0] >= low[0]) && data.cloud) include(data.cloud.points);
  if (!(high[0] >= low[0])) return { low: [-1, -1, -1], high: [1, 1, 1] };
  return { low, high };
}

// The value below which `fraction` of the finite ones lie; of long arrays from an even sample.
function quantiles(values, fractions) {
  const step = Math.max(1, Math.floor(values.length / 50000));
  const sample = [];
  for (let i = 0; i < values.length; i += step) if (isFinite(values[i])) sample.push(values[i]);
  sample.sort((a, b) => a - b);
  if (sample.length === 0) return fractions.map(() => NaN);
  return fractions.map((f) => sample[Math.min(sample.length - 1, Math.floor(f * sample.length))]);
}
