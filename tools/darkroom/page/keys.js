// Keys for what is done most, and buttons around the picture.
// @ts-check
import { compare } from "./compare.js";
import { $ } from "./dom.js";
import { redo, undo } from "./history.js";
import { forget_view } from "./picture.js";
import { set_mode } from "./pointer.js";
import { use_pointer } from "./probe.js";
import { change_to, changed, get, put } from "./recipe.js";
import { print_width, viewer } from "./viewer.js";

$("reset").addEventListener("click", () => { forget_view(); change_to({ "latent-recipe": 1 }); });
$("fit").addEventListener("click", () => viewer.viewport.goHome());
$("one").addEventListener("click", () => viewer.viewport.zoomTo(print_width() / $("picture").clientWidth / devicePixelRatio));
$("help").addEventListener("click", () => $("keys").showModal());
const surround = () => {
  const grey = Math.round(2.55 * $("surround").value);
  document.documentElement.style.setProperty("--surround", `rgb(${grey}, ${grey}, ${grey})`);
};
$("surround").addEventListener("input", surround);
surround();
document.addEventListener("keydown", (event) => {
  const typing = event.target instanceof HTMLInputElement && !["range", "checkbox"].includes(event.target.type);
  if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z" && !typing) {
    event.preventDefault();
    return event.shiftKey ? redo() : undo();
  }
  if (typing || event.ctrlKey || event.metaKey || event.altKey) return;
  const third = (/** @type {number} */ sign) => {
    put("convert", "stops", Number((Number(get("convert", "stops") ?? 0) + sign / 3).toFixed(2)) || undefined);
    changed();
  };
  /** @type {{[key: string]: () => void}} */
  const keys = {
    "?": () => $("keys").showModal(), ",": () => third(-1), ".": () => third(1), f: () => viewer.viewport.goHome(), 1: () => $("one").click(),
    c: compare, s: () => $("halves").click(), n: () => $("noise").click(), b: () => $("clipped").click(), r: () => $("rulers").click(), x: () => set_mode("draw"), d: () => set_mode("brush"), p: () => set_mode("probe"),
    Enter: () => { if (event.target === viewer.canvas || event.target === document.body) use_pointer(viewer.viewport.pixelFromPoint(viewer.viewport.getCenter())); }, Escape: () => set_mode(""),
  };
  keys[event.key]?.();
});
