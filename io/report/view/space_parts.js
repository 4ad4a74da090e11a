// SPDX-License-Identifier: MIT
// What stands in the view in space, made from the data once: surfaces, points, lines, each a layer that
// can be switched on and off.

const kColours = { edge: 0x1b2733, knots: 0x24405c, net: 0x0b7a55, curve: 0x17293b, comb: 0x6a4c93, outlier: 0x111111 };

// A mesh with its values for every mode in which it can be coloured.
function surfaceObject(surface, table, limit) {
  const n = surface.positions.length / 3;
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(surface.positions, 3));
  if (surface.normals.length === surface.positions.length) {
    geometry.setAttribute("normal", new THREE.BufferAttribute(surface.normals, 3));
  }
  geometry.setIndex(new THREE.BufferAttribute(surface.triangles, 1));
  if (!geometry.attributes.normal) geometry.computeVertexNormals();
  const mesh = new THREE.Mesh(geometry, surfaceMaterial(table, limit));
  mesh.frustumCulled = false;
  const made = new Map();
  mesh.userData.setValue = (field) => {
    if (!made.has(field)) made.set(field, new THREE.BufferAttribute(knownValues(surface[field], n), 2));
    geometry.setAttribute("value", made.get(field));
  };
  mesh.userData.setValue("deviation");
  return mesh;
}

// Points of which keep(i) is true.
function pointsObject(points, values, keep, material) {
  const n = points.length / 3;
  const chosen = [];
  for (let i = 0; i < n; ++i) if (keep(i)) chosen.push(i);
  const position = new Float32Array(3 * chosen.length);
  const value = new Float32Array(chosen.length);
  chosen.forEach((i, k) => {
    position[3 * k] = points[3 * i];
    position[3 * k + 1] = points[3 * i + 1];
    position[3 * k + 2] = points[3 * i + 2];
    value[k] = values && i < values.length ? values[i] : NaN;
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(position, 3));
  geometry.setAttribute("value", new THREE.BufferAttribute(knownValues(value, chosen.length), 2));
  const object = new THREE.Points(geometry, material);
  object.frustumCulled = false;
  return object;
}

// Teeth of the curvature combs and the lines through their tips; `scale` is length per curvature.
function combLines(curves, scale) {
  const lines = [];
  for (const c of curves) {
    const n = c.points.length / 3;
    const every = Math.max(1, Math.round(n / 160));
    const tips = new Float32Array(3 * n);
    for (let i = 0; i < n; ++i) {
      const h = scale * Math.abs(finiteOr(c.curvature[i], 0));
      for (let d = 0; d < 3; ++d) tips[3 * i + d] = c.points[3 * i + d] + h * finiteOr(c.normals[3 * i + d], 0);
      if (i % every === 0 || i === n - 1) {
        const tooth = new Float32Array(6);
        tooth.set(c.points.subarray(3 * i, 3 * i + 3), 0);
        tooth.set(tips.subarray(3 * i, 3 * i + 3), 3);
        lines.push(tooth);
      }
    }
    lines.push(tips);
  }
  return lines;
}

function finiteOr(value, other) {
  return value - value === 0 ? value : other;
}

// The length per curvature at which combs stand out well but do not fill the view.
function combScale(data) {
  const sizes = data.curves.flatMap((c) => Array.from(c.curvature, Math.abs));
  const [high] = quantiles(sizes, [0.97]);
  const most = sizes.reduce((a, b) => Math.max(a, finiteOr(b, 0)), 0);
  return high > 0 ? niceBelow(data.size * Math.min(0.12 / high, 0.2 / most)) : 0;
}

// { layers: [{ name, label, objects, on }], width(material) … }: all objects of the view. Widths and sizes
// are in CSS pixels, the view multiplies them with the device's.
function spaceLayers(data, table) {
  const layers = [];
  const add = (name, label, on, objects) => {
    if (objects.length > 0) layers.push({ name, label, on, objects });
  };
  const radius = Math.hypot(...data.box.high.map((h, i) => h - data.box.low[i])) / 2 || 1;
  // A twentieth of a percent of the depth lifts lines off what they lie on; points stand clear of noise.
  const lift = 4e-4;
  const clear = Math.max(lift, Math.min(2 * data.limit, 0.02 * radius) / (8 * radius));
  const s = data.surfaces, c = data.curves, cloud = data.cloud;
  add("surface", s.length > 1 ? "Surfaces" : "Surface", true, s.map((x) => surfaceObject(x, table, data.limit)));
  if (c.length > 0) {
    add("curve", c.length > 1 ? "Curves" : "Curve", true, c.map((x) =>
      linesObject([x.points], { colour: kColours.curve, width: 2.2, lift })));
  }
  if (cloud) {
    const n = cloud.points.length / 3 - cloud.outliers;
    const size = n > 60000 ? 2.2 : n > 15000 ? 3 : 4.5;
    if (n > 0) {
      add("cloud", "Points", s.length === 0, [pointsObject(cloud.points, cloud.deviation, (i) => !cloud.outlier[i],
        pointMaterial(table, data.limit, { size, lift: clear }))]);
    }
    if (cloud.outliers > 0) {
      add("outliers", "Outliers", s.length === 0, [pointsObject(cloud.points, null, (i) => cloud.outlier[i],
        pointMaterial(table, data.limit, { mark: 1, colour: kColours.outlier, size: 10, through: true }))]);
    }
  }
  const borders = s.flatMap((x) => x.trims.concat(x.edges));
  if (borders.length > 0) {
    const label = s.some((x) => x.trims.length > 0) ? "Trims and edges" : "Edges";
    add("trims", label, true, [linesObject(borders, { colour: kColours.edge, width: 1.8, lift: 1.5 * lift })]);
  }
  const knotLines = s.flatMap((x) => x.knotLines);
  const knotPoints = c.filter((x) => x.knots.length > 0);
  add("knots", s.length > 0 ? "Knot lines" : "Knots", false, [
    ...(knotLines.length > 0 ? [linesObject(knotLines, { colour: kColours.knots, width: 1, lift, opacity: 0.6 })] : []),
    ...knotPoints.map((x) => pointsObject(x.knots, null, () => true,
      pointMaterial(table, data.limit, { mark: 3, colour: kColours.curve, size: 10, lift: 3 * lift }))),
  ]);
  const nets = s.concat(c).filter((x) => x.net).map((x) => x.net);
  add("net", c.length > 0 && s.length === 0 ? "Control polygon" : "Control net", false, nets.flatMap((net) => [
    linesObject(netLines(net), { colour: kColours.net, width: 1, lift: 2 * lift, opacity: 0.75 }),
    pointsObject(net.points, null, () => true, pointMaterial(table, data.limit, { mark: 2, colour: kColours.net, size: 5.5, lift: 2.5 * lift })),
  ]));
  if (c.some((x) => x.curvature.length > 0 && x.normals.length > 0)) {
    layers.push({ name: "comb", label: "Curvature comb", on: true, objects: [] });
  }
  return layers;
}
