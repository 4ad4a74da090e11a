// SPDX-License-Identifier: MIT
// The histogram of deviations: bars in the colours of the legend, zero, the tolerance, and the normal
// curve of the same mean and spread.

// Mean and standard deviation of the values behind a histogram.
function momentsOf(histogram) {
  const { low, high, counts } = histogram;
  const step = (high - low) / counts.length;
  let n = 0, sum = 0, squares = 0;
  counts.forEach((c, i) => {
    const v = low + (i + 0.5) * step;
    n += c;
    sum += c * v;
    squares += c * v * v;
  });
  if (n === 0) return null;
  const mean = sum / n;
  // Sheppard's correction for the width of the bars.
  const variance = squares / n - mean * mean - step * step / 12;
  return { n, mean, deviation: Math.sqrt(Math.max(0, variance)), step };
}

function drawHistogram(svg, data, limit, width) {
  const histogram = data.histogram;
  const { counts } = histogram;
  const { low, high } = data.reach || histogram;  // of two histograms side by side
  const scale = new Scale(Math.max(Math.abs(low), Math.abs(high)), data.unit);
  const chart = new Chart(svg, {
    width, height: Math.round(Math.min(250, 0.42 * width + 70)), left: 14, right: 14, top: 22, bottom: 40,
    label: "Histogram of deviations",
  });
  // The tolerance is shown unless the bars would be squeezed into a line.
  const T = data.tolerance;
  const reach = Math.max(Math.abs(low), Math.abs(high));
  const shows = T !== null && T < 2.5 * reach;
  const from = data.signed ? Math.min(low, shows ? -1.08 * T : low) : 0;
  const to = Math.max(high, shows ? 1.08 * T : high);
  chart.linearX(from, to);
  const most = Math.max(...counts, 1);
  chart.linearY(0, most * 1.04);
  const step = (histogram.high - histogram.low) / counts.length;
  counts.forEach((c, i) => {
    if (c === 0) return;
    const v = histogram.low + i * step;
    const x = chart.x(v), w = chart.x(v + step) - x;
    const bar = add(svg, "rect", {
      x, width: Math.max(0.6, w - 0.6), y: chart.y(c), height: chart.bottom - chart.y(c),
      fill: cssColour(colourAt(kDeviationMap, (v + step / 2) / limit)), class: "bar",
    });
    add(bar, "title", {}, scale.signed(v) + " to " + scale.signedText(v + step) + ": " + counted(c, "point"));
  });
  const moments = data.signed ? momentsOf(histogram) : null;
  if (moments && moments.deviation > 0) {
    const pairs = [];
    for (let i = 0; i <= 120; ++i) {
      const v = from + (to - from) * i / 120, z = (v - moments.mean) / moments.deviation;
      const y = moments.n * step * Math.exp(-z * z / 2) / (moments.deviation * Math.sqrt(2 * Math.PI));
      pairs.push([chart.x(v), Math.max(chart.top - 6, chart.y(y))]);
    }
    add(svg, "path", { d: pathThrough(pairs), class: "normal-curve" });
  }
  const ticks = niceTicks(from, to, Math.max(4, width / 70));
  chart.ticksX(ticks, tickText(ticks, data.signed), "deviation" + (data.unit ? " [" + data.unit + "]" : ""));
  const mark = (v, text, style) => {
    add(svg, "line", { x1: chart.x(v), x2: chart.x(v), y1: chart.top - 6, y2: chart.bottom, class: style });
    if (text) add(svg, "text", { x: chart.x(v), y: chart.top - 10, class: "mark-text middle" }, text);
  };
  if (data.signed) mark(0, "", "zero-line");
  if (shows) {
    mark(T, (data.signed ? "+" : "") + plain(T), "tolerance-line");
    if (data.signed) mark(-T, plain(-T), "tolerance-line");
  }
}

// What the bars do not show, in words.
function histogramNotes(data) {
  const h = data.histogram;
  const moments = momentsOf(h);
  const notes = [];
  if (moments) {
    const total = moments.n + (h.below || 0) + (h.above || 0);
    notes.push(counted(total, "point") + " used.");
    if (data.signed && h.deviation > 0) {
      const scale = new Scale(Math.max(Math.abs(h.mean), h.deviation), data.unit);
      const words = (mean, deviation) =>
        "mean " + scale.signedText(mean) + ", standard deviation " + scale.text(deviation);
      const all = words(h.mean, h.deviation);
      notes.push(all[0].toUpperCase() + all.slice(1) + ".");
      // Few far points change the figures of all, not what is drawn.
      const same = Math.abs(moments.deviation - h.deviation) <= 0.1 * h.deviation;
      if (moments.deviation > 0) {
        notes.push("The dashed line is the normal curve of " +
          (same ? "both." : "the points drawn: " + words(moments.mean, moments.deviation) + "."));
      }
    }
  }
  if (h.below > 0) notes.push(counted(h.below, "point") + " below " + significant(h.low) + " not drawn.");
  if (h.above > 0) notes.push(counted(h.above, "point") + " above " + significant(h.high) + " not drawn.");
  if (data.tolerance !== null && data.tolerance >= 2.5 * Math.max(Math.abs(h.low), Math.abs(h.high))) {
    notes.push("The tolerance of " + plain(data.tolerance) + kNarrowSpace + data.unit + " lies outside the drawing.");
  }
  return notes.join(" ");
}
