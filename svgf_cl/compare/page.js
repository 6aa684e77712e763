"use strict";
// The page's controls contain all choices; after every change, `update` shows them.

const data = JSON.parse(document.getElementById("data").textContent);
const controls = document.getElementById("controls");
const tools = document.getElementById("tools");
const divider = document.getElementById("divider");
const scenes = [...document.querySelectorAll(".scene")];
const MOST = 64; // greatest zoom, as a multiple of the whole picture

// Which scene, which rivals

let current = 0;
const scene = () => scenes[current];
const stage = () => scene().querySelector(".stage");
const chosen = () => new Set([...controls.querySelectorAll("[name=rival]:checked")].map(box => box.value));

function choose() {
  const wanted = Number(new FormData(controls).get("scene") ?? 0);
  scenes.forEach((section, index) => { section.hidden = index !== wanted; });
  if (wanted !== current) look(1, 0, 0);
  current = wanted;
  scene().querySelector(".viewer h3").after(tools);
  stage().append(divider);
  offer();
  update();
}

// Only rivals of the scene can be chosen for the two sides of the divider.
function offer() {
  const present = [...stage().querySelectorAll("figure")].map(figure => figure.dataset.rival);
  ["left", "right"].forEach((side, index) => {
    const select = tools.elements[side];
    for (const option of select.options) option.disabled = !present.includes(option.value);
    if (!present.includes(select.value)) select.value = present[Math.min(index, present.length - 1)];
  });
}

function update() {
  const slider = tools.elements.layout.value === "slider";
  const rivals = chosen();
  for (const figure of scene().querySelectorAll("figure")) figure.hidden = !rivals.has(figure.dataset.rival);
  for (const figure of stage().children) {
    if (figure === divider) continue;
    const [left, right] = ["left", "right"].map(side => slider && tools.elements[side].value === figure.dataset.rival);
    figure.classList.toggle("left", left);
    figure.classList.toggle("right", right && !left);
    if (slider) figure.hidden = !left && !right;
  }
  for (const pick of tools.querySelectorAll(".side")) pick.hidden = !slider;
  const count = stage().querySelectorAll("figure:not([hidden])").length;
  scene().style.setProperty("--columns", count === 4 ? 2 : within(count, 1, 3));
  stage().classList.toggle("slider", slider);
  stage().classList.toggle("errors", Boolean(tools.elements.heat?.checked));
  stage().classList.toggle("unmarked", !tools.elements.marks.checked);
  split();
  show();
  draw();
}

function split() {
  stage().style.setProperty("--split", divider.value);
}

// The view, the same for all pictures: their size, and their top left corner in widths and heights of a pane

const view = { zoom: 1, x: 0, y: 0 };

function look(zoom, x, y) {
  view.zoom = within(zoom, 1, MOST);
  view.x = within(x, 1 - view.zoom, 0);
  view.y = within(y, 1 - view.zoom, 0);
  show();
}

function zoomBy(factor, at = { x: 0.5, y: 0.5 }) {
  const by = within(view.zoom * factor, 1, MOST) / view.zoom;
  look(view.zoom * by, at.x - (at.x - view.x) * by, at.y - (at.y - view.y) * by);
}

function panBy(x, y) {
  look(view.zoom, view.x + x, view.y + y);
}

function show() {
  for (const name of ["zoom", "x", "y"]) stage().style.setProperty(`--${name}`, view[name]);
  stage().classList.toggle("near", view.zoom > 1);
  const pane = [...stage().querySelectorAll(".pane")].find(each => each.clientWidth);
  if (!pane) return;
  const scale = pane.clientWidth * view.zoom / data.scenes[current].size[1];
  tools.elements.scale.value = `${Math.round(scale * 100)} %`;
  // Enlarged pixels are shown as sharp blocks; in a reduced picture, that would pick single pixels and look noisy.
  for (const image of scene().querySelectorAll("figure img")) {
    const shown = image.clientWidth * (stage().contains(image) ? view.zoom : 1) * devicePixelRatio;
    image.classList.toggle("crisp", shown > image.naturalWidth);
  }
}

// Keys

const KEYS = {
  ArrowLeft: () => panBy(0.1, 0),
  ArrowRight: () => panBy(-0.1, 0),
  ArrowUp: () => panBy(0, 0.1),
  ArrowDown: () => panBy(0, -0.1),
  "+": () => zoomBy(Math.SQRT2),
  "=": () => zoomBy(Math.SQRT2), // + without shift
  "-": () => zoomBy(Math.SQRT1_2),
  0: () => look(1, 0, 0),
  e: () => tools.elements.heat?.click(),
};

function press(event) {
  const act = KEYS[event.key];
  if (!act || event.target !== event.currentTarget || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  act();
}

function point(at) {
  const [height, width] = data.scenes[current].size;
  stage().classList.toggle("pointed", Boolean(at));
  tools.elements.pixel.value = "";
  if (!at) return;
  stage().style.setProperty("--px", at.x);
  stage().style.setProperty("--py", at.y);
  const x = Math.floor((at.x - view.x) / view.zoom * width);
  const y = Math.floor((at.y - view.y) / view.zoom * height);
  if (x >= 0 && x < width && y >= 0 && y < height) tools.elements.pixel.value = `pixel ${x}, ${y}`;
}

// Plots

const SHAPES = ["M-4,0a4,4 0 1 0 8,0a4,4 0 1 0 -8,0z", "M-4,-4h8v8h-8z", "M0,-5l5,9h-10z", "M0,-5.5l5.5,5.5l-5.5,5.5l-5.5,-5.5z",
  "M0,5l5,-9h-10z", "M-4,-4l8,8m0,-8l-8,8", "M-5,0h10m-5,-5v10"];
const DASHES = ["", "7 3", "2 3", "10 3 2 3", "14 4"];
const COLOURS = ["#3b82d6", "#d9731a", "#2f9e6b", "#9b6bd3", "#d64f5b", "#1a97a8", "#a07838", "#7d8791"];

function svg(name, attributes, parent, text = "") {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.textContent = text;
  parent.append(made);
  return made;
}

// Each rival has its own colour, shape and dash, so that it can be recognised without the colour.
function looksOf(rival) {
  const index = data.rivals.indexOf(rival);
  return { colour: COLOURS[index % COLOURS.length], shape: SHAPES[index % SHAPES.length], dash: DASHES[index % DASHES.length] };
}

function mark(parent, rival, x, y) {
  const { colour, shape } = looksOf(rival);
  svg("path", { d: shape, fill: colour, stroke: colour, "stroke-width": 1.5, transform: `translate(${x} ${y})` }, parent);
}

function line(parent, rival, d) {
  const { colour, dash } = looksOf(rival);
  svg("path", { d, fill: "none", stroke: colour, "stroke-width": 1.75, "stroke-dasharray": dash }, parent);
}

function swatch(parent, rival) {
  const drawing = svg("svg", { viewBox: "0 0 28 12", "aria-hidden": "true" }, parent);
  line(drawing, rival, "M0,6H28");
  mark(drawing, rival, 14, 6);
}

// Round numbers between which all values lie.
function linear(values) {
  const low = Math.min(...values), high = Math.max(...values);
  const span = high - low || Math.abs(high) || 1;
  const power = 10 ** Math.floor(Math.log10(span / 4));
  const step = [1, 2, 5, 10].map(each => each * power).find(each => span / each <= 5.5);
  const first = Math.floor(low / step), last = Math.max(Math.ceil(high / step), first + 1);
  const ticks = Array.from({ length: last - first + 1 }, (_, index) => Number(((first + index) * step).toPrecision(12)));
  return { low: ticks[0], high: ticks.at(-1), ticks, at: value => value };
}

function logarithmic(values) {
  const low = Math.min(...values) / 1.25, high = Math.max(...values) * 1.6;
  const ticks = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power++) {
    for (const each of [1, 2, 5]) ticks.push(Number((each * 10 ** power).toPrecision(6)));
  }
  return { low, high, ticks: ticks.filter(tick => tick >= low && tick <= high), at: Math.log };
}

function whole(values) {
  const low = Math.min(...values), high = Math.max(...values);
  const ticks = linear([low, high]).ticks.filter(tick => tick >= low && tick <= high && Number.isInteger(tick));
  return { low, high: Math.max(high, low + 1), ticks, at: value => value };
}

// Draw axes and grid; return the drawing, and functions from values to positions in it.
function axes(box, label, x, y, names) {
  const width = Math.max(box.clientWidth, 260), height = 300;
  const left = 14 + 7 * Math.max(...y.ticks.map(tick => String(tick).length)), right = width - 12, top = 24, bottom = height - 42;
  const across = value => left + (right - left) * (x.at(value) - x.at(x.low)) / (x.at(x.high) - x.at(x.low));
  const up = value => bottom - (bottom - top) * (y.at(value) - y.at(y.low)) / (y.at(y.high) - y.at(y.low));
  box.replaceChildren();
  const drawing = svg("svg", { width, height, role: "img", "aria-label": label }, box);
  for (const tick of y.ticks) {
    svg("path", { d: `M${left},${up(tick)}H${right}`, class: "faint" }, drawing);
    svg("text", { x: left - 7, y: up(tick) + 4, "text-anchor": "end", class: "quiet" }, drawing, tick);
  }
  for (const tick of x.ticks) {
    svg("path", { d: `M${across(tick)},${bottom}v5`, class: "faint" }, drawing);
    svg("text", { x: across(tick), y: bottom + 19, "text-anchor": "middle", class: "quiet" }, drawing, tick);
  }
  svg("text", { x: 0, y: 12 }, drawing, names.y);
  svg("text", { x: right, y: height - 5, "text-anchor": "end" }, drawing, names.x);
  return { drawing, across, up };
}

function title(key) {
  const { name, aim } = data.measures[key];
  return aim ? `${name} (${aim})` : name;
}

function draw() {
  const speed = document.querySelector("#speed");
  if (speed) drawSpeed(speed.querySelector(".chart"), speed.querySelector("select").value);
  const plot = scene().querySelector(".plot");
  if (plot) drawCurves(plot, plot.querySelector("select").value);
}

function drawSpeed(box, key) {
  const spots = data.speed[key];
  const x = logarithmic(spots.map(spot => spot[1])), y = linear(spots.map(spot => spot[2]));
  const { drawing, across, up } = axes(box, `Time of a frame and ${title(key)}`, x, y, { x: "ms per frame", y: title(key) });
  const taken = spots.map(([, time, value]) => new DOMRect(across(time) - 6, up(value) - 6, 12, 12));
  for (const [rival, time, value] of spots) {
    mark(drawing, rival, across(time), up(value));
    taken.push(label(drawing, rival, across(time), up(value), taken));
  }
}

// Label a mark where there is room: to the right, to the left, above or below.
function label(drawing, name, x, y, taken) {
  const text = svg("text", {}, drawing, name.length > 32 ? `${name.slice(0, 31)}…` : name);
  const places = [["start", 10, 4], ["end", -10, 4], ["middle", 0, -11], ["middle", 0, 20], ["end", 6, -11], ["end", 6, 20],
    ["start", -6, -11], ["start", -6, 20], ["end", 6, -24], ["end", 6, 34]];
  const free = box => box.left >= 0 && box.right <= drawing.clientWidth
    && !taken.some(other => box.left < other.right && box.right > other.left && box.top < other.bottom && box.bottom > other.top);
  for (const [anchor, across, down] of [...places, places[0]]) {
    for (const [key, value] of Object.entries({ "text-anchor": anchor, x: x + across, y: y + down })) text.setAttribute(key, value);
    const box = DOMRect.fromRect(text.getBBox());
    if (free(box)) return box;
  }
  return DOMRect.fromRect(text.getBBox());
}

function drawCurves(plot, key) {
  const { frames, curves } = data.scenes[current];
  const rivals = chosen();
  const drawn = data.rivals.map((rival, index) => [rival, curves[key][index] ?? []])
    .filter(([rival, curve]) => rivals.has(rival) && curve.some(value => value !== null));
  plot.querySelector(".legend").replaceChildren(...drawn.map(([rival]) => entry(rival)));
  const values = drawn.flatMap(([, curve]) => curve.filter(value => value !== null));
  const box = plot.querySelector(".chart");
  if (!values.length) return box.replaceChildren();
  const { drawing, across, up } = axes(box, `${title(key)} over frames`, whole(frames), linear(values), { x: "frame", y: title(key) });
  const every = Math.ceil(frames.length / 10);
  drawn.forEach(([rival, curve], order) => {
    const spots = curve.map((value, index) => value !== null && [across(frames[index]), up(value)]);
    line(drawing, rival, spots.map((spot, index) => spot && `${spots[index - 1] ? "L" : "M"}${spot}`).filter(Boolean).join(""));
    spots.forEach((spot, index) => spot && (index + order) % every === 0 && mark(drawing, rival, ...spot));
  });
}

function entry(rival) {
  const item = document.createElement("li");
  const sign = document.createElement("span");
  sign.className = "swatch";
  swatch(sign, rival);
  item.append(sign, rival);
  return item;
}

// An animation starts again when its image's address is set, even to the same address.
function restart(part) {
  for (const image of part.querySelectorAll("img")) image.src = image.getAttribute("src");
}

for (const sign of controls.querySelectorAll(".swatch")) swatch(sign, sign.previousElementSibling.value);
for (const each of document.querySelectorAll(".stage")) {
  each.addEventListener("keydown", press);
  gestures(each, { zoomBy, panBy, point, isWhole: () => view.zoom === 1 });
}
for (const button of document.querySelectorAll(".together")) button.addEventListener("click", () => restart(button.closest(".part")));
for (const part of document.querySelectorAll(".part")) part.open = !matchMedia("(prefers-reduced-motion: reduce)").matches;
for (const select of document.querySelectorAll(".plot select")) select.addEventListener("change", draw);
tools.addEventListener("click", event => KEYS[event.target.closest("button")?.dataset.key]?.());
tools.addEventListener("input", update);
divider.addEventListener("input", split);
controls.addEventListener("input", choose);
addEventListener("load", choose); // once images have their size
addEventListener("resize", update);
