// SPDX-License-Identifier: MIT
// What lies under a place of the view: a point of a surface, of the cloud or of a curve.

// The nearest hit of the line o + s·d with a surface: { s, values: [at the three corners], weights } or
// null. [Möller and Trumbore 1997]
function hitSurface(surface, o, d) {
  const p = surface.positions, t = surface.triangles;
  const [ox, oy, oz] = o, [dx, dy, dz] = d;
  let best = Infinity, hit = null;
  for (let k = 0; k < t.length; k += 3) {
    const a = 3 * t[k], b = 3 * t[k + 1], c = 3 * t[k + 2];
    const ax = p[a], ay = p[a + 1], az = p[a + 2];
    const e1x = p[b] - ax, e1y = p[b + 1] - ay, e1z = p[b + 2] - az;
    const e2x = p[c] - ax, e2y = p[c + 1] - ay, e2z = p[c + 2] - az;
    const hx = dy * e2z - dz * e2y, hy = dz * e2x - dx * e2z, hz = dx * e2y - dy * e2x;
    const det = e1x * hx + e1y * hy + e1z * hz;
    if (det === 0) continue;
    const inverse = 1 / det;
    const sx = ox - ax, sy = oy - ay, sz = oz - az;
    const u = inverse * (sx * hx + sy * hy + sz * hz);
    if (u < 0 || u > 1) continue;
    const qx = sy * e1z - sz * e1y, qy = sz * e1x - sx * e1z, qz = sx * e1y - sy * e1x;
    const v = inverse * (dx * qx + dy * qy + dz * qz);
    if (v < 0 || u + v > 1) continue;
    const s = inverse * (e2x * qx + e2y * qy + e2z * qz);
    if (s < best) {
      best = s;
      hit = { s, corners: [t[k], t[k + 1], t[k + 2]], weights: [1 - u - v, u, v] };
    }
  }
  return hit;
}

// The mean of an array's values at the corners of a hit.
function valueAt(hit, values) {
  if (!values || values.length === 0) return NaN;
  return hit.corners.reduce((sum, c, i) => sum + hit.weights[i] * values[c], 0);
}

// Of the points [x, y, z, …] for which keep(i) is true, the one nearest to the eye within `reach` of the
// line o + s·d; { i, s } or null.
function hitPoints(points, o, d, reach, keep) {
  let best = Infinity, hit = null;
  const limit = reach * reach;
  for (let i = 0, k = 0; k < points.length; ++i, k += 3) {
    const x = points[k] - o[0], y = points[k + 1] - o[1], z = points[k + 2] - o[2];
    const s = x * d[0] + y * d[1] + z * d[2];
    const away = x * x + y * y + z * z - s * s;
    // A point a little farther from the eye but nearer to the line is the one that is meant.
    if (away > limit || !keep(i)) continue;
    const cost = s + 4 * Math.sqrt(Math.max(0, away));
    if (cost < best) {
      best = cost;
      hit = { i, s };
    }
  }
  return hit;
}
