// Rulers along the picture, from the corner of the crop.
// @ts-check
/* global OpenSeadragon */
import { crop } from "./crop.js";
import { $ } from "./dom.js";
import { get, shows } from "./recipe.js";
import { draw_ruler } from "./ruler.js";
import { print_width, viewer } from "./viewer.js";

function show_rulers() {
  const main = /** @type {HTMLElement} */ ($("picture").parentElement), dpi = get("convert", "dpi"), width = print_width();
  main.classList.toggle("ruled", $("rulers").checked);
  if (!$("rulers").checked) return;
  const origin = viewer.viewport.pixelFromPoint(new OpenSeadragon.Point(0, 0), true);
  const pixel = (viewer.viewport.pixelFromPoint(new OpenSeadragon.Point(1, 0), true).x - origin.x) / width, unit = dpi ? pixel * dpi / 25.4 : pixel;
  const [x0, y0, x1, y1] = crop().map((n) => n * pixel);
  draw_ruler($("ruler-across"), "across", { length: $("picture").clientWidth, zero: origin.x + x0, unit, from: origin.x + x0, to: origin.x + x1 });
  draw_ruler($("ruler-down"), "down", { length: $("picture").clientHeight, zero: origin.y + y0, unit, from: origin.y + y0, to: origin.y + y1 });
  $("ruler-unit").textContent = dpi ? "mm" : "px";
}
$("rulers").addEventListener("change", show_rulers);
viewer.addHandler("update-viewport", show_rulers);
viewer.addHandler("resize", show_rulers);
shows.push(show_rulers);
