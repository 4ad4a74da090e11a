// SPDX-License-Identifier: MIT
// The plan of curves as a view: zoomed and moved by hand, with layers to switch on and off.

class PlanView {
  constructor(stage, data) {
    this.stage = stage;
    this.data = data;
    this.canvas = html("canvas", "drawing");
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", "Plan of the curve. Arrow keys move it, plus and minus zoom, 0 shows all.");
    this.label = html("div", "label");
    this.label.hidden = true;
    stage.append(this.canvas, this.label);
    this.context = this.canvas.getContext("2d");
    this.drawing = new PlanDrawing(data);
    this.limit = data.limit;
    this.mode = "deviation";
    this.modes = [];
    const cloud = data.cloud;
    const has = (field) => data.curves.some((c) => (field(c) || []).length > 0);
    this.layers = [
      ["curve", data.curves.length > 1 ? "Curves" : "Curve", true, data.curves.length > 0],
      ["cloud", "Points", true, cloud && cloud.points.length / 3 > cloud.outliers],
      ["whiskers", "Deviations enlarged", true, cloud && cloud.foot],
      ["outliers", "Outliers", true, cloud && cloud.outliers > 0],
      ["comb", "Curvature comb", !cloud || !cloud.foot, has((c) => c.curvature)],
      ["knots", "Knots", false, has((c) => c.knots)],
      ["net", "Control polygon", false, has((c) => c.net && c.net.points)],
    ].filter((l) => l[3]).map(([name, label, on]) => ({ name, label, on }));
    this.combScale = combScale(data);
    this.factor = this.whiskerFactor();
    this.resize();
    this.reset();
    this.listen();
    new ResizeObserver(() => this.resize()).observe(stage);
  }

  // At which the larger deviations are as long as a twentieth of the curve.
  whiskerFactor() {
    const cloud = this.data.cloud;
    if (!cloud) return 1;
    const used = cloud.deviation.filter((_, i) => !cloud.outlier[i]).map(Math.abs);
    const [high] = quantiles(used, [0.98]);
    return high > 0 ? Math.max(1, niceBelow(Math.min(1e7, 0.05 * this.data.size / high))) : 1;
  }

  shows(name) {
    return this.layers.some((l) => l.name === name && l.on);
  }

  setLayer(name, on) {
    const layer = this.layers.find((l) => l.name === name);
    if (!layer) return false;
    layer.on = Boolean(on);
    this.draw();
    return true;
  }

  setMode(name) {
    return name === this.mode;
  }

  setLimit(limit) {
    this.limit = limit;
    this.drawing.setLimit(limit);
    this.draw();
  }

  range() {
    return this.limit;
  }

  setCombScale(scale) {
    this.combScale = scale;
    this.draw();
  }

  setFactor(factor) {
    this.factor = factor;
    this.draw();
  }

  setView() {
    this.reset();
  }

  legend() {
    if (!this.data.cloud || !(this.shows("cloud") || this.shows("whiskers"))) return null;
    return { map: kDeviationMap, limit: this.limit, unit: this.data.unit, title: "deviation",
      tolerance: this.data.tolerance, signed: this.data.signed, unknown: false };
  }

  reset() {
    const { x0, x1, y0, y1 } = this.drawing.bounds();
    const w = x1 - x0 || this.data.size, h = y1 - y0 || this.data.size;
    // Room for whiskers, combs and the legend.
    const scale = Math.min(Math.max(80, this.width - 250) / w, Math.max(80, this.height - 170) / h);
    this.map = { x: (x0 + x1) / 2 + 45 / scale, y: (y0 + y1) / 2, scale };
    this.least = scale / 30;
    this.draw();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.stage;
    if (width === 0 || height === 0) return;
    const first = this.width === undefined;
    Object.assign(this, { width, height });
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.ratio = ratio;
    if (!first) this.reset();
  }

  draw() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => { if (this.pending) this.renderNow(); });
  }

  renderNow() {
    this.pending = false;
    this.paint(this.context, this.ratio, this.width, this.height, this.map);
  }

  paint(context, ratio, width, height, map) {
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.drawing.draw(context, width, height, map,
                      { shows: (name) => this.shows(name), combScale: this.combScale, factor: this.factor });
  }

  image(width, height) {
    const paper = document.createElement("canvas");
    paper.width = width;
    paper.height = height;
    const scale = this.map.scale * Math.min(width / 2 / this.width, height / 2 / this.height);
    this.paint(paper.getContext("2d"), 2, width / 2, height / 2, { ...this.map, scale });
    return { url: paper.toDataURL("image/png"), over: null };
  }

  pixels() {
    this.renderNow();
    // Reading from a copy leaves the drawing where the browser draws fastest.
    const { width, height } = this.canvas;
    const copy = document.createElement("canvas");
    Object.assign(copy, { width, height });
    const context = copy.getContext("2d", { willReadFrequently: true });
    context.drawImage(this.canvas, 0, 0);
    return { width, height, data: context.getImageData(0, 0, width, height).data };
  }

  listen() {
    const pan = (dx, dy) => {
      this.map.x -= dx / this.map.scale;
      this.map.y += dy / this.map.scale;
      this.draw();
    };
    listenToHands(this.canvas, {
      rotate: pan,
      pan,
      zoom: (f, x, y) => {
        const scale = Math.min(this.least * 3e6, Math.max(this.least, this.map.scale * f));
        const dx = x - this.width / 2, dy = this.height / 2 - y;
        this.map.x += dx / this.map.scale - dx / scale;
        this.map.y += dy / this.map.scale - dy / scale;
        this.map.scale = scale;
        this.draw();
      },
      point: (x, y) => this.hover(x, y),
      tap: (x, y) => this.hover(x, y),
      leave: () => { this.label.hidden = true; },
      key: (key) => {
        if (key !== "0" && key !== "Home") return false;
        this.reset();
        return true;
      },
    });
    this.canvas.addEventListener("dblclick", () => this.reset());
  }

  // The nearest point or sample of a curve within a few pixels.
  hover(x, y) {
    const X = (p) => this.width / 2 + (p - this.map.x) * this.map.scale;
    const Y = (p) => this.height / 2 - (p - this.map.y) * this.map.scale;
    let best = 100, found = null;
    const look = (flat, what, keep) => {
      for (let k = 0; k < flat.length; k += 2) {
        const dx = X(flat[k]) - x, dy = Y(flat[k + 1]) - y, d = dx * dx + dy * dy;
        if (d < best && keep(k / 2)) {
          best = d;
          found = { ...what, i: k / 2, at: [X(flat[k]), Y(flat[k + 1])] };
        }
      }
    };
    const cloud = this.data.cloud;
    if (cloud) look(this.drawing.cloud, { cloud }, (i) => this.shows(cloud.outlier[i] ? "outliers" : "cloud"));
    if (this.shows("curve") && !found) {
      this.drawing.curves.forEach((c, k) => look(c.points, { curve: this.data.curves[k] }, () => true));
    }
    if (!found) {
      this.label.hidden = true;
      return;
    }
    showLabel(this.label, this.describe(found), ...found.at, this.width, this.height);
  }

  describe(found) {
    const data = this.data;
    const world = worldWriter(data);
    const scale = lengthScale(data);
    const lines = [];
    const points = found.cloud ? found.cloud.points : found.curve.points;
    if (found.cloud) {
      const d = found.cloud.deviation[found.i];
      lines.push((found.cloud.outlier[found.i] ? "outlier, " : "point, ") + (data.signed ? scale.signedText(d) : scale.text(d)) + " away");
    } else {
      const k = found.curve.curvature[found.i];
      lines.push(data.curves.length > 1 ? found.curve.name : "curve");
      if (found.curve.parameters.length > found.i) lines.push("parameter " + significant(found.curve.parameters[found.i], 5));
      if (isFinite(k)) lines.push("curvature " + significant(k) + (data.unit ? kNarrowSpace + "1/" + data.unit : ""));
      if (Math.abs(k) > 0) lines.push("radius " + significant(Math.abs(1 / k)) + (data.unit ? kNarrowSpace + data.unit : ""));
    }
    ["x", "y", "z"].forEach((axis, k) => lines.push(axis + " " + world(points[3 * found.i + k] + data.center[k])));
    return lines;
  }
}
