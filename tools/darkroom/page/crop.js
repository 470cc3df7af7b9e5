// Size, crop and paper, in pixels of the print.
// @ts-check
import { bind } from "./bind.js";
import { $ } from "./dom.js";
import { forget_view } from "./picture.js";
import { changed, get, put, shows } from "./recipe.js";
import { state } from "./server.js";
import { height_of, lay_over, print_width, take_off, viewer } from "./viewer.js";

bind("size", "develop", "size", state.width);
bind("crop", "develop", "crop", "");
bind("dpi", "convert", "dpi", "");

export function crop() {
  const numbers = String(get("develop", "crop") ?? "").split(",").map(Number), width = print_width();
  return numbers.length === 4 ? numbers : [0, 0, width, height_of(width)];
}
function show_crop() {
  take_off("crop-cover");
  if (!get("develop", "crop") || viewer.world.getItemCount() === 0) return;
  const [x0, y0, x1, y1] = crop(), width = print_width();
  lay_over("crop-cover", "div", { id: "frame" }, [x0 / width, y0 / width, x1 / width, y1 / width]);
}
/** @param {any} area OpenSeadragon.Rect in widths of the picture */
export function crop_to(area) {
  const w = print_width(), h = height_of(w);
  const edge = (/** @type {number} */ v, /** @type {number} */ most) => Math.round(Math.min(Math.max(v * w, 0), most));
  const wanted = [edge(area.x, w), edge(area.y, h), edge(area.x + area.width, w), edge(area.y + area.height, h)];
  if (wanted[0] < wanted[2] && wanted[1] < wanted[3]) put("develop", "crop", wanted.join(","));
  changed();
}
$("cut").addEventListener("click", () => crop_to(viewer.viewport.getBounds(true)));
$("uncut").addEventListener("click", () => { put("develop", "crop", undefined); changed(); });

/** The shape of the paper, as large as fits into the area, gets the pixels that the paper has: so the width of the whole picture follows.
 * @param {any} area OpenSeadragon.Rect in widths of the picture */
export function crop_to_paper(area) {
  const dpi = Number($("dpi").value || $("dpi").placeholder), [across, down] = [$("paper-width"), $("paper-height")].map((side) => Math.round(Number(side.value) / 2.54 * dpi));
  if (!(dpi > 0 && across > 0 && down > 0)) return;
  const top = 1 / (state.aspect[0] / state.aspect[1]);
  const x0 = Math.max(area.x, 0), y0 = Math.max(area.y, 0);
  const w = Math.min(area.x + area.width, 1) - x0, h = Math.min(area.y + area.height, top) - y0;
  if (!(w > 0 && h > 0)) return;
  const part = Math.min(w, h * across / down);  // of the picture's width
  const width = Math.ceil(across / part), height = height_of(width);
  const left = Math.round(Math.min((x0 + (w - part) / 2) * width, width - across)), upper = Math.round(Math.min((y0 + (h - part * down / across) / 2) * width, height - down));
  put("develop", "size", width);
  put("develop", "crop", [Math.max(left, 0), Math.max(upper, 0), Math.max(left, 0) + across, Math.max(upper, 0) + Math.min(down, height)].join(","));
  put("convert", "dpi", dpi);
  forget_view();
  changed();
}
$("to-paper").addEventListener("click", () => crop_to_paper(viewer.viewport.getBounds(true)));
shows.push(show_crop);
shows.push(() => {
  const dpi = get("convert", "dpi"), width = print_width(), [x0, y0, x1, y1] = crop();
  const cm = (/** @type {number} */ pixels) => (pixels / dpi * 2.54).toFixed(1);
  $("on-paper").textContent = `${x1 - x0} × ${y1 - y0} px${dpi ? `, ${cm(x1 - x0)} × ${cm(y1 - y0)} cm` : ""}, ${(state.samples / (width * height_of(width))).toPrecision(3)} samples each`;
});

$("size").addEventListener("change", () => { put("develop", "crop", undefined); forget_view(); });
