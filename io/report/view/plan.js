// SPDX-License-Identifier: MIT
// Curves flat on paper: what is drawn, given a map from coordinates to the paper.

const kPlanColours = { curve: "#17293b", comb: "#6a4c93", net: "#0b7a55", tolerance: "#3d4a57", ink: "#46525e" };

// Coordinates in the plane of the plan, [x, y, x, y, …].
function flattened(points, plan) {
  const flat = new Float64Array(points.length / 3 * 2);
  for (let i = 0, k = 0; i + 2 < points.length; i += 3, k += 2) {
    for (let d = 0; d < 3; ++d) {
      flat[k] += points[i + d] * plan.u[d];
      flat[k + 1] += points[i + d] * plan.v[d];
    }
  }
  return flat;
}

// Unit vectors to the left of a flat polyline, one at every vertex.
function leftOf(flat) {
  const n = flat.length / 2;
  const left = new Float64Array(2 * n);
  for (let i = 0; i < n; ++i) {
    const a = Math.max(0, i - 1), b = Math.min(n - 1, i + 1);
    const dx = flat[2 * b] - flat[2 * a], dy = flat[2 * b + 1] - flat[2 * a + 1];
    const length = Math.hypot(dx, dy) || 1;
    left[2 * i] = -dy / length;
    left[2 * i + 1] = dx / length;
  }
  return left;
}

// A curve and what belongs to it, flat.
function flatCurve(c, plan) {
  const points = flattened(c.points, plan);
  return {
    points, left: leftOf(points), comb: flattened(c.normals, plan), curvature: c.curvature,
    net: c.net ? flattened(c.net.points, plan) : null, knots: flattened(c.knots, plan),
  };
}

// Draws on a canvas of width × height CSS pixels; `map` has scale, x and y: pixels are
// (width/2 + (p − x)·scale, height/2 − (q − y)·scale).
class PlanDrawing {
  constructor(data) {
    this.data = data;
    this.curves = data.curves.map((c) => flatCurve(c, data.plan));
    const cloud = data.cloud;
    this.cloud = cloud ? flattened(cloud.points, data.plan) : null;
    this.foot = cloud && cloud.foot ? flattened(cloud.foot, data.plan) : null;
    this.setLimit(data.limit);
  }

  // Points of one colour are drawn together.
  setLimit(limit) {
    this.limit = limit;
    const cloud = this.data.cloud;
    this.buckets = new Map();
    this.outliers = [];
    if (!cloud) return;
    for (let i = 0; i < cloud.points.length / 3; ++i) {
      if (cloud.outlier[i]) {
        this.outliers.push(i);
        continue;
      }
      const t = Math.round(Math.max(-1.05, Math.min(1.05, cloud.deviation[i] / limit)) * 40) / 40;
      const colour = cssColour(colourAt(kDeviationMap, t));
      if (!this.buckets.has(colour)) this.buckets.set(colour, []);
      this.buckets.get(colour).push(i);
    }
  }

  bounds() {
    let [x0, x1, y0, y1] = [Infinity, -Infinity, Infinity, -Infinity];
    const include = (flat) => {
      for (let k = 0; k < flat.length; k += 2) {
        x0 = Math.min(x0, flat[k]);
        x1 = Math.max(x1, flat[k]);
        y0 = Math.min(y0, flat[k + 1]);
        y1 = Math.max(y1, flat[k + 1]);
      }
    };
    this.curves.forEach((c) => include(c.points));
    if (!(x1 >= x0) && this.cloud) include(this.cloud);
    return x1 >= x0 ? { x0, x1, y0, y1 } : { x0: -1, x1: 1, y0: -1, y1: 1 };
  }

  draw(context, width, height, map, { shows, combScale, factor }) {
    const g = context;
    g.fillStyle = "#fff";
    g.fillRect(0, 0, width, height);
    g.lineJoin = "round";
    const X = (x) => width / 2 + (x - map.x) * map.scale;
    const Y = (y) => height / 2 - (y - map.y) * map.scale;
    const polyline = (flat) => {
      g.beginPath();
      for (let k = 0; k < flat.length; k += 2) g.lineTo(X(flat[k]), Y(flat[k + 1]));
      g.stroke();
    };
    if (shows("comb")) this.curves.forEach((c) => this.drawComb(g, c, X, Y, map, width, combScale));
    if (shows("whiskers") && this.foot) this.drawWhiskers(g, X, Y, factor, polyline);
    if (shows("net")) {
      g.strokeStyle = g.fillStyle = kPlanColours.net;
      g.lineWidth = 1;
      for (const c of this.curves.filter((k) => k.net)) {
        polyline(c.net);
        for (let k = 0; k < c.net.length; k += 2) g.fillRect(X(c.net[k]) - 2.5, Y(c.net[k + 1]) - 2.5, 5, 5);
      }
    }
    if (shows("curve")) {
      g.strokeStyle = kPlanColours.curve;
      g.lineWidth = 1.6;
      this.curves.forEach((c) => polyline(c.points));
    }
    if (shows("knots")) this.drawKnots(g, X, Y);
    if (shows("cloud") && this.cloud) this.drawCloud(g, X, Y, map, width, height);
    if (shows("outliers") && this.cloud) this.drawOutliers(g, X, Y);
    this.drawFrame(g, width, height, map);
  }

  drawComb(g, c, X, Y, map, width, scale) {
    const n = c.points.length / 2;
    const tip = (i) => {
      const h = scale * Math.abs(finiteOr(c.curvature[i], 0));
      return [X(c.points[2 * i] + h * finiteOr(c.comb[2 * i], 0)), Y(c.points[2 * i + 1] + h * finiteOr(c.comb[2 * i + 1], 0))];
    };
    const seen = Math.max(1, this.data.size * map.scale / width);
    const every = Math.max(1, Math.round(n / (200 * seen)));
    g.strokeStyle = kPlanColours.comb;
    g.lineWidth = 0.8;
    g.globalAlpha = 0.55;
    g.beginPath();
    for (let i = 0; i < n; i += every) {
      g.moveTo(X(c.points[2 * i]), Y(c.points[2 * i + 1]));
      g.lineTo(...tip(i));
    }
    g.stroke();
    g.globalAlpha = 1;
    g.lineWidth = 1.2;
    g.beginPath();
    for (let i = 0; i < n; ++i) g.lineTo(...tip(i));
    g.stroke();
  }

  // From every foot towards its point, `factor` times as long; and the tolerance as much enlarged.
  drawWhiskers(g, X, Y, factor, polyline) {
    const T = this.data.tolerance;
    if (T !== null) {
      g.strokeStyle = kPlanColours.tolerance;
      g.lineWidth = 1;
      g.setLineDash([6, 4]);
      for (const c of this.curves) {
        for (const side of [1, -1]) polyline(c.points.map((p, k) => p + side * factor * T * c.left[k]));
      }
      g.setLineDash([]);
    }
    g.lineWidth = 1.2;
    for (const [colour, members] of this.buckets) {
      g.strokeStyle = colour;
      g.beginPath();
      for (const i of members) {
        const fx = this.foot[2 * i], fy = this.foot[2 * i + 1];
        g.moveTo(X(fx), Y(fy));
        g.lineTo(X(fx + factor * (this.cloud[2 * i] - fx)), Y(fy + factor * (this.cloud[2 * i + 1] - fy)));
      }
      g.stroke();
    }
  }

  drawCloud(g, X, Y, map, width, height) {
    const n = this.cloud.length / 2;
    const r = n > 20000 ? 1.1 : n > 3000 ? 1.6 : 2.6;
    for (const [colour, members] of this.buckets) {
      g.fillStyle = colour;
      g.strokeStyle = "rgba(30,40,50,0.55)";
      g.lineWidth = 0.6;
      g.beginPath();
      for (const i of members) {
        const x = X(this.cloud[2 * i]), y = Y(this.cloud[2 * i + 1]);
        if (x < -9 || y < -9 || x > width + 9 || y > height + 9) continue;
        g.moveTo(x + r, y);
        g.arc(x, y, r, 0, 6.2832);
      }
      g.fill();
      if (r > 2) g.stroke();
    }
  }

  drawOutliers(g, X, Y) {
    for (const [style, line] of [["#fff", 4], [kOutlierColour, 1.8]]) {
      g.strokeStyle = style;
      g.lineWidth = line;
      g.beginPath();
      for (const i of this.outliers) {
        const x = X(this.cloud[2 * i]), y = Y(this.cloud[2 * i + 1]);
        g.moveTo(x - 4, y - 4);
        g.lineTo(x + 4, y + 4);
        g.moveTo(x - 4, y + 4);
        g.lineTo(x + 4, y - 4);
      }
      g.stroke();
    }
  }

  drawKnots(g, X, Y) {
    g.fillStyle = "#fff";
    g.strokeStyle = kPlanColours.curve;
    g.lineWidth = 1.3;
    for (const c of this.curves) {
      for (let k = 0; k < c.knots.length; k += 2) {
        const x = X(c.knots[k]), y = Y(c.knots[k + 1]);
        g.beginPath();
        g.moveTo(x, y - 5);
        g.lineTo(x + 5, y);
        g.lineTo(x, y + 5);
        g.lineTo(x - 5, y);
        g.closePath();
        g.fill();
        g.stroke();
      }
    }
  }

  // Scale bar and axes.
  drawFrame(g, width, height, map) {
    const length = niceBelow(Math.min(150, width / 3) / map.scale);
    const pixels = length * map.scale;
    const x1 = width - 18, x0 = x1 - pixels, y = height - 18;
    g.strokeStyle = g.fillStyle = kPlanColours.ink;
    g.lineWidth = 1.2;
    g.beginPath();
    g.moveTo(x0, y - 5);
    g.lineTo(x0, y);
    g.lineTo(x1, y);
    g.lineTo(x1, y - 5);
    g.moveTo(20, height - 54);
    g.lineTo(20, height - 20);
    g.lineTo(54, height - 20);
    g.stroke();
    g.font = "12px system-ui, sans-serif";
    g.textAlign = "center";
    g.fillText(plain(length) + (this.data.unit ? kNarrowSpace + this.data.unit : ""), (x0 + x1) / 2, y - 7);
    g.fillText(axisName(this.data.plan.u, "u"), 64, height - 16);
    g.fillText(axisName(this.data.plan.v, "v"), 20, height - 60);
  }
}

// "x" for (1, 0, 0); axes that are none of the coordinates' keep their own name.
function axisName(axis, name) {
  const k = axis.findIndex((v) => Math.abs(v) > 1 - 1e-9);
  return k < 0 ? name : (axis[k] < 0 ? kMinus : "") + "xyz"[k];
}
