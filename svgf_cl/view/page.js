// The controls of the page hold its state. One loop requests one frame after the other from the server and draws it.

const by = id => document.getElementById(id);
const stage = by("stage"), divider = by("divider");
const transport = by("transport").elements, tools = by("tools").elements, filter = by("filter").elements;
const figures = new Map([...stage.querySelectorAll("figure")].map(each => [each.dataset.picture, each]));
const clip = await (await fetch("/clip")).json();
const count = clip.numbers.length;

// Settings: the values of each filter's controls

const settings = Object.fromEntries(Object.entries(clip.filters).map(([name, controls]) =>
  [name, Object.fromEntries(controls.map(each => [each.name, each.default]))]));
Object.assign(settings[clip.filter], clip.settings);

function make(name, attributes = {}, ...content) {
  const made = document.createElement(name);
  Object.assign(made, attributes);
  made.append(...content);
  return made;
}

// The scale of a slider: linear, or logarithmic if the range spans orders of magnitude.
function scaleOf({ least, greatest, whole }) {
  const round = value => whole ? Math.round(value) : Number(value.toPrecision(3));
  const low = least > 0 ? least : greatest / 1e5; // the least above 0
  if (whole || greatest <= 10 && least <= 0 || greatest < 100 * least) {
    return { to: value => (value - least) / (greatest - least), from: share => round(least + share * (greatest - least)) };
  }
  const span = Math.log(greatest / low);
  return {
    to: value => value <= low ? 0 : Math.log(value / low) / span,
    from: share => share <= 0 ? least : round(low * Math.exp(share * span)),
  };
}

function numberControl(control, value, change) {
  const { to, from } = scaleOf(control);
  const field = make("input", { type: "number", min: control.least, max: control.greatest, step: control.whole ? 1 : "any", value, required: true });
  const slider = make("input", { type: "range", min: 0, max: 1, step: "any", value: to(value), ariaLabel: control.name, tabIndex: -1 });
  field.addEventListener("input", () => {
    if (!field.checkValidity()) return;
    slider.value = to(field.valueAsNumber);
    change(field.valueAsNumber);
  });
  slider.addEventListener("input", () => {
    field.value = from(slider.valueAsNumber);
    change(field.valueAsNumber);
  });
  return [field, slider];
}

function choiceControl(control, value, change) {
  const select = make("select", {}, ...control.words.map(word => make("option", { selected: word === value }, word)));
  select.addEventListener("input", () => change(select.value));
  return [select];
}

function switchControl(control, value, change) {
  const box = make("input", { type: "checkbox", checked: value });
  box.addEventListener("input", () => change(box.checked));
  return [box];
}

const KINDS = { number: numberControl, choice: choiceControl, switch: switchControl };

function settingRow(control) {
  const values = settings[filter.filter.value];
  const name = make("span", {}, control.name.replaceAll("_", " "), ...(control.unit ? [" ", make("small", {}, control.unit)] : []));
  const row = make("label", { className: "setting", title: control.reason }, name);
  row.dataset.name = control.name;
  const mark = () => row.classList.toggle("changed", values[control.name] !== control.default);
  row.append(...KINDS[control.kind](control, values[control.name], value => {
    values[control.name] = value;
    mark();
    redraw();
  }));
  mark();
  return row;
}

function showSettings() {
  by("settings").replaceChildren(...clip.filters[filter.filter.value].map(settingRow));
  redraw();
}

function useDefaults() {
  for (const { name, default: value } of clip.filters[filter.filter.value]) settings[filter.filter.value][name] = value;
  showSettings();
}

// Frames: the next one is requested while this one is drawn

let playing = true;
let target = 0; // index of the frame to show
let way = 1; // 1 forward, -1 backward
let isStale = true; // whether the frame has to be requested
let ahead = null; // the request for the next frame
let wake = () => {};

function request(index) {
  const name = filter.filter.value;
  return JSON.stringify({ index, filter: name, settings: settings[name], exposure: tools.exposure.valueAsNumber || 0 });
}

async function ask(body) {
  let answer;
  try {
    answer = await fetch("/frame", { method: "POST", body });
  } catch {
    throw new Error("svgf-cl view has ended; start it again and load this page again");
  }
  if (!answer.ok) throw new Error((await answer.json()).error);
  return { about: JSON.parse(answer.headers.get("Frame")), pictures: await answer.arrayBuffer() };
}

function askAhead(index) {
  const body = request(index);
  ahead = { index, body, answer: ask(body) };
  ahead.answer.catch(() => {}); // the error is shown when this frame is due
}

// While frames play, a change of settings is visible from the frame after the next.
async function load(index) {
  const asked = ahead;
  ahead = null;
  if (asked && asked.index === index && (playing || asked.body === request(index))) return asked.answer;
  await asked?.answer.catch(() => {});
  return ask(request(index));
}

// The frame after this one and the direction from there on; null at the end.
function following(index, way) {
  const repeat = transport.repeat.value;
  const next = index + (repeat === "ping-pong" ? way : 1);
  if (next >= 0 && next < count) return { index: next, way: next - index };
  if (repeat === "once") return null;
  return repeat === "ping-pong" && count > 1 ? { index: index - way, way: -way } : { index: 0, way: 1 };
}

const sleep = time => new Promise(done => setTimeout(done, time));
let due = 0;

// Wait until the next frame is due. Frames after a late one are not played faster.
async function pace() {
  const now = performance.now();
  if (due > now) await sleep(due - now);
  due = Math.max(due, now) + 1000 / (transport.speed.checkValidity() ? transport.speed.valueAsNumber : 24);
}

async function play() {
  for (;;) {
    while (!playing && !isStale) await new Promise(done => { wake = done; });
    isStale = false;
    const index = target;
    const waiting = setTimeout(() => document.body.classList.add("waiting"), 300);
    try {
      const frame = await load(index);
      clearTimeout(waiting);
      if (playing) {
        await pace();
        const next = following(index, way);
        if (target === index && next) askAhead(next.index);
      }
      draw(frame);
      complain("");
      if (!playing && !isStale) target = index; // paused in the meantime
    } catch (error) {
      setPlaying(false);
      complain(error.message);
    }
    clearTimeout(waiting);
    document.body.classList.remove("waiting");
    if (!playing || target !== index) continue;
    advance();
  }
}

function advance() {
  const next = following(target, way);
  if (next) ({ index: target, way } = next);
  else setPlaying(false);
}

function redraw() {
  isStale = true;
  wake();
}

function setPlaying(value) {
  playing = value;
  by("play").textContent = playing ? "Pause" : "Play";
  drawn.length = 0;
}

function go(index) {
  setPlaying(false);
  way = 1;
  target = within(index, 0, count - 1);
  redraw();
}

function playOrPause() {
  setPlaying(!playing);
  if (!playing) target = shownIndex;
  else if (following(target, way)) advance();
  else target = 0;
  wake();
}

// Drawing

const drawn = []; // times when the last frames were drawn
let shownIndex = 0;
const fixed = (value, digits, unit) => value === undefined || value === null ? "" : `${value.toFixed(digits)}${unit}`;

// Draw a picture of three bytes per pixel. A canvas has four bytes, stored as ABGR.
function paint(canvas, pixels) {
  const context = canvas.getContext("2d", { alpha: false });
  const image = context.createImageData(clip.width, clip.height);
  const words = new Uint32Array(image.data.buffer);
  for (let word = 0, byte = 0; word < words.length; word += 1, byte += 3) {
    words[word] = 0xff000000 | pixels[byte + 2] << 16 | pixels[byte + 1] << 8 | pixels[byte];
  }
  context.putImageData(image, 0, 0);
}

function draw({ about, pictures }) {
  const size = clip.width * clip.height * 3;
  for (const [name, figure] of figures) {
    const place = about.pictures.indexOf(name);
    figure.classList.toggle("missing", place < 0);
    if (place >= 0) paint(figure.querySelector("canvas"), new Uint8Array(pictures, place * size, size));
    const error = fixed(about.temporal[name], 4, "");
    const measures = [fixed(about.psnr[name], 1, " dB"), error && `temporal error ${error}`];
    figure.querySelector("output").value = place < 0 ? "no reference for this frame" : measures.filter(Boolean).join(", ");
  }
  shownIndex = about.index;
  transport.position.value = about.index;
  by("frame").value = `frame ${clip.numbers[about.index]} (${about.index + 1} of ${count})`;
  by("time").value = fixed(Object.values(about.times).reduce((sum, each) => sum + each, 0), 1, " ms");
  by("times").replaceChildren(...Object.entries(about.times).map(([name, time]) =>
    make("tr", {}, make("td", {}, name), make("td", {}, fixed(time, 2, " ms")))));
  drawn.push(performance.now());
  if (drawn.length > 24) drawn.shift();
  by("rate").value = drawn.length < 2 ? "" : fixed(1000 * (drawn.length - 1) / (drawn.at(-1) - drawn[0]), 1, " fps");
}

function complain(message) {
  by("complaint").hidden = !message;
  by("complaint").textContent = message;
}

// The view that all pictures share: screen pixels per picture pixel (0: fit), and the point in the middle

const view = { zoom: 0, x: 0.5, y: 0.5 };
const pane = () => [...stage.querySelectorAll(".pane")].find(each => each.clientWidth);
const fitting = box => Math.min(box.clientWidth / clip.width, box.clientHeight / clip.height);
const scaled = box => view.zoom ? view.zoom / devicePixelRatio : fitting(box);

function look() {
  const box = pane();
  if (!box) return;
  const scale = scaled(box);
  for (const [at, whole, room] of [["x", clip.width, box.clientWidth], ["y", clip.height, box.clientHeight]]) {
    const half = room / (whole * scale) / 2;
    view[at] = half >= 0.5 ? 0.5 : within(view[at], half, 1 - half);
  }
  const snapped = value => Math.round(value * devicePixelRatio) / devicePixelRatio;
  stage.style.setProperty("--scale", scale);
  stage.style.setProperty("--left", snapped(box.clientWidth / 2 - view.x * clip.width * scale));
  stage.style.setProperty("--top", snapped(box.clientHeight / 2 - view.y * clip.height * scale));
  // Enlarged pixels are shown as squares. Reduced pictures are smoothed, because leaving out pixels would add noise.
  stage.classList.toggle("crisp", scale * devicePixelRatio >= 1);
  by("scale").value = `${Math.round(100 * scale * devicePixelRatio)} %`;
  for (const each of tools.zoom) each.checked = Number(each.value) === view.zoom;
}

function zoomBy(factor, at = { x: 0.5, y: 0.5 }) {
  const box = pane(), before = scaled(box);
  view.zoom = within(before * devicePixelRatio * factor, 1 / 16, 64);
  const after = scaled(box);
  view.x += (at.x - 0.5) * box.clientWidth / clip.width * (1 / before - 1 / after);
  view.y += (at.y - 0.5) * box.clientHeight / clip.height * (1 / before - 1 / after);
  look();
}

function panBy(x, y) {
  const box = pane(), scale = scaled(box);
  view.x -= x * box.clientWidth / (clip.width * scale);
  view.y -= y * box.clientHeight / (clip.height * scale);
  look();
}

function point(at) {
  by("pixel").value = "";
  if (!at) return;
  const box = pane(), scale = scaled(box);
  const x = Math.floor(view.x * clip.width + (at.x - 0.5) * box.clientWidth / scale);
  const y = Math.floor(view.y * clip.height + (at.y - 0.5) * box.clientHeight / scale);
  if (x >= 0 && x < clip.width && y >= 0 && y < clip.height) by("pixel").value = `pixel ${x}, ${y}`;
}

// Choice and layout of the pictures

const CAPTION = 24; // pixels

function arrange() {
  const slider = tools.layout.value === "slider";
  for (const [name, figure] of figures) {
    const left = slider && tools.left.value === name, right = slider && !left && tools.right.value === name;
    figure.classList.toggle("left", left);
    figure.classList.toggle("right", right);
    const box = [...tools.shown].find(each => each.value === name);
    figure.hidden = slider ? !left && !right : !box.checked || box.disabled;
  }
  by("pictures").hidden = slider;
  for (const pick of document.querySelectorAll(".side")) pick.hidden = !slider;
  stage.classList.toggle("slider", slider);
  stage.style.setProperty("--split", divider.value);
  fill();
}

// Choose the number of columns in which the pictures are largest.
function fill() {
  const number = stage.querySelectorAll("figure:not([hidden])").length;
  const size = columns => Math.min(
    stage.clientWidth / columns / clip.width, (stage.clientHeight / Math.ceil(number / columns) - CAPTION) / clip.height);
  const columns = Array.from({ length: number }, (_, index) => index + 1);
  const best = columns.reduce((best, each) => size(each) > size(best) ? each : best, 1);
  stage.style.setProperty("--columns", stage.classList.contains("slider") ? 1 : best);
  look();
}

function withoutReferences() {
  for (const each of tools.shown) each.disabled = each.value === "reference";
  for (const side of [tools.left, tools.right]) side.options[2].disabled = true;
  by("pictures").querySelector("[value=reference]").parentElement.hidden = true;
}

// Keys

function toggle(name) {
  [...tools.shown].find(each => each.value === name && !each.disabled)?.click();
}

function expose(stops) {
  tools.exposure.value = within((tools.exposure.valueAsNumber || 0) + stops, -64, 64);
  redraw();
}

function nextFilter() {
  filter.filter.selectedIndex = (filter.filter.selectedIndex + 1) % filter.filter.length;
  showSettings();
}

function fit() {
  view.zoom = 0;
  look();
}

const KEYS = {
  " ": playOrPause,
  Home: () => go(0),
  ArrowLeft: () => go((playing ? shownIndex : target) - 1),
  ArrowRight: () => go((playing ? shownIndex : target) + 1),
  1: () => toggle("noisy"),
  2: () => toggle("denoised"),
  3: () => toggle("reference"),
  w: () => [...tools.layout].find(each => !each.checked).click(),
  "+": () => zoomBy(Math.SQRT2),
  "=": () => zoomBy(Math.SQRT2), // + without shift
  "-": () => zoomBy(Math.SQRT1_2),
  0: fit,
  "[": () => expose(-0.5),
  "]": () => expose(0.5),
  f: nextFilter,
};

function press(event) {
  const act = KEYS[event.key];
  if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.target.matches("select, input:not([type=checkbox])")) return; // these use the keys themselves
  if (event.key === " " && event.target.matches("button, input")) return;
  event.preventDefault();
  act();
}

by("name").textContent = clip.name;
by("note").textContent = clip.note;
by("device").textContent = clip.device;
document.title = `${clip.name} - svgf-cl view`;
for (const canvas of stage.querySelectorAll("canvas")) Object.assign(canvas, { width: clip.width, height: clip.height });
filter.filter.append(...Object.keys(clip.filters).map(name => make("option", { selected: name === clip.filter }, name)));
tools.exposure.value = clip.exposure;
transport.position.max = count - 1;
if (!clip.has_references) withoutReferences();
showSettings();
arrange();
gestures(stage, { zoomBy, panBy, point, isWhole: () => false });
filter.filter.addEventListener("input", showSettings);
by("defaults").addEventListener("click", useDefaults);
by("transport").addEventListener("click", event => KEYS[event.target.closest("button")?.dataset.key]?.());
transport.position.addEventListener("input", () => go(transport.position.valueAsNumber));
tools.exposure.addEventListener("input", redraw);
by("tools").addEventListener("input", event => {
  if (event.target.name === "zoom") view.zoom = Number(tools.zoom.value);
  arrange();
});
for (const form of document.forms) form.addEventListener("submit", event => event.preventDefault());
divider.addEventListener("input", () => stage.style.setProperty("--split", divider.value));
addEventListener("keydown", press);
new ResizeObserver(fill).observe(stage);
play();
