// SPDX-License-Identifier: MIT
// The view as a picture for slides and mails: a PNG of the drawing with its axes, scale and legend.

const kPicture = { width: 1920, height: 1152 };  // pixels
const kDrawnProperties = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-dasharray", "stroke-linecap", "opacity",
                          "font-size", "font-weight", "font-family", "text-anchor", "display"];

// A drawing by itself: style sheets stay behind, so every element takes along what they make of it.
function withStyles(svg, looksLike) {
  const copy = svg.cloneNode(true);
  const from = [looksLike, ...looksLike.querySelectorAll("*")], to = [copy, ...copy.querySelectorAll("*")];
  to.forEach((element, k) => {
    if (!from[k]) return;
    const style = getComputedStyle(from[k]);
    element.setAttribute("style", kDrawnProperties.map((p) => p + ":" + style.getPropertyValue(p)).join(";"));
  });
  return copy;
}

function loadedImage(url) {
  return new Promise((resolve, reject) => {
    const image = new Image();
    image.onload = () => resolve(image);
    image.onerror = () => reject(new Error("a drawing can't be painted"));
    image.src = url;
  });
}

// Paints a drawing into a rectangle of the canvas.
async function paintSvg(context, svg, x, y, width, height) {
  attributes(svg, { width, height });
  const text = new XMLSerializer().serializeToString(svg);
  context.drawImage(await loadedImage("data:image/svg+xml;charset=utf-8," + encodeURIComponent(text)), x, y, width, height);
}

// The stage's view as { canvas }: the drawing, what lies over it, the legend in its corner.
async function pictureOf(stage) {
  const { width, height } = kPicture;
  const canvas = document.createElement("canvas");
  Object.assign(canvas, { width, height });
  const context = canvas.getContext("2d");
  context.fillStyle = "#fff";
  context.fillRect(0, 0, width, height);
  const { url, over } = stage.view.image(width, height);
  if (over) {  // in the page for a moment: only there it has its styles
    over.style.visibility = "hidden";
    stage.box.append(over);
  }
  const overlay = over ? withStyles(over, over) : null;
  if (over) over.remove();
  context.drawImage(await loadedImage(url), 0, 0, width, height);
  if (overlay) await paintSvg(context, overlay, 0, 0, width, height);
  const legend = stage.legend, box = legend.viewBox.baseVal;
  if (legend.style.display !== "none" && box && box.width > 0) {
    const scale = 2 * legend.getBoundingClientRect().width / box.width || 2;
    const w = box.width * scale, h = box.height * scale;
    await paintSvg(context, withStyles(legend, legend), width - w - 12, 24, w, h);
  }
  return canvas;
}

// Offers the picture as a file, named after the report.
async function savePicture(stage) {
  const canvas = await pictureOf(stage);
  const link = html("a");
  link.href = canvas.toDataURL("image/png");
  link.download = (decodeURIComponent(location.pathname.split("/").pop() || "").replace(/\.html?$/i, "") || "batten") + ".png";
  link.click();
}
