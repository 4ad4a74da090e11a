// SPDX-License-Identifier: MIT
// Elements of the page, made without markup in strings: no text of a report is ever read as HTML.

const kSvg = "http://www.w3.org/2000/svg";

function attributes(element, values) {
  for (const [name, value] of Object.entries(values)) {
    element.setAttribute(name, typeof value === "number" ? String(Math.round(value * 100) / 100) : value);
  }
  return element;
}

function clear(element) {
  while (element.firstChild) element.removeChild(element.firstChild);
  return element;
}

// A new SVG element inside `parent`.
function add(parent, name, values = {}, text = null) {
  const element = attributes(document.createElementNS(kSvg, name), values);
  if (text !== null) element.textContent = text;
  parent.appendChild(element);
  return element;
}

function newSvg(className) {
  return attributes(document.createElementNS(kSvg, "svg"), { class: className });
}

// A new HTML element: html("p", "class names", "text" or children…).
function html(name, className = "", ...children) {
  const element = document.createElement(name);
  if (className) element.className = className;
  for (const child of children.flat()) {
    if (child === null || child === undefined) continue;
    element.append(child);
  }
  return element;
}

// The path through [x, y] pairs; a pair that is not finite interrupts it.
function pathThrough(pairs) {
  let path = "", pen = "M";
  for (const [x, y] of pairs) {
    if (!isFinite(x) || !isFinite(y)) {
      pen = "M";
      continue;
    }
    path += pen + x.toFixed(1) + " " + y.toFixed(1);
    pen = "L";
  }
  return path;
}

// The frame of a chart: axes, grid lines and ticks. x and y map values to pixels.
class Chart {
  constructor(svg, { width, height, left = 54, right = 14, top = 12, bottom = 38, label }) {
    clear(svg);
    attributes(svg, { viewBox: "0 0 " + width + " " + height, role: "img" });
    svg.style.aspectRatio = width + " / " + height;
    if (label) add(svg, "title", {}, label);
    Object.assign(this, { svg, width, height, left, right: width - right, top, bottom: height - bottom });
  }

  linearX(low, high) {
    this.x = (v) => this.left + (this.right - this.left) * (v - low) / (high - low);
  }

  linearY(low, high) {
    this.y = (v) => this.bottom - (this.bottom - this.top) * (v - low) / (high - low);
  }

  logY(low, high) {
    const a = Math.log10(low), b = Math.log10(high);
    this.y = (v) => this.bottom - (this.bottom - this.top) * (Math.log10(v) - a) / (b - a);
  }

  ticksX(values, text, title) {
    for (const v of values) {
      const x = this.x(v);
      add(this.svg, "line", { x1: x, x2: x, y1: this.bottom, y2: this.bottom + 4, class: "axis" });
      add(this.svg, "text", { x, y: this.bottom + 17, class: "tick middle" }, text(v));
    }
    add(this.svg, "line", { x1: this.left, x2: this.right, y1: this.bottom, y2: this.bottom, class: "axis" });
    if (title) {
      add(this.svg, "text", { x: (this.left + this.right) / 2, y: this.bottom + 34, class: "axis-title middle" }, title);
    }
  }

  ticksY(values, text, title) {
    for (const v of values) {
      const y = this.y(v);
      add(this.svg, "line", { x1: this.left, x2: this.right, y1: y, y2: y, class: "grid" });
      add(this.svg, "text", { x: this.left - 6, y: y + 4, class: "tick end" }, text(v));
    }
    if (title) {
      const y = (this.top + this.bottom) / 2;
      add(this.svg, "text", { x: 12, y, class: "axis-title middle", transform: "rotate(-90 12 " + y + ")" }, title);
    }
  }
}
