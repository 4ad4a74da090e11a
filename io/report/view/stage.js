// SPDX-License-Identifier: MIT
// The stage: the view in space or the plan, with its legend, its switches, and its picture for paper.

class Stage {
  constructor(data, onLimit) {
    this.data = data;
    this.onLimit = onLimit;
    this.views = new Map();
    this.top = html("div", "bar");
    this.box = html("div", "stage");
    this.legend = newSvg("legend");
    this.paper = html("img", "paper");
    this.paper.alt = "The view as it was when the page was printed";
    this.bottom = html("div", "bar below");
    this.note = html("p", "note");
    this.element = html("section", "card view-card", this.top, this.box, this.bottom, this.note);
  }

  // Called once the element is in the page: views need their size.
  open() {
    const data = this.data;
    const curves = data.curves.length > 0 && data.surfaces.length === 0;
    if (curves) this.addView("plan", (box) => new PlanView(box, data));
    if (!curves || !data.signed) this.addView("space", (box) => SpaceView.make(box, data));
    this.box.append(this.paper, this.legend);
    if (this.views.size === 0) {
      this.box.classList.add("empty");
      this.box.append(html("div", "message", html("p", "", html("strong", "", "The view in space is not available.")),
        html("p", "", "This browser does not offer WebGL. All figures of the report are on this page.")));
      return;
    }
    this.show(this.views.has("space") ? "space" : "plan");
  }

  addView(name, make) {
    const box = html("div", "view");
    this.box.append(box);
    const view = make(box);
    if (view) {
      this.views.set(name, { view, box });
    } else {
      box.remove();
    }
  }

  // Brings one of the views to the front.
  show(name) {
    if (!this.views.has(name)) return false;
    this.views.forEach(({ box }, n) => { box.hidden = n !== name; });
    this.name = name;
    this.view = this.views.get(name).view;
    this.view.resize();
    this.makeControls();
    this.refresh();
    this.view.renderNow();
    return true;
  }

  makeControls() {
    const view = this.view, data = this.data;
    clear(this.top);
    clear(this.bottom);
    this.sliders = {};
    if (this.views.size > 1) {
      const tabs = chooser("View", [{ name: "space", label: "In space" }, { name: "plan", label: "Plan" }], (n) => this.show(n));
      tabs.choose(this.name);
      this.top.append(tabs.element);
    }
    this.modes = null;
    if (view.modes.length > 0) {
      this.modes = chooser("Colours of the surface", view.modes, (name) => this.setMode(name));
      this.top.append(this.modes.element);
    }
    const looks = html("div", "looks");
    if (this.name === "space") {
      for (const axis of ["x", "y", "z"]) {
        looks.append(pressButton(axis.toUpperCase(), null, () => view.setView(axis),
                                 "Look along " + axis + "; with Shift on the keyboard from the other side"));
      }
    }
    looks.append(pressButton("Reset", null, () => view.setView("all"), "Show all, as at the beginning (0)"));
    looks.append(pressButton("PNG", null, () => savePicture(this), "Save the view as a picture"));
    this.top.append(looks);
    this.switches = layerSwitches(view.layers, (name, on) => this.setLayer(name, on));
    const settings = html("div", "settings");
    this.bottom.append(this.switches.element, settings);
    const slider = (name, options) => {
      this.sliders[name] = logSlider(options);
      settings.append(this.sliders[name].element);
    };
    slider("limit", { label: "Colours up to " + (data.signed ? "\u00b1" : ""), unit: data.unit, decades: 1.5,
      read: () => view.range(), act: (v) => this.setLimit(v) });
    if (view.modes.some((m) => m.name === "zebra")) {
      let stripes = 24;
      slider("stripes", { label: "Stripes", unit: "", decades: 0.7, read: () => stripes, act: (v) => {
        stripes = Math.max(2, Math.min(200, v));
        view.setStripes(stripes);
      } });
    }
    if (view.factor !== undefined && view.layers.some((l) => l.name === "whiskers")) {
      slider("factor", { label: "Deviations \u00d7", unit: "", decades: 1.5, read: () => view.factor,
        act: (v) => { view.setFactor(v); this.say(); } });
    }
    if (view.layers.some((l) => l.name === "comb")) {
      slider("comb", { label: "Comb", unit: data.unit ? data.unit + "\u00b2" : "", decades: 1.5, read: () => view.combScale || 1,
        act: (v) => view.setCombScale(v) });
    }
  }

  setMode(name) {
    const done = this.view.setMode(name);
    this.sliders.limit.show(true);
    this.refresh();
    return done;
  }

  setLayer(name, on) {
    const done = this.view.setLayer(name, on);
    this.refresh();
    return done;
  }

  setLimit(limit) {
    this.views.forEach(({ view }) => { if (view === this.view || this.view.mode === "deviation") view.setLimit(limit); });
    this.refresh();
    if (this.view.mode === "deviation") this.onLimit(limit);
  }

  // The legend and all that depends on what is shown.
  refresh() {
    if (!this.view) return;
    if (this.modes) this.modes.choose(this.view.mode);
    this.switches.show();
    const legend = this.view.legend();
    this.legend.style.display = legend ? "" : "none";
    if (legend) drawLegend(this.legend, legend);
    const zebra = this.view.mode === "zebra";
    this.sliders.limit.element.hidden = !legend;
    if (this.sliders.stripes) this.sliders.stripes.element.hidden = !zebra;
    if (this.sliders.factor) this.sliders.factor.element.hidden = !this.view.shows("whiskers");
    if (this.sliders.comb) this.sliders.comb.element.hidden = !this.view.shows("comb");
    this.say();
  }

  // What the drawing leaves out or enlarges, in words, and how to move it.
  say() {
    const cloud = this.data.cloud;
    const texts = [];
    if (cloud && cloud.shown < cloud.total) {
      texts.push(count(cloud.shown) + " of " + counted(cloud.total, "point") + " are drawn; all count in the figures.");
    }
    if (this.view && this.view.shows("whiskers")) {
      texts.push("Deviations are drawn " + plain(this.view.factor) + " times as long" +
                 (this.data.tolerance !== null ? ", as is the tolerance (dashed)." : "."));
    }
    clear(this.note);
    if (texts.length > 0) this.note.append(texts.join(" ") + " ");
    this.note.append(html("span", "hint", this.name === "plan" ?
      "Drag moves, the wheel or two fingers zoom." :
      "Drag turns, Shift and drag or two fingers move, the wheel or two fingers zoom; click for values."));
  }

  // Replaces the drawing by a picture while the page is printed.
  toPaper() {
    if (!this.view) return;
    const { url, over } = this.view.image(1800, 1080);
    this.paper.src = url;
    this.box.querySelectorAll(".paper-overlay").forEach((old) => old.remove());
    if (over) {
      over.setAttribute("class", "paper-overlay");
      this.box.append(over);
    }
  }
}
