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

// The aperture: "f:8,blades:6", and what else a recipe says of it.
const aperture_parts = () => String(get("develop", "aperture") ?? "").split(",").filter(Boolean);
for (const [id, prefix] of [["aperture", "f:"], ["blades", "blades:"]]) {
  $(id).addEventListener("change", () => {
    const others = aperture_parts().filter((part) => !part.startsWith(prefix) && !(id === "aperture" && Number.isFinite(Number(part))));
    put("develop", "aperture", [...others, ...$(id).value ? [prefix + $(id).value] : []].join(","));
    changed();
  });
  shows.push(() => { $(id).value = aperture_parts().find((part) => part.startsWith(prefix))?.slice(prefix.length) ?? ""; });
}

$("lens").hidden = state.f_number === null;
$("focus-here").hidden = !state.depth;
$("exposing").hidden = !state.shutter;
$("follows").hidden = state.f_number === null && !state.shutter;
if (state.f_number !== null) Object.assign($("aperture"), { placeholder: state.f_number.toFixed(1), min: state.f_number.toFixed(1) });
