// SPDX-License-Identifier: MIT
// The buttons and sliders around a view.

function pressButton(label, pressed, act, title = "") {
  const button = html("button", "", label);
  button.type = "button";
  if (title) button.title = title;
  if (pressed !== null) button.setAttribute("aria-pressed", String(pressed));
  button.addEventListener("click", act);
  return button;
}

// One of several: { element, choose(name) }.
function chooser(label, options, act) {
  const group = html("div", "choice");
  group.setAttribute("role", "group");
  group.setAttribute("aria-label", label);
  const buttons = new Map();
  const choose = (name) => buttons.forEach((b, n) => b.setAttribute("aria-pressed", String(n === name)));
  for (const { name, label: text } of options) {
    const button = pressButton(text, false, () => act(name));
    button.dataset.name = name;
    buttons.set(name, button);
    group.append(button);
  }
  return { element: group, choose };
}

// A check box for every layer: { element, show() }.
function layerSwitches(layers, act) {
  const element = html("div", "layers");
  const boxes = new Map();
  for (const layer of layers) {
    const box = html("input");
    box.type = "checkbox";
    box.dataset.layer = layer.name;
    box.addEventListener("change", () => act(layer.name, box.checked));
    boxes.set(layer, box);
    element.append(html("label", "", box, layer.label));
  }
  const show = () => boxes.forEach((box, layer) => { box.checked = layer.on; });
  show();
  return { element, show };
}

// A slider over decades around a value, with the number itself: { element, show(value) }.
function logSlider({ label, unit, decades, read, act }) {
  const slider = html("input");
  slider.type = "range";
  slider.min = "-1";
  slider.max = "1";
  slider.step = "0.005";
  slider.setAttribute("aria-label", label);
  const number = html("input", "number");
  number.type = "text";
  number.inputMode = "decimal";
  number.setAttribute("aria-label", label + (unit ? " in " + unit : ""));
  let base = read();
  const write = (value) => {
    // Back in the form that the field reads.
    number.value = String(Number(value.toPrecision(3)));
    slider.value = String(Math.max(-1, Math.min(1, Math.log10(value / base) / decades)));
  };
  slider.addEventListener("input", () => {
    const value = Number((base * Math.pow(10, decades * Number(slider.value))).toPrecision(2));
    number.value = String(value);
    act(value);
  });
  number.addEventListener("change", () => {
    const value = Number(number.value.replace(",", ".").replace("\u2212", "-"));
    if (value > 0 && isFinite(value)) {
      act(value);
      write(value);
    } else {
      write(read());
    }
  });
  write(base);
  const element = html("label", "slider", html("span", "", label), slider, number, unit ? html("span", "unit", unit) : null);
  const show = (rebase = false) => {
    if (rebase) base = read();
    write(read());
  };
  return { element, show };
}
