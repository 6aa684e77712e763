"use strict";
// Wheel, mouse and fingers move the pictures in the panes of a stage. Positions are in widths and heights of a pane.

const within = (value, low, high) => Math.min(Math.max(value, low), high);

function gestures(stage, { zoomBy, panBy, point, isWhole }) {
  // The position of an event in a pane.
  function place(event, pane) {
    const box = pane.getBoundingClientRect();
    return { x: (event.clientX - box.left) / box.width, y: (event.clientY - box.top) / box.height };
  }

  function turn(event) {
    const pane = event.target.closest(".pane");
    if (!pane || (event.deltaY > 0 && isWhole())) return; // it cannot get smaller, so the page scrolls
    event.preventDefault();
    zoomBy(Math.exp(-within(event.deltaY, -100, 100) / 250), place(event, pane));
  }

  const held = new Map(); // positions of the pressed pointers, in the pane in which the first was pressed

  function hold(event) {
    const [first] = held.values();
    const pane = first?.pane ?? event.target.closest(".pane");
    if (!pane || event.button !== 0) return;
    held.set(event.pointerId, { pane, ...place(event, pane) });
    pane.setPointerCapture(event.pointerId);
  }

  function drag(event) {
    const pane = held.get(event.pointerId)?.pane ?? event.target.closest(".pane");
    if (held.has(event.pointerId)) {
      const before = grip();
      held.set(event.pointerId, { pane, ...place(event, pane) });
      const after = grip();
      if (held.size > 1) zoomBy(after.spread / before.spread, before); // before panning, which may need the room
      panBy(after.x - before.x, after.y - before.y);
    }
    point(pane && place(event, pane));
  }

  function release(event) {
    held.delete(event.pointerId);
  }

  // The middle of all pressed pointers, and their distance from it.
  function grip() {
    const all = [...held.values()];
    const x = all.reduce((sum, each) => sum + each.x, 0) / all.length;
    const y = all.reduce((sum, each) => sum + each.y, 0) / all.length;
    return { x, y, spread: Math.max(0.01, ...all.map(each => Math.hypot(each.x - x, each.y - y))) };
  }

  const acts = { wheel: turn, pointerdown: hold, pointermove: drag, pointerup: release, pointercancel: release };
  for (const [name, act] of Object.entries(acts)) stage.addEventListener(name, act, { passive: false });
  stage.addEventListener("pointerleave", () => point(null));
}
