// SPDX-License-Identifier: MIT
// Convergence over the rounds of a fit, and deviation along a curve.

const kStageWords = {
  "cross-validation": "cross-validation",
  "block validation": "block validation",
  "robust": "robust",
  "refine": "refinement",
  "joint": "joint",
};

function controlPointsText(numbers) {
  return (numbers || []).map(count).join("\u2009\u00d7\u2009");
}

// rms and largest deviation of every round on a logarithmic scale; stages are bands with a name.
function drawConvergence(svg, data, width) {
  const rounds = data.report.iterations;
  const values = rounds.flatMap((r) => [r.rms, r.max]).filter((v) => v > 0 && isFinite(v));
  if (values.length === 0) return;
  let low = Math.min(...values), high = Math.max(...values);
  const T = data.tolerance;
  if (T !== null && T > low / 30 && T < high * 30) {
    low = Math.min(low, T);
    high = Math.max(high, T);
  }
  low /= 1.4;
  high *= 1.4;
  const decades = Math.log10(high / low);
  const chart = new Chart(svg, {
    width, height: Math.round(Math.min(320, 0.4 * width + 90)), left: 64, right: 44, top: 26, bottom: 42,
    label: "Convergence: deviation in every round",
  });
  chart.linearX(0.5, rounds.length + 0.5);
  chart.logY(low, high);
  bandsOfStages(svg, chart, rounds);
  const ticks = [];
  const multiples = decades > 4 ? [1] : decades > 1.3 ? [1, 3] : [1, 2, 5];
  for (let e = Math.floor(Math.log10(low)); e <= Math.ceil(Math.log10(high)); ++e) {
    for (const m of multiples) {
      const v = Number((m * Math.pow(10, e)).toPrecision(3));
      if (v >= low && v <= high) ticks.push(v);
    }
  }
  const every = Math.ceil(ticks.length / 9);
  chart.ticksY(ticks.filter((_, i) => i % every === 0), plain, "deviation" + (data.unit ? " [" + data.unit + "]" : ""));
  const numbers = niceTicks(0.5, rounds.length + 0.5, Math.min(rounds.length, Math.max(4, width / 60)));
  chart.ticksX(numbers.filter((v) => Number.isInteger(v)), String, "round");
  if (T !== null && T >= low && T <= high) {
    add(svg, "line", { x1: chart.left, x2: chart.right, y1: chart.y(T), y2: chart.y(T), class: "tolerance-line" });
    add(svg, "text", { x: chart.right + 4, y: chart.y(T) + 4, class: "mark-text" }, "tol.");
  }
  let taken = T !== null && T >= low && T <= high ? [chart.y(T)] : [];
  for (const [field, style, label] of [["max", "line-max", "max"], ["rms", "line-rms", "rms"]]) {
    const drawn = (r) => r[field] > 0 && isFinite(r[field]);
    const pairs = rounds.map((r, i) => [chart.x(i + 1), drawn(r) ? chart.y(r[field]) : NaN]);
    add(svg, "path", { d: pathThrough(pairs), class: "line " + style });
    pairs.forEach(([x, y], i) => {
      if (!isFinite(y)) return;
      const dot = add(svg, "circle", { cx: x, cy: y, r: rounds.length > 60 ? 1.6 : 3, class: "dot " + style });
      add(dot, "title", {}, roundText(rounds[i], i, data));
    });
    const last = pairs.filter((p) => isFinite(p[1])).pop();
    if (last) {
      let y = last[1] + 4;
      while (taken.some((t) => Math.abs(t + 4 - y) < 12)) y -= 4;
      add(svg, "text", { x: chart.right + 4, y, class: "mark-text " + style }, label);
      taken.push(y - 4);
    }
  }
}

function roundText(round, i, data) {
  const scale = new Scale(data.limit, data.unit);
  return "round " + (i + 1) + ", " + round.stage + ": " + controlPointsText(round.control_points) +
         " control points, rms " + scale.text(round.rms) +
         (round.max > 0 ? ", max " + scale.text(round.max) : "");
}

// A band behind the rounds of each stage, with the stage's name where it fits.
function bandsOfStages(svg, chart, rounds) {
  let begin = 0;
  let shaded = false;
  for (let i = 1; i <= rounds.length; ++i) {
    if (i < rounds.length && rounds[i].stage === rounds[begin].stage) continue;
    const x0 = chart.x(begin + 0.5), x1 = chart.x(i + 0.5);
    if (shaded) {
      add(svg, "rect", { x: x0, width: x1 - x0, y: chart.top, height: chart.bottom - chart.top, class: "band" });
    }
    shaded = !shaded;
    const name = kStageWords[rounds[begin].stage] || rounds[begin].stage || "";
    if (name && x1 - x0 > 6.2 * name.length) {
      add(svg, "text", { x: (x0 + x1) / 2, y: chart.top - 8, class: "stage-text middle" }, name);
    }
    begin = i;
  }
}

// For up to `most` points of the cloud, spread evenly: the curve and the arc length at which each has
// its foot. Feet are looked for among the samples of the curves.
function placesAlong(data, lengths, most) {
  const cloud = data.cloud;
  const n = cloud.points.length / 3;
  const every = Math.max(1, Math.ceil(n / most));
  const at = cloud.foot || cloud.points;
  const places = [];
  for (let i = 0; i < n; i += every) {
    let best = Infinity, curve = 0, arc = 0;
    data.curves.forEach((c, k) => {
      const p = c.points;
      for (let j = 0; j < p.length; j += 3) {
        const dx = p[j] - at[3 * i], dy = p[j + 1] - at[3 * i + 1], dz = p[j + 2] - at[3 * i + 2];
        const d = dx * dx + dy * dy + dz * dz;
        if (d < best) {
          best = d;
          curve = k;
          arc = lengths[k][j / 3];
        }
      }
    });
    places.push({ i, curve, arc });
  }
  return places;
}

// Arc length at every sample of a curve.
function arcLengths(points) {
  const lengths = new Float64Array(points.length / 3);
  for (let i = 1; i < lengths.length; ++i) {
    const a = 3 * (i - 1), b = 3 * i;
    lengths[i] = lengths[i - 1] +
                 Math.hypot(points[b] - points[a], points[b + 1] - points[a + 1], points[b + 2] - points[a + 2]);
  }
  return lengths;
}

// Deviation of the points over the arc length of curve k.
function drawAlong(svg, data, k, places, lengths, limit, width) {
  const mine = places.filter((p) => p.curve === k);
  const length = lengths[k].length > 1 ? lengths[k][lengths[k].length - 1] : 1;
  const cloud = data.cloud;
  let most = data.tolerance !== null && data.tolerance < 3 * limit ? 1.1 * data.tolerance : 0;
  for (const { i } of mine) {
    const d = Math.abs(cloud.deviation[i]);
    if (!cloud.outlier[i] && d > most) most = d;
  }
  most = most > 0 ? 1.08 * most : limit;
  const chart = new Chart(svg, {
    width, height: Math.round(Math.min(260, 0.3 * width + 110)), left: 64, right: 44, top: 12, bottom: 42,
    label: "Deviation along the curve",
  });
  chart.linearX(0, length || 1);
  chart.linearY(data.signed ? -most : 0, most);
  const heights = niceTicks(data.signed ? -most : 0, most, 6);
  chart.ticksY(heights, tickText(heights, data.signed), "deviation" + (data.unit ? " [" + data.unit + "]" : ""));
  const stations = niceTicks(0, length, Math.max(3, width / 90));
  chart.ticksX(stations, tickText(stations), "arc length" + (data.unit ? " [" + data.unit + "]" : ""));
  if (data.signed) {
    add(svg, "line", { x1: chart.left, x2: chart.right, y1: chart.y(0), y2: chart.y(0), class: "zero-line" });
  }
  if (data.tolerance !== null && data.tolerance <= most) {
    for (const t of data.signed ? [data.tolerance, -data.tolerance] : [data.tolerance]) {
      add(svg, "line", { x1: chart.left, x2: chart.right, y1: chart.y(t), y2: chart.y(t), class: "tolerance-line" });
    }
    add(svg, "text", { x: chart.right + 4, y: chart.y(data.tolerance) + 4, class: "mark-text" }, "tol.");
  }
  const radius = mine.length > 1500 ? 1.2 : mine.length > 300 ? 1.8 : 2.4;
  for (const { i, arc } of mine) {
    const d = cloud.deviation[i];
    if (!isFinite(d) || cloud.outlier[i]) continue;
    add(svg, "circle", {
      cx: chart.x(arc), cy: chart.y(d), r: radius, fill: cssColour(colourAt(kDeviationMap, d / limit)), class: "sample",
    });
  }
}
