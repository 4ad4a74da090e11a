// SPDX-License-Identifier: MIT
// Puts the page together. window.battenReport lets scripts do what hands do:
//   modes, layers      the names that setMode and setLayer know
//   setMode(name)      "deviation", "gap", "sigma", "shaded", "mean", "gaussian", "zebra"; false where there is none
//   setLayer(name, on) "surface", "cloud", "outliers", "net", "trims", "knots", "curve", "comb", "whiskers"
//   setView(name)      "x", "-x", "y", "-y", "z", "-z", "all"
//   setLimit(value)    half the range of colours
//   show(name)         "space" or "plan" where curves have both
//   renderNow()        draws at once
//   picture()          a promise of the picture that the button PNG saves, as a data: URL
//   pixels()           { width, height, data } of the drawing as RGBA bytes
//   beside             the same of the report beside this one; null where there is none
// <html data-batten-ready="ms"> says that all is drawn, and when after the page's start.

function chartCard(title, className = "") {
  const svg = newSvg("chart");
  const note = html("p", "note");
  const card = html("section", "card " + className, title ? html("h2", "", title) : null, svg, note);
  return { card, svg, note };
}

// All there is of a report: { stage, cards: [{ place, name, element }], charts: [{ svg, draw(width, limit) }] }.
function partsOfReport(data, onLimit) {
  const cards = [], charts = [];
  const put = (place, name, element) => { if (element) cards.push({ place, name, element }); };
  const stage = new Stage(data, onLimit);
  put("head", "header", header(data));
  put("left", "stage", stage.element);
  if (data.histogram) {
    const { card, svg, note } = chartCard("Distribution of deviations");
    note.textContent = histogramNotes(data);
    put("side", "histogram", card);
    charts.push({ svg, draw: (w, limit) => drawHistogram(svg, data, limit, w) });
  }
  for (const [name, table] of checkTables(data)) put("side", name, table);
  put("side", "deviations", deviationTable(data));
  put("side", "parts", partsTable(data));
  put("side", "points", inputTable(data));
  put("side", "parts of the cloud", cloudPartsTable(data));
  put("side", "faces", facesTable(data));
  put("side", "relations", relationsTable(data));
  if (data.curves.length > 0 && data.surfaces.length === 0 && data.cloud) {
    const lengths = data.curves.map((c) => arcLengths(c.points));
    const places = placesAlong(data, lengths, 4000);
    data.curves.forEach((c, k) => {
      if (!places.some((p) => p.curve === k)) return;
      const { card, svg, note } = chartCard("Deviation along " + (data.curves.length > 1 ? c.name : "the curve"));
      if (places.length < data.cloud.points.length / 3) {
        note.textContent = count(places.length) + " of " + counted(data.cloud.total, "point") + " are drawn.";
      }
      put("wide", "along " + k, card);
      charts.push({ svg, draw: (w, limit) => drawAlong(svg, data, k, places, lengths, limit, w) });
    });
  }
  const rounds = data.report.iterations || [];
  if (rounds.some((r) => r.rms > 0 || r.max > 0)) {
    const { card, svg } = chartCard("Convergence");
    card.append(...[roundsTable(data)].filter(Boolean));
    put("wide", "convergence", card);
    charts.push({ svg, draw: (w) => drawConvergence(svg, data, w) });
  }
  put("tables", "geometry", geometryTable(data));
  put("tables", "run", runTable(data));
  put("foot", "command", commandCard(data));
  return { stage, cards, charts };
}

function arranged({ cards }) {
  const at = (place) => cards.filter((card) => card.place === place).map((card) => card.element);
  const wide = at("wide");
  const left = html("div", "left", at("left"), wide.length > 0 ? html("div", "wide", wide) : null);
  return [at("head"), html("div", "main", left, html("div", "side", at("side"))), html("div", "tables", at("tables")), at("foot")].flat();
}

// What scripts may do with a stage.
function handlesOf(stage) {
  return {
    get modes() { return stage.view ? stage.view.modes.map((m) => m.name) : []; },
    get layers() { return stage.view ? stage.view.layers.map((l) => l.name) : []; },
    setMode: (name) => Boolean(stage.view) && stage.setMode(name),
    setLayer: (name, on) => Boolean(stage.view) && stage.setLayer(name, on),
    setView: (name) => { if (stage.view) stage.view.setView(name); },
    setLimit: (value) => {
      if (!stage.view || !(value > 0)) return;
      stage.setLimit(value);
      stage.sliders.limit.show();
    },
    show: (name) => stage.show(name),
    renderNow: () => { if (stage.view) stage.view.renderNow(); },
    picture: async () => (stage.view ? (await pictureOf(stage)).toDataURL("image/png") : null),
    pixels: () => (stage.view ? stage.view.pixels() : null),
  };
}

function buildReport() {
  const datas = ["batten-data", "batten-beside"].map((id) => readViewData(document.getElementById(id).textContent)).filter(Boolean);
  const root = clear(document.getElementById("report"));
  const [data, other] = datas;
  const offset = other ? bringTogether(data, other) : null;
  let limit = data.limit;
  const sides = datas.map((one) => partsOfReport(one, (value) => {
    limit = value;
    drawCharts();
  }));
  root.append(...(other ? besideEachOther(datas, sides.map((side) => side.cards)) : arranged(sides[0])));

  const charts = sides.flatMap((side) => side.charts), widths = new Map();
  function drawCharts(onlyResized = false) {
    for (const chart of charts) {
      const width = Math.max(240, Math.round(chart.svg.parentElement.clientWidth - 2 * kCardPadding));
      if (onlyResized && widths.get(chart) === width) continue;
      widths.set(chart, width);
      chart.draw(width, limit);
    }
  }
  const stages = sides.map((side) => side.stage);
  stages.forEach((stage) => stage.open());
  if (other) joinStages(...stages, offset);
  drawCharts();
  let waiting = 0;
  window.addEventListener("resize", () => {
    clearTimeout(waiting);
    waiting = setTimeout(() => drawCharts(true), 120);
  });
  window.addEventListener("beforeprint", () => stages.forEach((stage) => stage.toPaper()));

  window.battenReport = handlesOf(stages[0]);
  window.battenReport.beside = other ? handlesOf(stages[1]) : null;
  document.documentElement.dataset.battenReady = String(Math.round(performance.now()));
}

const kCardPadding = 16;

try {
  buildReport();
} catch (error) {
  document.getElementById("report").append(html("p", "verdict bad",
    "This report cannot be shown: its data are damaged. (" + error.message + ")"));
  throw error;
}
