// The histogram of the print, and how much of it is clipped.
// @ts-check
import { $ } from "./dom.js";
import { ask, in_turn } from "./server.js";
import { height_of, seen_width } from "./viewer.js";

/** @param {string} id @param {boolean} mixed */
export async function show_histogram(id, mixed) {
  let width = seen_width(); // what is developed already, but no more than there is a histogram of
  while (Math.max(width, height_of(width)) > 2048) width = Math.ceil(width / 2);
  const h = await ask(`histogram?view=${id}&width=${width}&${in_turn(mixed)}`);
  const canvas = $("histogram"), context = canvas.getContext("2d");
  context.clearRect(0, 0, canvas.width, canvas.height);
  context.globalCompositeOperation = "lighter";
  const most = Math.max(...[h.red, h.green, h.blue].flatMap((counts) => counts.slice(1, 255)), 1);
  for (const [counts, colour] of [[h.red, "#c33"], [h.green, "#3a3"], [h.blue, "#44d"]]) {
    context.fillStyle = colour;
    for (let i = 0; i < 256; ++i) {
      const bar = Math.min(1, Math.sqrt(counts[i] / most)) * canvas.height;
      context.fillRect(i * canvas.width / 256, canvas.height - bar, canvas.width / 256, bar);
    }
  }
  const share = (/** @type {number} */ n) => `${(100 * n / Math.max(1, h.pixels)).toFixed(1)} %`;
  $("clipping").replaceChildren();
  for (const [name, count, colour] of [["burnt", h.burnt, "#f00"], ["black", h.black, "#00f"], ["out of gamut", h.out_of_gamut, "#f0f"]]) {
    const swatch = document.createElement("i");
    swatch.style.background = colour;
    $("clipping").append(swatch, `${name} ${share(count)} `);
  }
}
