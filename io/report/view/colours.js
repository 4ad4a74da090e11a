// SPDX-License-Identifier: MIT
// Two diverging colour maps that people with every kind of colour vision can read: blue to red for
// deviations, violet to orange for curvatures. Beyond the limit one darker step on either side.

const kDeviationMap = {
  below: [5, 30, 80],
  stops: [[33, 92, 170], [67, 137, 196], [140, 190, 222], [226, 229, 232], [243, 166, 132], [220, 93, 78], [185, 24, 44]],
  above: [92, 0, 24],
};
const kCurvatureMap = {
  below: [36, 10, 82],
  stops: [[84, 48, 148], [128, 103, 181], [178, 168, 212], [230, 229, 232], [251, 184, 106], [231, 128, 28], [186, 82, 6]],
  above: [110, 44, 0],
};
const kUnknownColour = [168, 170, 173];  // no points near
const kOutlierColour = "#111111";

// The colour of t in [-1, 1] as [r, g, b] in 0…255; beyond, the darker end.
function colourAt(map, t) {
  if (!isFinite(t)) return kUnknownColour;
  if (t < -1) return map.below;
  if (t > 1) return map.above;
  const x = (t + 1) / 2 * (map.stops.length - 1);
  const i = Math.min(map.stops.length - 2, Math.floor(x));
  return map.stops[i].map((c, k) => Math.round(c + (x - i) * (map.stops[i + 1][k] - c)));
}

function cssColour([r, g, b]) {
  return "rgb(" + r + "," + g + "," + b + ")";
}

// What the shaders look colours up in: kTableSize texels over t in [-kTableReach, kTableReach].
const kTableSize = 512;
const kTableReach = 1.25;

function colourTable(map) {
  const texels = new Uint8Array(4 * kTableSize);
  for (let i = 0; i < kTableSize; ++i) {
    const t = ((i + 0.5) / kTableSize * 2 - 1) * kTableReach;
    texels.set(colourAt(map, t), 4 * i);
    texels[4 * i + 3] = 255;
  }
  return texels;
}

// The legend: a bar of the colours with ticks, and marks at the tolerance. Values beyond the limit
// have their own fields at the ends. `from` is -1, or 0 where values have no sign.
function drawLegend(svg, { map, limit, unit, title, tolerance, signed, unknown, hatched }) {
  clear(svg);
  const top = 40, height = 220, cap = 12, left = 4, width = 16;
  const from = signed ? -1 : 0;
  const y = (t) => top + cap + height * (1 - (t - from) / (1 - from));
  attributes(svg, { viewBox: "0 0 112 " + (top + height + 2 * cap + (unknown ? 46 : 16)), role: "img" });
  add(svg, "title", {}, "Colours of " + title);
  add(svg, "text", { x: left, y: 13, class: "legend-title" }, title);
  if (unit) add(svg, "text", { x: left, y: 28, class: "legend-unit" }, "in " + unit);
  const steps = 110;
  for (let i = 0; i < steps; ++i) {
    const t0 = from + (1 - from) * i / steps, t1 = from + (1 - from) * (i + 1) / steps;
    add(svg, "rect", {
      x: left, width, y: y(t1), height: y(t0) - y(t1) + 0.6, fill: cssColour(colourAt(map, (t0 + t1) / 2)),
    });
  }
  add(svg, "rect", { x: left, width, y: top, height: cap, fill: cssColour(map.above) });
  if (signed) add(svg, "rect", { x: left, width, y: y(-1), height: cap, fill: cssColour(map.below) });
  const whole = signed ? height + 2 * cap : height + cap;
  add(svg, "rect", { x: left, width, y: top, height: whole, class: "legend-frame" });
  const line = (t, text, style) => {
    add(svg, "line", { x1: left + width, x2: left + width + 5, y1: y(t), y2: y(t), class: "legend-tick" });
    add(svg, "text", { x: left + width + 9, y: y(t) + 4, class: style }, text);
  };
  const marks = [];
  if (tolerance !== null && tolerance <= limit * 1.0001) {
    marks.push(tolerance / limit);
    if (signed) marks.push(-tolerance / limit);
  }
  const ticks = niceTicks(from * limit, limit, signed ? 8 : 5);
  const write = tickText(ticks, signed);
  for (const tick of ticks) {
    const t = tick / limit;
    if (marks.some((m) => Math.abs(y(m) - y(t)) < 13)) continue;
    line(t, write(tick), "legend-number");
  }
  for (const mark of marks) {
    const sign = signed ? (mark > 0 ? "+" : kMinus) : "";
    add(svg, "line", { x1: left - 3, x2: left + width + 5, y1: y(mark), y2: y(mark), class: "legend-tolerance" });
    add(svg, "text", { x: left + width + 9, y: y(mark) + 4, class: "legend-number strong" },
        sign + plain(tolerance) + " tol.");
  }
  if (unknown) {
    const y0 = top + whole + 16;
    add(svg, "rect", { x: left, width, y: y0, height: 12, fill: cssColour(kUnknownColour) });
    if (hatched) {
      for (let x = 2; x < width; x += 5) {
        add(svg, "line", { x1: left + x, x2: left + Math.min(width, x + 3), y1: y0 + 12, y2: y0, class: "legend-hatch" });
      }
    }
    add(svg, "rect", { x: left, width, y: y0, height: 12, class: "legend-frame" });
    add(svg, "text", { x: left + width + 9, y: y0 + 10, class: "legend-number" }, "no points");
  }
}
