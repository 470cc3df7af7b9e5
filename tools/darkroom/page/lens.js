// What is before the film, and noise.
// @ts-check
import { bind } from "./bind.js";
import { $ } from "./dom.js";
import { changed, get, put, shows } from "./recipe.js";
import { state } from "./server.js";

bind("denoise", "develop", "denoise", 0, (v) => v.toFixed(2));
bind("fireflies", "develop", "dim-fireflies", false);
bind("glare", "convert", "glare", "");
bind("shutter", "develop", "shutter", "");
bind("exposure-follows", "develop", "exposure-follows", false);
bind("focus", "develop", "focus", "");

// The aperture: "f:8,blades:6,gaussian", and what else a recipe says of it.
const aperture_parts = () => String(get("develop", "aperture") ?? "").split(",").filter(Boolean);
/** @param {(part: string) => boolean} old @param {string} part that takes the place of `old`; "": none does */
function put_aperture(old, part) {
  put("develop", "aperture", [...aperture_parts().filter((other) => !old(other)), part].filter(Boolean).join(","));
  changed();
}
for (const [id, prefix] of [["aperture", "f:"], ["blades", "blades:"], ["anamorphic", "anamorphic:"], ["cat-eye", "cat-eye:"]]) {
  const is_old = (/** @type {string} */ part) => part.startsWith(prefix) || (id === "aperture" && Number.isFinite(Number(part)));
  $(id).addEventListener("change", () => put_aperture(is_old, $(id).value && prefix + $(id).value));
  shows.push(() => { $(id).value = aperture_parts().find((part) => part.startsWith(prefix))?.slice(prefix.length) ?? ""; });
}
const is_gaussian = (/** @type {string} */ part) => part === "gaussian";
$("gaussian").addEventListener("change", () => put_aperture(is_gaussian, $("gaussian").checked ? "gaussian" : ""));
shows.push(() => { $("gaussian").checked = aperture_parts().some(is_gaussian); });

$("lens").hidden = state.f_number === null;
$("focus-here").hidden = !state.depth;
$("exposing").hidden = !state.shutter;
$("follows").hidden = state.f_number === null && !state.shutter;
if (state.f_number !== null) Object.assign($("aperture"), { placeholder: state.f_number.toFixed(1), min: state.f_number.toFixed(1) });
