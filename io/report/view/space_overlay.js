// SPDX-License-Identifier: MIT
// What lies over the view in space: the axes, a scale bar, and the label of the place under the pointer.

class SpaceOverlay {
  constructor(stage, data) {
    this.data = data;
    this.svg = newSvg("overlay");
    this.svg.setAttribute("aria-hidden", "true");
    this.label = html("div", "label");
    this.label.hidden = true;
    stage.append(this.svg, this.label);
    this.pinned = null;
  }

  pin(pick) {
    this.pinned = pick;
    this.label.hidden = true;
    this.shown = pick;
  }

  hover(pick, camera, width, height) {
    if (this.pinned) return;
    this.shown = pick;
    this.label.hidden = true;
    if (camera) this.update(camera, width, height);
    else clear(this.svg.querySelector(".place") || document.createElement("i"));
  }

  update(camera, width, height) {
    clear(this.svg);
    this.svg.setAttribute("viewBox", "0 0 " + width + " " + height);
    this.drawAxes(camera, 46, height - 46);
    this.drawScale(camera, width, height);
    const place = add(this.svg, "g", { class: "place" });
    if (this.shown) this.drawPlace(place, camera, width, height);
  }

  drawAxes(camera, x0, y0) {
    const back = camera.turn.clone().conjugate();
    const axes = ["x", "y", "z"].map((name, k) => {
      const v = new THREE.Vector3(k === 0 ? 1 : 0, k === 1 ? 1 : 0, k === 2 ? 1 : 0).applyQuaternion(back);
      return { name, v };
    });
    axes.sort((a, b) => a.v.z - b.v.z);
    for (const { name, v } of axes) {
      const x = x0 + 30 * v.x, y = y0 - 30 * v.y;
      add(this.svg, "line", { x1: x0, y1: y0, x2: x, y2: y, class: "axis-" + name });
      add(this.svg, "text", { x: x0 + 39 * v.x, y: y0 - 39 * v.y + 4, class: "axis-name middle" }, name);
    }
    add(this.svg, "circle", { cx: x0, cy: y0, r: 2.4, class: "axis-origin" });
  }

  drawScale(camera, width, height) {
    const perPixel = 2 * camera.half / height;
    const length = niceBelow(Math.min(150, width / 3) * perPixel);
    const pixels = length / perPixel;
    const x1 = width - 18, x0 = x1 - pixels, y = height - 18;
    add(this.svg, "path", { d: pathThrough([[x0, y - 5], [x0, y], [x1, y], [x1, y - 5]]), class: "scale-bar" });
    add(this.svg, "text", { x: (x0 + x1) / 2, y: y - 7, class: "scale-text middle" },
        plain(length) + (this.data.unit ? kNarrowSpace + this.data.unit : ""));
  }

  drawPlace(group, camera, width, height) {
    const p = new THREE.Vector3(...this.shown.place).sub(camera.target);
    const perPixel = 2 * camera.half / height;
    const x = width / 2 + p.dot(camera.axis(0)) / perPixel, y = height / 2 - p.dot(camera.axis(1)) / perPixel;
    add(group, "circle", { cx: x, cy: y, r: 4, class: "place-mark" });
    showLabel(this.label, this.shown.lines, x, y, width, height);
  }
}

// Text lines beside (x, y), inside the view.
function showLabel(label, lines, x, y, width, height) {
  clear(label);
  lines.forEach((line, i) => label.append(html("div", i === 0 ? "first" : "", line)));
  label.hidden = false;
  const w = label.offsetWidth, h = label.offsetHeight;
  label.style.left = Math.max(4, x + 14 + w < width ? x + 14 : x - 14 - w) + "px";
  label.style.top = Math.max(4, Math.min(height - h - 4, y - h / 2)) + "px";
}
