// Observer, film and paper: the exposures of a film need a paper, which decides much of the rest.
// @ts-check
import { bind } from "./bind.js";
import { $, signed } from "./dom.js";
import { change_to, get, recipe, shows } from "./recipe.js";
import { state } from "./server.js";

/** @typedef {import("./recipe.js").Recipe} Recipe */
/** @typedef {import("./recipe.js").Section} Section */

bind("observer", "develop", "observer", "");
bind("filter", "develop", "lens-filter", "");
bind("enlarger", "convert", "print-exposure", 0, signed);
bind("grain", "convert", "grain", false);

/** What a recipe on this film has, on this paper or with this look. @param {Recipe} from @param {{film?: string, paper?: string, look?: string}} chosen @returns {Recipe} */
export function on_film(from, { film, paper, look }) {
  /** @type {Section} */
  const develop = { ...from.develop, film };
  /** @type {Section} */
  const convert = { ...from.convert, paper, look };
  for (const key of ["observer", "camera-output", "raw-balance"]) delete develop[key];
  for (const key of ["white", "sensitivity", "print-exposure", "grain"]) delete convert[key];
  if (film && paper !== "scan") for (const key of ["tone", "contrast", "black"]) delete convert[key];
  for (const section of [develop, convert]) for (const key of Object.keys(section)) if (!section[key]) delete section[key];
  return { ...from, develop, convert };
}
/** @param {{film?: string, paper?: string, look?: string}} chosen */
export function choose_film(chosen) {
  change_to(on_film(recipe, chosen));
}
for (const [id, entries] of /** @type {[string, any[]][]} */ ([["film", state.films], ["look", state.looks],
  ["paper", [{ name: "scan", what: "scanned, without paper" }, { name: "light-table", what: "" }, { name: "projection", what: "" }, ...state.papers]]]))
  for (const entry of entries) $(id).append(Object.assign(new Option(entry.name), { title: entry.what }));
const film_of_look = (/** @type {string} */ look) => state.looks.find((/** @type {any} */ l) => l.name === look)?.film;
$("film").addEventListener("change", () => choose_film({ film: $("film").value, paper: $("film").value && ($("paper").value || "scan") }));
$("paper").addEventListener("change", () => choose_film({ film: $("paper").value && ($("film").value || "portra-400"), paper: $("paper").value }));
$("look").addEventListener("change", () => choose_film({ film: film_of_look($("look").value), look: $("look").value }));
shows.push(() => {
  const film = get("develop", "film"), paper = get("convert", "paper"), look = get("convert", "look");
  $("film").value = film ?? "", $("paper").value = paper ?? "", $("look").value = look ?? "";
  $("on-film").hidden = !film;
  for (const part of document.querySelectorAll(".plain"))
    for (const control of /** @type {NodeListOf<HTMLInputElement>} */ (part.querySelectorAll("input, select, button")))
      control.disabled = Boolean(film) && !(paper === "scan" && control.closest("details")?.contains($("tone")));
});

$("seen").hidden = !state.spectral;
for (const o of state.observers) $("observers").append(Object.assign(document.createElement("option"), { value: o.name, label: o.what }));
for (const f of state.lens_filters) $("filters").append(Object.assign(document.createElement("option"), { value: f }));
