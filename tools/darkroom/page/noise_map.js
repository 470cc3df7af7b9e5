// Noise: the standard error of Y in areas of the print, over it.
// @ts-check
import { $, show_error } from "./dom.js";
import { measures, view } from "./picture.js";
import { get, light_of, recipe } from "./recipe.js";
import { ask, in_turn, state } from "./server.js";
import { height_of, lay_over, print_width, take_off } from "./viewer.js";

const kNoise = [{ from: 0.01, colour: "#4575b4" }, { from: 0.02, colour: "#91bfdb" }, { from: 0.05, colour: "#fee090" }, { from: 0.1, colour: "#fc8d59" }, { from: 0.2, colour: "#d73027" }, { from: 0.5, colour: "#7a0177" }];
const percent = (/** @type {number} */ v) => `${Number((100 * v).toPrecision(2))}\u00a0%`;
let noisy_light = ""; // that the map is of
function hide_noise() {
  take_off("noise-cover");
  $("noise-told").replaceChildren();
  noisy_light = "";
}
async function show_noise() {
  const light = `${light_of(recipe)} ${state.samples}`;
  if (!$("noise").checked) return hide_noise();
  if (!view || light === noisy_light) return;
  if (!noisy_light) $("noise-told").textContent = "measuring …";
  let width = print_width();
  while (Math.max(width, height_of(width)) > 2048) width = Math.ceil(width / 2);
  try {
    const map = await ask(`noise?view=${view}&width=${width}&${in_turn(false)}`), finer = print_width() / width; // pixels have fewer samples
    if (!$("noise").checked) return;
    hide_noise();
    noisy_light = light;
    const canvas = lay_over("noise-cover", "canvas", { id: "noise-map", width: map.columns, height: map.rows }, [0, 0, map.columns * map.side / width, map.rows * map.side / width]);
    const context = canvas.getContext("2d");
    map.relative.forEach((/** @type {number | null} */ relative, /** @type {number} */ i) => {
      const level = kNoise.findLast(({ from }) => (relative ?? 0) * finer >= from);
      if (!level) return;
      context.fillStyle = level.colour;
      context.fillRect(i % map.columns, Math.floor(i / map.columns), 1, 1);
    });
    $("noise-told").append(`Noise of a pixel (standard error): half above ${percent(map.median * finer)}, 5 % above ${percent(map.p95 * finer)}. Marked: `);
    for (const { from, colour } of kNoise) {
      const swatch = document.createElement("i");
      swatch.style.background = colour;
      $("noise-told").append(swatch, `from ${percent(from)}`);
    }
    if (get("develop", "denoise")) $("noise-told").append(" Before it is removed.");
    if (finer > 1) $("noise-told").append(` (from pixels ${finer.toPrecision(2)} times as wide)`);
  } catch (error) {
    show_error(error);
  }
}
$("noise").addEventListener("change", show_noise);
measures.push(show_noise);
