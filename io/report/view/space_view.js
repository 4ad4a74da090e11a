// SPDX-License-Identifier: MIT
// The view in space. It draws when something has changed, never for its own sake.

const kSurfaceModes = [
  { name: "deviation", label: "Deviation" },
  { name: "gap", label: "From points" },
  { name: "sigma", label: "Standard deviation" },
  { name: "shaded", label: "Shaded" },
  { name: "mean", label: "Mean curvature" },
  { name: "gaussian", label: "Gaussian curvature" },
  { name: "zebra", label: "Zebra" },
];

// A WebGL context, or null where there is none.
function webglOf(canvas) {
  const wishes = { antialias: true, alpha: false, depth: true, stencil: false, powerPreference: "high-performance" };
  try {
    return canvas.getContext("webgl", wishes) || canvas.getContext("experimental-webgl", wishes);
  } catch (refused) {
    return null;
  }
}

class SpaceView {
  // Draws into `stage`; null from Make where the browser has no WebGL.
  static make(stage, data) {
    const canvas = html("canvas", "drawing");
    const gl = webglOf(canvas);
    return gl ? new SpaceView(stage, data, canvas, gl) : null;
  }

  constructor(stage, data, canvas, gl) {
    Object.assign(this, { stage, data, canvas, gl, mode: "deviation", limit: data.limit, pending: false, pinned: null });
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", "View in space. Arrow keys turn it, plus and minus zoom, 0 shows all.");
    stage.append(canvas);
    this.renderer = new THREE.WebGLRenderer({ canvas, context: gl, antialias: true });
    this.renderer.setClearColor(0xffffff, 1);
    this.camera = new Camera(data.box);
    this.scene = new THREE.Scene();
    this.scene.autoUpdate = false;
    this.tables = { deviation: textureOf(kDeviationMap), curvature: textureOf(kCurvatureMap) };
    this.layers = spaceLayers(data, this.tables.deviation);
    this.layers.forEach((l) => l.objects.forEach((o) => this.adopt(o)));
    this.modes = this.availableModes();
    this.combScale = combScale(data);
    this.ranges = {
      gap: valueRange(data, "gap", 1e-6 * data.size),
      sigma: valueRange(data, "sigma", 1e-9 * data.size),
      mean: valueRange(data, "mean", 1e-3 / data.size),
      gaussian: valueRange(data, "gaussian", 1e-6 / (data.size * data.size)),
    };
    this.overlay = new SpaceOverlay(stage, data);
    this.resize();
    this.reset();
    this.makeComb();
    this.setMode(this.modes.length > 0 ? this.modes[0].name : "deviation");
    this.layers.forEach((l) => this.setLayer(l.name, l.on));
    this.listen();
  }

  adopt(object) {
    for (const name of ["width", "size"]) {
      const uniform = object.material.uniforms[name];
      if (uniform) object.userData[name] = uniform.value;
    }
    object.updateMatrixWorld(true);
    this.scene.add(object);
  }

  availableModes() {
    const s = this.data.surfaces;
    const has = (field) => s.some((x) => x[field].some((v) => v - v === 0));
    return s.length === 0 ? [] : kSurfaceModes.filter((m) =>
      m.name === "shaded" || m.name === "zebra" || has(m.name));
  }

  // The comb is made anew for every scale.
  makeComb() {
    const layer = this.layers.find((l) => l.name === "comb");
    if (!layer) return;
    layer.objects.forEach((o) => {
      this.scene.remove(o);
      o.geometry.dispose();
      o.material.dispose();
    });
    const comb = linesObject(combLines(this.data.curves, this.combScale), { colour: kColours.comb, width: 1, lift: 2e-4 });
    this.adopt(comb);
    comb.visible = layer.on;
    layer.objects = [comb];
    this.sizeMaterials();
  }

  setCombScale(scale) {
    this.combScale = scale;
    this.makeComb();
    this.draw();
  }

  setMode(name) {
    if (this.modes.length > 0 && !this.modes.some((m) => m.name === name)) return false;
    this.mode = name;
    const byValue = ["deviation", "gap", "sigma", "mean", "gaussian"].includes(name);
    for (const object of this.objects("surface")) {
      const u = object.material.uniforms;
      u.mode.value = byValue ? 1 : name === "zebra" ? 2 : 0;
      if (byValue) object.userData.setValue(name);
      u.table.value = name === "mean" || name === "gaussian" ? this.tables.curvature : this.tables.deviation;
      u.limit.value = name === "deviation" ? this.limit : (this.ranges[name] || 1);
    }
    this.draw();
    return true;
  }

  objects(name) {
    const layer = this.layers.find((l) => l.name === name);
    return layer ? layer.objects : [];
  }

  setLayer(name, on) {
    const layer = this.layers.find((l) => l.name === name);
    if (!layer) return false;
    layer.on = Boolean(on);
    layer.objects.forEach((o) => { o.visible = layer.on; });
    this.overlay.pin(null);
    this.draw();
    return true;
  }

  shows(name) {
    const layer = this.layers.find((l) => l.name === name);
    return Boolean(layer && layer.on);
  }

  // Half the range of colours: of deviations, or of the curvature that is shown.
  setLimit(limit) {
    if (this.mode in this.ranges) {
      this.ranges[this.mode] = limit;
    } else {
      this.limit = limit;
      for (const o of [...this.objects("cloud")]) o.material.uniforms.limit.value = limit;
    }
    this.setMode(this.mode);
  }

  range() {
    return this.mode in this.ranges ? this.ranges[this.mode] : this.limit;
  }

  setStripes(n) {
    this.objects("surface").forEach((o) => { o.material.uniforms.stripes.value = n; });
    this.draw();
  }

  // What the legend says in this mode; null: nothing has a colour by value.
  legend() {
    const d = this.data;
    const unit = d.unit;
    if (this.mode === "gap") {
      return { map: kDeviationMap, limit: this.ranges.gap, unit, title: "from points", tolerance: null, signed: false, unknown: false };
    }
    if (this.mode === "sigma") {
      return { map: kDeviationMap, limit: this.ranges.sigma, unit, title: "std. deviation", tolerance: null, signed: false,
        unknown: d.surfaces.some((s) => s.sigma.some((v) => v - v !== 0)), hatched: true };
    }
    if (this.mode === "mean" || this.mode === "gaussian") {
      const power = this.mode === "gaussian" ? "\u00b2" : "";
      return { map: kCurvatureMap, limit: this.ranges[this.mode], unit: unit ? "1/" + unit + power : "",
        title: this.mode === "mean" ? "mean curv." : "Gauss. curv.", tolerance: null, signed: true, unknown: false };
    }
    const coloured = (this.mode === "deviation" && this.objects("surface").length > 0) || this.shows("cloud");
    if (!coloured) return null;
    const unknown = this.mode === "deviation" && d.surfaces.some((s) => s.deviation.some((v) => v - v !== 0));
    return { map: kDeviationMap, limit: this.limit, unit, title: "deviation", tolerance: d.tolerance,
      signed: d.signed, unknown, hatched: true };
  }

  // From where the surface shows itself: a little aslant on its mean normal, else from the corner.
  reset() {
    const mean = new THREE.Vector3();
    let total = 0;
    for (const s of this.data.surfaces) {
      for (let i = 0; i + 2 < s.normals.length; i += 3) {
        const n = new THREE.Vector3(s.normals[i], s.normals[i + 1], s.normals[i + 2]);
        if (!(n.lengthSq() > 0)) continue;
        mean.add(n);
        ++total;
      }
    }
    const corner = new THREE.Vector3(-0.38, -0.84, 0.66).normalize();
    let direction = corner;
    if (total > 0 && mean.length() > 0.6 * total) {
      mean.normalize();
      if (mean.dot(corner) < 0) mean.negate();
      const aside = corner.clone().addScaledVector(mean, -corner.dot(mean));
      direction = mean.clone();
      if (aside.length() > 1e-3) direction.addScaledVector(aside.normalize(), 0.95);
    }
    this.look(direction);
  }

  look(direction, up = null) {
    const d = direction.clone().normalize();
    const upward = up || (Math.abs(d.z) > 0.999 ? new THREE.Vector3(0, 1, 0) : new THREE.Vector3(0, 0, 1));
    this.camera.look(d, upward);
    this.draw();
  }

  // "x", "y", "z", "-x", …: from there; "all": as at the beginning.
  setView(name) {
    const axis = "xyz".indexOf(name.replace("-", ""));
    if (axis < 0) {
      this.reset();
    } else {
      const d = [0, 0, 0];
      d[axis] = name.startsWith("-") ? -1 : 1;
      this.look(new THREE.Vector3(...d));
    }
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.stage;
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    if (width === 0 || height === 0) return;
    if (width === this.width && height === this.height && ratio === this.ratio) return;  // a frame saved
    this.setSize(width, height, ratio);
    this.draw();
  }

  setSize(width, height, ratio) {
    Object.assign(this, { width, height, ratio });
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.kept = Math.min(0.4, 118 / width);
    this.sizeMaterials();
  }

  // Widths are in CSS pixels.
  sizeMaterials() {
    const buffer = this.renderer.getDrawingBufferSize(new THREE.Vector2());
    for (const o of this.scene.children) {
      const u = o.material.uniforms;
      if (u.half_view) u.half_view.value.set(buffer.x / 2, buffer.y / 2);
      if (u.width) u.width.value = o.userData.width * this.ratio;
      if (u.size) u.size.value = o.userData.size * this.ratio;
      if (u.dot_size) u.dot_size.value = this.ratio;
    }
  }

  draw() {
    if (this.onDraw) this.onDraw();
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => { if (this.pending) this.renderNow(); });
  }

  renderNow() {
    this.pending = false;
    this.renderer.render(this.scene, this.camera.update());
    this.overlay.update(this.camera, this.width, this.height);
  }

  // The drawing as PNG, and what lies over it, for paper: { url, over }.
  image(width, height) {
    const kept = { width: this.width, height: this.height, ratio: this.ratio, half: this.camera.half };
    this.camera.half *= Math.max(1, this.camera.aspect * height / width);
    this.setSize(width / 2, height / 2, 2);
    this.renderNow();
    const url = this.canvas.toDataURL("image/png");
    const over = this.overlay.svg.cloneNode(true);
    this.camera.half = kept.half;
    this.setSize(kept.width, kept.height, kept.ratio);
    this.pending = true;
    requestAnimationFrame(() => { if (this.pending) this.renderNow(); });
    return { url, over };
  }

  // { width, height, data } as RGBA.
  pixels() {
    this.renderNow();
    const width = this.gl.drawingBufferWidth, height = this.gl.drawingBufferHeight;
    const data = new Uint8Array(4 * width * height);
    this.gl.readPixels(0, 0, width, height, this.gl.RGBA, this.gl.UNSIGNED_BYTE, data);
    return { width, height, data };
  }

  listen() {
    const turns = (pixels) => pixels * 2.6 / Math.min(this.width, this.height);
    const part = (pixels) => pixels / this.height;
    listenToHands(this.canvas, {
      rotate: (dx, dy) => { this.camera.rotate(-turns(dx), -turns(dy)); this.draw(); },
      pan: (dx, dy) => { this.camera.pan(part(dx), part(dy)); this.draw(); },
      zoom: (f, x, y) => {
        this.camera.zoom(f, part(x - this.width / 2), part(y - this.height / 2));
        this.draw();
      },
      point: (x, y) => this.pointAt(x, y),
      tap: (x, y) => { this.overlay.pin(this.pick(x, y)); this.draw(); },
      leave: () => { this.waiting = null; this.overlay.hover(null); },
      key: (key) => {
        if ("xyzXYZ".includes(key)) {
          this.setView((key < "a" ? "-" : "") + key.toLowerCase());
        } else if (key === "0" || key === "Home") {
          this.reset();
        } else if (key === "Escape") {
          this.overlay.pin(null);
        } else {
          return false;
        }
        return true;
      },
    });
    this.canvas.addEventListener("dblclick", () => { this.camera.fit(); this.draw(); });
    this.canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    this.canvas.addEventListener("webglcontextrestored", () => this.draw());
    new ResizeObserver(() => this.resize()).observe(this.stage);
  }

  // At most one search a frame.
  pointAt(x, y) {
    const first = !this.waiting;
    this.waiting = [x, y];
    if (!first) return;
    requestAnimationFrame(() => {
      if (this.waiting) this.overlay.hover(this.pick(...this.waiting), this.camera, this.width, this.height);
      this.waiting = null;
    });
  }

  // What is drawn at (x, y): { place: [x, y, z], lines: [text…] } or null.
  pick(x, y) {
    const camera = this.camera;
    const d = camera.axis(2).negate();
    const perPixel = 2 * camera.half / this.height;
    const o = camera.target.clone().addScaledVector(d, -10 * camera.radius);
    o.addScaledVector(camera.axis(0), (x - this.width / 2) * perPixel);
    o.addScaledVector(camera.axis(1), (this.height / 2 - y) * perPixel);
    const from = o.toArray(), along = d.toArray();
    let best = null;
    if (this.shows("surface")) {
      this.data.surfaces.forEach((surface) => {
        const hit = hitSurface(surface, from, along);
        if (hit && (!best || hit.s < best.s)) best = { s: hit.s, hit, surface };
      });
    }
    const cloud = this.data.cloud;
    if (cloud && (this.shows("cloud") || this.shows("outliers"))) {
      const near = hitPoints(cloud.points, from, along, 5 * perPixel, (i) =>
        this.shows(cloud.outlier[i] ? "outliers" : "cloud"));
      const margin = 3 * this.data.limit + 2e-3 * camera.radius;
      if (near && (!best || near.s < best.s + margin)) best = { s: near.s, point: near.i };
    }
    if (!best) return null;
    const place = best.point !== undefined ? [0, 1, 2].map((k) => cloud.points[3 * best.point + k]) :
      from.map((v, k) => v + best.s * along[k]);
    return { place, lines: this.describe(place, best) };
  }

  describe(place, best) {
    const data = this.data;
    const world = worldWriter(data);
    const scale = lengthScale(data);
    const lines = [];
    if (best.point !== undefined) {
      const deviation = data.cloud.deviation[best.point];
      const name = data.cloud.outlier[best.point] ? "outlier" : "point";
      lines.push(name + ", " + (data.signed ? scale.signedText(deviation) : scale.text(deviation)) + " away");
    } else {
      const deviation = valueAt(best.hit, best.surface.deviation);
      lines.push(isFinite(deviation) ? "deviation " + scale.signedText(deviation) : "no points near");
      if (this.mode === "sigma") {
        const sigma = valueAt(best.hit, best.surface.sigma);
        lines.push(isFinite(sigma) ? "standard deviation " + scale.text(sigma) : "not supported by points");
      }
      if (this.mode === "mean" || this.mode === "gaussian") {
        const value = valueAt(best.hit, best.surface[this.mode]);
        const unit = "1/" + data.unit + (this.mode === "gaussian" ? "\u00b2" : "");
        lines.push((this.mode === "mean" ? "mean" : "Gaussian") + " curvature " + significant(value) + kNarrowSpace + unit);
        if (this.mode === "mean" && value !== 0) lines.push("radius " + significant(Math.abs(1 / value)) + kNarrowSpace + data.unit);
      }
    }
    ["x", "y", "z"].forEach((axis, k) => lines.push(axis + " " + world(place[k] + data.center[k])));
    if (best.surface && data.surfaces.length > 1) lines.push(best.surface.name);
    return lines;
  }
}

// Symmetric about zero, without the wildest two percent on either side; not below `least`, so that the
// rounding of a flat surface stays uncoloured.
function valueRange(data, field, least) {
  let range = least;
  for (const s of data.surfaces) {
    const [low, high] = quantiles(s[field], [0.02, 0.98]);
    range = Math.max(range, Math.abs(finiteOr(low, 0)), Math.abs(finiteOr(high, 0)));
  }
  return Number((range * 1.05).toPrecision(2));
}
