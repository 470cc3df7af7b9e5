// What the pointer does in the picture.
// @ts-check
import { $ } from "./dom.js";

/** @typedef {"" | "probe" | "pick" | "focus-here" | "brush" | "gradient" | "draw"} Mode */
/** @type {Mode} */
export let mode = "";
/** @type {Mode[]} */
const modes = ["probe", "pick", "focus-here", "brush", "gradient", "draw"];
/** @param {Mode} next */
export function set_mode(next) {
  mode = mode === next ? "" : next;
  if (mode) $(mode).closest("details").open = true;
  for (const id of modes) $(id).setAttribute("aria-pressed", String(mode === id));
  $("picture").style.cursor = mode ? "crosshair" : "";
}
for (const id of modes) $(id).addEventListener("click", () => set_mode(id));
