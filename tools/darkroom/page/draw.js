// What the pointer draws: a part of the print that is dodged or burnt, or its crop.
// @ts-check
/* global OpenSeadragon */
import { crop_to, crop_to_paper } from "./crop.js";
import { add_dodge, longer } from "./dodge.js";
import { $ } from "./dom.js";
import { mode, set_mode } from "./pointer.js";
import { viewer } from "./viewer.js";

/** The pixels of the screen that the pointer went through. @type {any[]} */
let drawn = [];
const painting = () => mode === "brush" || mode === "gradient" || mode === "draw";
/** Between the first place and the last, in pixels of the screen. */
function drawn_area() {
  const [a, b] = [drawn[0], drawn[drawn.length - 1]];
  let w = Math.abs(b.x - a.x), h = Math.abs(b.y - a.y);
  if ($("in-shape").checked) {
    const shape = $("paper-width").value / $("paper-height").value;
    w = Math.max(w, h * shape);
    h = w / shape;
  }
  return new OpenSeadragon.Rect(b.x < a.x ? a.x - w : a.x, b.y < a.y ? a.y - h : a.y, w, h);
}
function outline() {
  if (mode !== "draw" || drawn.length < 2) return drawn;
  const area = drawn_area(), corners = [area.getTopLeft(), area.getTopRight(), area.getBottomRight(), area.getBottomLeft()];
  return [...corners, corners[0]];
}
function show_stroke() {
  const brush = mode === "brush", origin = viewer.viewport.pixelFromPoint(new OpenSeadragon.Point(0, 0), true);
  const one = viewer.viewport.pixelFromPoint(new OpenSeadragon.Point(1, 0), true).x - origin.x;
  const line = $("stroke").firstElementChild, points = drawn.length === 1 ? [drawn[0], drawn[0]] : outline();
  $("stroke").toggleAttribute("hidden", drawn.length === 0);
  line.setAttribute("points", points.map((p) => `${p.x},${p.y}`).join(" "));
  line.setAttribute("stroke-width", String(brush ? 2 * Number($("dodge-radius").value) * longer() * one : 2));
}
viewer.addHandler("canvas-press", (/** @type {any} */ event) => {
  if (!painting()) return;
  drawn = [event.position];
  show_stroke();
});
viewer.addHandler("canvas-drag", (/** @type {any} */ event) => {
  if (!painting() || drawn.length === 0) return;
  event.preventDefaultAction = true;
  const least = 8; // pixels of the screen between two places of a line
  if (mode !== "brush") drawn = [drawn[0], event.position];
  else if (event.position.distanceTo(drawn[drawn.length - 1]) >= least) drawn.push(event.position);
  show_stroke();
});
viewer.addHandler("canvas-drag-end", (/** @type {any} */ event) => { if (painting()) event.preventDefaultAction = true; });
viewer.addHandler("canvas-release", () => {
  const line = drawn, area = line.length > 1 ? drawn_area() : undefined;
  drawn = [];
  show_stroke();
  if (!painting() || line.length === 0 || (mode !== "brush" && !area)) return;
  if (mode === "draw") {
    const chosen = viewer.viewport.viewerElementToViewportRectangle(area);
    set_mode("");
    return $("in-shape").checked ? crop_to_paper(chosen) : crop_to(chosen);
  }
  add_dodge(mode === "brush" ? mode : "gradient", line.map((p) => viewer.viewport.pointFromPixel(p, true)));
});
