"use strict";
// Scale of the drawing and curves of all bins, from the page itself.
const data = JSON.parse(document.getElementById("data").textContent);
const SVG = "http://www.w3.org/2000/svg";

function add(parent, tag, attributes, text) {
  const element = document.createElementNS(SVG, tag);
  for (const name in attributes) element.setAttribute(name, attributes[name]);
  if (text !== undefined) element.textContent = text;
  parent.appendChild(element);
  return element;
}

// Round numbers between two ends, about so many, each with its text.
function ticks(low, high, count) {
  const raw = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= raw);
  const found = [];
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  for (let i = Math.ceil(low / step); i * step <= high; i++)
    found.push([i * step, (i * step).toFixed(Math.min(decimals, 20))]);
  return found;
}

const shown = (value) => String(Number(value.toPrecision(4)));

// --- The profile: wheel and buttons zoom, dragging moves, a click chooses x.

const drawing = document.getElementById("profile");
const world = document.getElementById("world");
const labels = document.getElementById("labels");
const slider = document.getElementById("slider");
const { x: left, y: bottom, unit, width, height } = data.scale;
const [WIDE, HIGH] = ["width", "height"].map((n) => drawing.viewBox.baseVal[n]);
let view; // x and y of the lower left corner [m], and pixels per metre

function whole() {
  const scale = Math.min((WIDE - 60) / width, (HIGH - 40) / height);
  view = {
    x: left + width / 2 - (WIDE / 2 + 20) / scale,
    y: bottom - 30 / scale,
    scale,
  };
  place();
}

function place() {
  const s = view.scale;
  const toX = (x) => (x - view.x) * s, toY = (y) => HIGH - (y - view.y) * s;
  world.setAttribute(
    "transform", `matrix(${s * unit} 0 0 ${-s * unit} ${toX(left)} ${toY(bottom)})`);
  labels.replaceChildren();
  const bin = Number(slider.value), band = document.getElementById("bin");
  band.setAttribute("x", toX(data.edges[bin]));
  band.setAttribute("width", (data.edges[bin + 1] - data.edges[bin]) * s);
  add(labels, "rect", { class: "margin", x: 0, y: HIGH - 24, width: WIDE, height: 24 });
  add(labels, "rect", { class: "margin", x: 0, y: 0, width: 46, height: HIGH - 24 });
  for (const [x, text] of ticks(view.x, view.x + WIDE / s, 8)) {
    if (toX(x) > WIDE - 50) continue;
    add(labels, "line", { class: "grid", x1: toX(x), x2: toX(x), y1: HIGH - 22, y2: HIGH - 17 });
    add(labels, "text", { x: toX(x), y: HIGH - 5, "text-anchor": "middle" }, text);
  }
  for (const [y, text] of ticks(view.y, view.y + HIGH / s, 5)) {
    if (toY(y) > HIGH - 25 || toY(y) < 15) continue;
    add(labels, "line", { class: "grid", x1: 42, x2: 47, y1: toY(y), y2: toY(y) });
    add(labels, "text", { x: 38, y: toY(y) + 4, "text-anchor": "end" }, text);
  }
  add(labels, "text", { x: WIDE - 4, y: HIGH - 5, "text-anchor": "end" }, "x [m]");
  add(labels, "text", { x: 4, y: 14 }, "y [m]");
  for (const { x, y, words } of data.places) {
    const up = { x: toX(x) + 4, y: Math.max(Math.min(toY(y) - 6, HIGH - 30), 28) };
    const label = add(labels, "text", up, words);
    // To the left of its place where the drawing would end before it does.
    if (toX(x) > WIDE / 2 && up.x + label.getComputedTextLength() > WIDE) {
      label.setAttribute("x", toX(x) - 4);
      label.setAttribute("text-anchor", "end");
    }
  }
}

function zoom(factor, x, y) {
  const scale = view.scale * factor;
  const least = 0.5 * Math.min(WIDE / width, HIGH / height);
  if (scale < least || scale > 1e4 * least) return;
  view.x += x / view.scale - x / scale;
  view.y += (HIGH - y) / view.scale - (HIGH - y) / scale;
  view.scale = scale;
  place();
}

// Place of the pointer in the drawing's own pixels, whatever its size on the screen.
function pointer(event) {
  const box = drawing.getBoundingClientRect();
  return [
    ((event.clientX - box.left) * WIDE) / box.width,
    ((event.clientY - box.top) * HIGH) / box.height,
  ];
}

drawing.addEventListener("wheel", (event) => {
  event.preventDefault();
  zoom(Math.exp(-Math.sign(event.deltaY) * 0.2), ...pointer(event));
}, { passive: false });

let held = null;
drawing.addEventListener("pointerdown", (event) => {
  held = { at: pointer(event), moved: false };
  drawing.setPointerCapture(event.pointerId);
  drawing.classList.add("held");
});
drawing.addEventListener("pointermove", (event) => {
  if (!held) return;
  const [x, y] = pointer(event);
  if (Math.hypot(x - held.at[0], y - held.at[1]) > 3) held.moved = true;
  if (!held.moved) return;
  view.x -= (x - held.at[0]) / view.scale;
  view.y += (y - held.at[1]) / view.scale;
  held.at = [x, y];
  place();
});
drawing.addEventListener("pointerup", (event) => {
  if (held && !held.moved) {
    choose(view.x + pointer(event)[0] / view.scale);
    slider.closest("details").open = true;
  }
  held = null;
  drawing.classList.remove("held");
});
drawing.addEventListener("pointercancel", () => {
  held = null;
  drawing.classList.remove("held");
});
const middle = [WIDE / 2, HIGH / 2];
document.getElementById("closer").onclick = () => zoom(1.5, ...middle);
document.getElementById("farther").onclick = () => zoom(1 / 1.5, ...middle);
document.getElementById("whole").onclick = whole;

// --- The curves in the bin that the slider chooses.

const panels = [...document.querySelectorAll(".curves svg")];

function choose(x) {
  const bin = data.edges.findIndex((edge) => edge > x) - 1;
  const last = data.counts.length - 1;
  slider.value = bin < 0 ? (x < data.edges[0] ? 0 : last) : bin;
  draw();
}

function draw() {
  const bin = Number(slider.value), count = data.counts[bin];
  const [from, to] = [data.edges[bin], data.edges[bin + 1]];
  // By the width of the bin: national coordinates have many digits.
  const decimals = Math.max(0, 2 - Math.floor(Math.log10(to - from)));
  const end = (x) => Number(x.toFixed(decimals));
  document.getElementById("where").textContent =
    `x from ${end(from)} to ${end(to)} m: ${count} of ${data.blocks} blocks come there`;
  place();
  data.quantities.forEach((quantity, i) => panel(panels[i], quantity, bin));
  table(bin);
}

// Share of all blocks above a value, on a logarithmic scale down to one block.
function panel(svg, quantity, bin) {
  svg.replaceChildren();
  const [x0, y0, x1, y1] = [52, 190, 290, 12];
  add(svg, "text", { x: (x0 + x1) / 2, y: 232, "text-anchor": "middle" },
    `${quantity.words} [${quantity.unit}]`);
  add(svg, "text", { x: 13, y: (y0 + y1) / 2, "text-anchor": "middle",
    transform: `rotate(-90 13 ${(y0 + y1) / 2})` }, "share of blocks above");
  const values = quantity.values[bin];
  if (!values.length) {
    add(svg, "text", { x: (x0 + x1) / 2, y: 100, "text-anchor": "middle" },
      "no block comes there");
    return;
  }
  const decades = Math.max(Math.ceil(Math.log10(data.blocks) - 1e-9), 1);
  const top = values[0] > 0 ? 1.05 * values[0] : 1;
  const toX = (v) => x0 + (Math.max(v, 0) / top) * (x1 - x0);
  const toY = (share) => y1 - (Math.log10(share) / decades) * (y0 - y1);
  for (let d = 0; d <= decades; d++) {
    const y = toY(10 ** -d);
    add(svg, "line", { class: "grid", x1: x0, x2: x1, y1: y, y2: y });
    add(svg, "text", { x: x0 - 5, y: y + 4, "text-anchor": "end" },
      `${Number((100 * 10 ** -d).toPrecision(1))} %`);
  }
  for (const [v, text] of ticks(0, top, 4)) {
    add(svg, "line", { class: "grid", x1: toX(v), x2: toX(v), y1: y0, y2: y1 });
    add(svg, "text", { x: toX(v), y: y0 + 16, "text-anchor": "middle" }, text);
  }
  const points = values.map((v, i) =>
    `${toX(v).toFixed(1)},${toY(data.ranks[bin][i] / data.blocks).toFixed(1)}`);
  // Down to one block at the right, and level to zero at the left.
  const last = data.ranks[bin].at(-1) / data.blocks;
  points.push(`${x0},${toY(last).toFixed(1)}`);
  add(svg, "polyline", { class: "curve", points: points.join(" ") });
}

function table(bin) {
  const body = document.getElementById("numbers");
  body.replaceChildren();
  const text = (v) => (v === null ? "-" : shown(v));
  for (const quantity of data.quantities) {
    const row = body.insertRow();
    row.insertCell().textContent = `${quantity.words} [${quantity.unit}]`;
    for (const [value, low, high] of quantity.percentiles[bin]) {
      row.insertCell().textContent = text(value);
      row.insertCell().textContent =
        low === null && high === null ? "-" : `${text(low)} to ${text(high)}`;
    }
  }
}

slider.addEventListener("input", draw);
whole();
// A link to a place ends in #x=450.
const linked = location.hash.match(/^#x=([-\d.]+)$/);
slider.closest("details").open = Boolean(linked);
choose(Number((linked || [0, data.start])[1]));
