// SPDX-License-Identifier: MIT
// Two reports on one page: one range of colours, one axis of deviations, one view of both, and their
// numbers in two columns with the differences.

// Boxes in the world's coordinates share a place.
function overlap(a, b) {
  return [0, 1, 2].every((k) => a.box.low[k] + a.center[k] <= b.box.high[k] + b.center[k] &&
                                b.box.low[k] + b.center[k] <= a.box.high[k] + a.center[k]);
}

// What is added to places of `a` to have them in the coordinates of `b`: parts that share no place are
// seen middle to middle.
function offsetBetween(a, b) {
  const middle = (d, k) => (d.box.low[k] + d.box.high[k]) / 2;
  const near = overlap(a, b);
  return [0, 1, 2].map((k) => (near ? a.center[k] - b.center[k] : middle(b, k) - middle(a, k)));
}

// Before anything is drawn: what both are drawn with.
function bringTogether(a, b) {
  const offset = offsetBetween(a, b);
  const low = a.box.low.map((v, k) => Math.min(v, b.box.low[k] - offset[k]));
  const high = a.box.high.map((v, k) => Math.max(v, b.box.high[k] - offset[k]));
  a.box = { low, high };
  b.box = { low: low.map((v, k) => v + offset[k]), high: high.map((v, k) => v + offset[k]) };
  a.limit = b.limit = Math.max(a.limit, b.limit);
  const histograms = [a, b].map((d) => d.histogram).filter(Boolean);
  if (histograms.length === 2) {
    a.reach = b.reach = {
      low: Math.min(...histograms.map((h) => h.low)), high: Math.max(...histograms.map((h) => h.high)),
    };
  }
  return offset;
}

// Calls of these methods of one are calls of both, while `both()`.
function together(a, b, names, both = () => true) {
  for (const name of names) {
    const own = [a, b].map((one) => one[name].bind(one));
    [a, b].forEach((one, k) => {
      one[name] = (...words) => {
        const done = own[k](...words);
        if (both()) own[1 - k](...words);
        return done;
      };
    });
  }
}

// Turning, moving and zooming one view turns, moves and zooms the other.
function followEachOther(a, b, offset) {
  const follow = (from, to, sign) => {
    const here = from.camera, there = to.camera;
    const target = here.target.clone().add(new THREE.Vector3(...offset.map((v) => sign * v)));
    const same = there.half === here.half && there.turn.equals(here.turn) &&
      there.target.distanceTo(target) < 1e-9 * (here.radius + target.length());
    if (same) return;
    there.turn.copy(here.turn);
    there.up.copy(here.up);
    there.target.copy(target);
    there.half = here.half;
    to.draw();
  };
  a.onDraw = () => follow(a, b, 1);
  b.onDraw = () => follow(b, a, -1);
  a.draw();
}

// Once both stages are open.
function joinStages(a, b, offset) {
  if (!a.view || !b.view) return;
  together(a, b, ["setMode", "setLayer", "show"]);
  together(a, b, ["setLimit"], () => a.view.mode === b.view.mode);
  b.element.classList.add("led");
  for (const [name, { view }] of a.views) {
    const other = b.views.has(name) ? b.views.get(name).view : null;
    if (!other) continue;
    if (name === "space") {
      for (const field of Object.keys(view.ranges)) {
        view.ranges[field] = other.ranges[field] = Math.max(view.ranges[field], other.ranges[field]);
      }
      together(view, other, ["setStripes", "setCombScale"]);
      other.setCombScale(view.combScale);
      followEachOther(view, other, offset);
    } else {
      together(view, other, ["setFactor", "setCombScale"]);
      view.setFactor(Math.min(view.factor, other.factor));
      view.setCombScale(view.combScale);
    }
  }
  [a, b].forEach((stage) => {
    stage.makeControls();
    stage.refresh();
  });
}

// "+0.012 (+4.0 %)": how much more the first is; of more than tenfold "+5.2 (26 times)".
function difference(x, y, write) {
  if (![x, y].every((v) => typeof v === "number" && isFinite(v))) return kNone;
  const more = x - y, sign = more > 0 ? "+" : kMinus;
  if (more === 0) return "0";
  const share = Math.abs(more / y), relative =
    !isFinite(share) ? "" : x > 10 * y ? significant(x / y, 2) + " times" :
      sign + (share < 1 ? percent(share) : significant(100 * share, 3) + kNarrowSpace + "%");
  return sign + write(Math.abs(more)) + (relative ? " (" + relative + ")" : "");
}

// How many control points there are in all.
function controlPoints(report) {
  const g = report.geometry || {};
  const sizes = [].concat(g.control_points === undefined ? [] : g.control_points);
  if (sizes.length === 0 || sizes.some((n) => typeof n !== "number")) return null;
  return sizes.reduce((all, n) => (g.kind === "curve" ? all + n : all * n));
}

function sideBySideTable(a, b) {
  const reports = [a.report, b.report];
  const scale = [a, b].map(lengthScale).reduce((x, y) => (x.decimals > y.decimals ? x : y));
  const unit = a.unit ? " [" + a.unit + "]" : "";
  const row = (label, of, write) => {
    const [x, y] = reports.map(of);
    return [label, write(x), write(y), difference(x, y, write)];
  };
  const length = (label, of) => row(label + unit, of, (v) => scale.number(v));
  const error = (label, field) => length(label, (r) => (r.error || {})[field]);
  const input = (label, field) => row(label, (r) => (r.input || {})[field], count);
  const titles = a.title === b.title ? [a.title + ", left", b.title + ", right"] : [a.title, b.title];
  const element = table("Side by side", [
    error("rms", "rms"), error("mean distance", "mean"), error("median", "p50"), error("95 % within", "p95"),
    error("99 % within", "p99"), error("largest", "max"),
    row("in tolerance", (r) => ((r.error || {}).tolerance > 0 ? r.error.within_tolerance : undefined), percent),
    length("rms of all points", (r) => (r.error_all || {}).rms),
    length("noise, estimated", (r) => (r.input || {}).noise),
    input("points read", "points"), input("points used", "used"), input("outliers set aside", "outliers"),
    row("control points", controlPoints, count),
    row("trim loops", (r) => (r.geometry || {}).trims, count),
    row("rounds", (r) => (isComparison({ report: r }) ? undefined : (r.iterations || []).length), count),
    row("time in all", (r) => (r.seconds || {}).total, seconds),
  ], [...titles, "difference"]);
  element.classList.add("compared");
  element.append(html("p", "note", "Difference: how much more the left one has."));
  return element;
}

// Cards of both, row by row: { name, element } of each.
function pairedRows(first, second) {
  const names = [...new Set([...first, ...second].map((card) => card.name))];
  const order = (name) => Math.max(...[first, second].map((cards) => cards.findIndex((card) => card.name === name)));
  names.sort((x, y) => order(x) - order(y));
  const find = (cards, name) => (cards.find((card) => card.name === name) || { element: html("div", "none") }).element;
  return html("div", "pair", names.flatMap((name) => [find(first, name), find(second, name)]));
}

// The page of two: what is looked at first, the figures, the rest.
function besideEachOther([a, b], [first, second]) {
  const above = (card) => ["header", "stage", "histogram"].includes(card.name), below = (card) => !above(card);
  return [pairedRows(first.filter(above), second.filter(above)), sideBySideTable(a, b),
          pairedRows(first.filter(below), second.filter(below))];
}
