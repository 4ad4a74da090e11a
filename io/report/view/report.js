// SPDX-License-Identifier: MIT
// Puts the page together. window.battenReport lets scripts do what hands do:
//   modes, layers      the names that setMode and setLayer know
//   setMode(name)      "deviation", "gap", "shaded", "mean", "gaussian", "zebra"; false where there is none
//   setLayer(name, on) "surface", "cloud", "outliers", "net", "trims", "knots", "curve", "comb", "whiskers"
//   setView(name)      "x", "-x", "y", "-y", "z", "-z", "all"
//   setLimit(value)    half the range of colours
//   show(name)         "space" or "plan" where curves have both
//   renderNow()        draws at once
//   picture()          a promise of the picture that the button PNG saves, as a data: URL
//   pixels()           { width, height, data } of the drawing as RGBA bytes
// <html data-batten-ready="ms"> says that all is drawn, and when after the page's start.

function chartCard(title, className = "") {
  const svg = newSvg("chart");
  const note = html("p", "note");
  const card = html("section", "card " + className, title ? html("h2", "", title) : null, svg, note);
  return { card, svg, note };
}

function buildReport() {
  const data = readViewData(document.getElementById("batten-data").textContent);
  const root = clear(document.getElementById("report"));
  const charts = [];
  let limit = data.limit;

  const stage = new Stage(data, (value) => {
    limit = value;
    drawCharts();
  });
  const side = html("div", "side");
  const wide = html("div", "wide");

  if (data.histogram) {
    const { card, svg, note } = chartCard("Distribution of deviations");
    note.textContent = histogramNotes(data);
    side.append(card);
    charts.push({ svg, draw: (w) => drawHistogram(svg, data, limit, w) });
  }
  side.append(...[deviationTable(data), partsTable(data), inputTable(data), cloudPartsTable(data), facesTable(data), relationsTable(data)].filter(Boolean));

  if (data.curves.length > 0 && data.surfaces.length === 0 && data.cloud) {
    const lengths = data.curves.map((c) => arcLengths(c.points));
    const places = placesAlong(data, lengths, 4000);
    data.curves.forEach((c, k) => {
      if (!places.some((p) => p.curve === k)) return;
      const { card, svg, note } = chartCard("Deviation along " + (data.curves.length > 1 ? c.name : "the curve"));
      if (places.length < data.cloud.points.length / 3) {
        note.textContent = count(places.length) + " of " + counted(data.cloud.total, "point") + " are drawn.";
      }
      wide.append(card);
      charts.push({ svg, draw: (w) => drawAlong(svg, data, k, places, lengths, limit, w) });
    });
  }
  const rounds = data.report.iterations || [];
  if (rounds.some((r) => r.rms > 0 || r.max > 0)) {
    const { card, svg } = chartCard("Convergence");
    card.append(...[roundsTable(data)].filter(Boolean));
    wide.append(card);
    charts.push({ svg, draw: (w) => drawConvergence(svg, data, w) });
  }
  const tables = html("div", "tables", [geometryTable(data), runTable(data)]);

  const left = html("div", "left", stage.element, wide.childNodes.length > 0 ? wide : null);
  root.append(header(data), html("div", "main", left, side));
  root.append(tables);
  const command = commandCard(data);
  if (command) root.append(command);

  const widths = new Map();
  function drawCharts(onlyResized = false) {
    for (const chart of charts) {
      const width = Math.max(240, Math.round(chart.svg.parentElement.clientWidth - 2 * kCardPadding));
      if (onlyResized && widths.get(chart) === width) continue;
      widths.set(chart, width);
      chart.draw(width);
    }
  }
  stage.open();
  drawCharts();
  let waiting = 0;
  window.addEventListener("resize", () => {
    clearTimeout(waiting);
    waiting = setTimeout(() => drawCharts(true), 120);
  });
  window.addEventListener("beforeprint", () => stage.toPaper());

  window.battenReport = {
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
