// The numbers and the spectrum of a place; a neutral that is picked there, or the focus.
// @ts-check
/* global OpenSeadragon */
import { $, carefully, show_error } from "./dom.js";
import { plot_spectrum, short } from "./plot.js";
import { measures, view } from "./picture.js";
import { mode, set_mode } from "./pointer.js";
import { changed, put } from "./recipe.js";
import { ask, in_turn, state } from "./server.js";
import { height_of, inside, print_width, viewer } from "./viewer.js";

/** What is probed: a place in widths of the picture. @type {{x: number, y: number} | undefined} */
let probed;
let probed_view = ""; // of the numbers that are shown
const kBins = 47;     // of the spectrum: 10 nm
/** The pixel of a place, in the picture whose pixels are `side` times as wide as those of the print.
 * @param {{x: number, y: number}} place @param {number} side */
function pixel_at(place, side) {
  const w = Math.max(1, Math.ceil(print_width() / side)), x = inside(place.x, w), y = inside(place.y, height_of(w), w);
  return { x, y, pixel: print_width() / w, at: `view=${view}&width=${w}&x=${x}&y=${y}&${in_turn(false)}` };
}
/** The numbers of the print there, or of a square of its pixels as one. */
async function probe() {
  if (!probed || !view) return;
  const side = Number($("probe-side").value), { x, y, pixel, at } = pixel_at(probed, side), digits = (/** @type {number} */ v) => v.toPrecision(4);
  probed_view = view;
  const p = await ask(`probe?${at}`);
  $("probed").textContent = `${side > 1 ? `${pixel.toFixed(1)} × ${pixel.toFixed(1)} pixels from` : "pixel"} ${Math.round(x * pixel)}, ${Math.round(y * pixel)}: ${Math.round(p.samples)} samples\n` +
    (p.xy ? ["X", "Y", "Z"] : ["R", "G", "B"]).map((c, i) => `${c} ${digits(p.values[i])} ± ${digits(p.standard_errors[i])}${p.values[i] > 0 ? ` (${short(100 * p.standard_errors[i] / p.values[i], 2)} %)` : ""}`).join("\n") +
    (p.xy ? `\nx, y ${p.xy.map((/** @type {number} */ v) => v.toFixed(4)).join(", ")}` : `\nof ${p.observer}`) + `\nRGB ${p.rgb.join(", ")}`;
  if (state.spectral) show_spectrum(await ask(`spectrum?${at}&bins=${kBins}`));
}
/** What is there becomes neutral: as much of it as the mark covers. @param {{x: number, y: number}} place */
async function pick_neutral(place) {
  if (!view) return;
  const mark = 15; // pixels of the screen: #mark in page.css
  const side = Math.max(1, mark * print_width() / (viewer.viewport.getZoom(true) * $("picture").clientWidth));
  const p = await ask(`probe?${pixel_at(place, side).at}`);
  if (!p.xy) throw new Error("a neutral can be picked of cie1931 alone");
  put("convert", "white", p.xy.map((/** @type {number} */ v) => v.toFixed(4)).join(","));
  set_mode("");
  changed();
}
/** @param {any} spectrum */
function show_spectrum(spectrum) {
  plot_spectrum($("plot"), spectrum);
  const { values, standard_errors, from_nm, to_nm } = spectrum, peak = values.indexOf(Math.max(...values)), nm = (to_nm - from_nm) / values.length;
  const share = 100 * Math.sqrt(standard_errors.reduce((/** @type {number} */ s, /** @type {number} */ e) => s + e * e, 0) / values.reduce((/** @type {number} */ s, /** @type {number} */ v) => s + v * v, 1e-300));
  const text = `most at ${Math.round(from_nm + (peak + 0.5) * nm)} nm: ${short(values[peak], 3)} ± ${short(standard_errors[peak], 2)} W/(m² sr nm); in steps of ${nm} nm, ± ${short(share, 2)} %`;
  $("plot").setAttribute("aria-label", `Spectrum of the light, ${text}`);
  $("spectrum").hidden = false;
  $("spectrum").lastElementChild.textContent = text;
}
/** Numbers never stay from another print. */
async function probe_again() {
  if (!probed || probed_view === view) return;
  try { await probe(); } catch (error) { show_error(error); }
}
$("probe-side").addEventListener("change", () => { probed_view = ""; probe_again(); });
measures.push(probe_again);

/** @param {any} position pixels of the screen */
export async function use_pointer(position) {
  if ((mode !== "probe" && mode !== "pick" && mode !== "focus-here") || !view) return;
  const point = viewer.viewport.pointFromPixel(position);
  if (point.x < 0 || point.y < 0 || point.x >= 1 || point.y >= state.aspect[1] / state.aspect[0]) return;
  if (mode === "focus-here") return focus_on(point);
  if (mode === "pick") return carefully(() => pick_neutral(point))();
  probed = { x: point.x, y: point.y };
  const old = $("mark");
  if (old) viewer.removeOverlay(old);
  viewer.addOverlay({ element: Object.assign(document.createElement("div"), { id: "mark" }), location: point, placement: OpenSeadragon.Placement.CENTER });
  await carefully(probe)();
}
viewer.addHandler("canvas-click", (/** @type {any} */ event) => { if (event.quick) use_pointer(event.position); });

/** @param {{x: number, y: number}} point in widths of the picture */
async function focus_on(point) {
  const w = print_width();
  try {
    const { distance } = await ask(`distance?width=${w}&x=${inside(point.x, w)}&y=${inside(point.y, height_of(w), w)}`);
    put("develop", "focus", typeof distance === "number" ? Number(distance.toPrecision(4)) : distance);
    set_mode("");
    changed();
  } catch (error) {
    show_error(error);
  }
}
