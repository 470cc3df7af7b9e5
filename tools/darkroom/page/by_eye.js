// Choices by eye: the print in view, small and of few samples, with each of them.
// @ts-check
import { $, carefully } from "./dom.js";
import { choose_film, on_film } from "./film.js";
import { change_to, recipe } from "./recipe.js";
import { load_recipe, read_recipe } from "./saved.js";
import { ask, state } from "./server.js";
import { at_stage } from "./stages.js";
import { height_of } from "./viewer.js";

/** @typedef {import("./recipe.js").Recipe} Recipe */

let sheet = 0; // the last that was opened
/** @param {string} title @param {{name: string, what?: string, recipe: () => Promise<Recipe>, take: () => void}[]} choices */
async function show_sheet(title, choices) {
  const mine = ++sheet, width = 240, share = Math.min(1, Number((3e5 / state.samples).toPrecision(3)));
  $("sheet-title").textContent = title;
  $("find").value = "";
  const buttons = choices.map((choice) => {
    const button = document.createElement("button");
    button.append(Object.assign(document.createElement("img"), { alt: "", width, height: height_of(width) }), choice.name, ...(choice.what ? [document.createElement("br"), Object.assign(document.createElement("small"), { textContent: choice.what })] : []));
    button.addEventListener("click", () => { $("sheet").close(); choice.take(); });
    return button;
  });
  $("thumbnails").replaceChildren(...buttons);
  $("sheet").showModal();
  const waiting = new Set(choices.keys());
  while (waiting.size > 0 && sheet === mine && $("sheet").open) {
    const i = [...waiting].find((n) => !buttons[n].hidden) ?? [...waiting][0], choice = choices[i];
    waiting.delete(i);
    try {
      const whole = await choice.recipe(), develop = { ...whole.develop };
      delete develop.size;
      delete develop.crop;
      const made = await ask("views", { method: "POST", body: JSON.stringify(at_stage({ ...whole, develop }, { share, mixed: false })) });
      const image = /** @type {HTMLImageElement} */ (buttons[i].firstChild);
      image.src = new URL(`api/tile?view=${made.view}&width=${width}&area=0,0,${width},${height_of(width)}`, location.href).href;
      image.alt = `The print with ${choice.name}`;
      await image.decode();
    } catch (error) {
      buttons[i].title = String(/** @type {any} */ (error).message);
      buttons[i].append(document.createElement("br"), Object.assign(document.createElement("small"), { textContent: buttons[i].title }));
    }
  }
}
$("find").addEventListener("input", () => {
  const words = $("find").value.toLowerCase().split(/\s+/);
  for (const button of $("thumbnails").children) button.hidden = !words.every((/** @type {string} */ word) => button.textContent.toLowerCase().includes(word));
});
$("eye-filters").addEventListener("click", () => show_sheet("Filters in front of the lens", state.lens_filters.map((/** @type {string} */ name) => {
  const behind = () => ({ ...recipe, develop: { ...recipe.develop, "lens-filter": name } });
  return { name, recipe: async () => behind(), take: () => change_to(behind()) };
})));
$("eye-films").addEventListener("click", () => show_sheet("Films, scanned, and looks of film and paper", [
  ...state.looks.map((/** @type {any} */ l) => ({ name: l.name, what: `${l.film}: ${l.what}`, recipe: async () => on_film(recipe, { film: l.film, look: l.name }), take: () => choose_film({ film: l.film, look: l.name }) })),
  ...state.films.map((/** @type {any} */ f) => ({ name: f.name, what: f.what, recipe: async () => on_film(recipe, { film: f.name, paper: "scan" }), take: () => choose_film({ film: f.name, paper: "scan" }) })),
]));
$("eye-observers").addEventListener("click", () => show_sheet("Observers, cameras and black-and-white films", state.observers.map((/** @type {any} */ o) => {
  const seen_by = () => { const from = on_film(recipe, {}); return { ...from, develop: { ...from.develop, observer: o.name } }; };
  return { name: o.name, what: o.what, recipe: async () => seen_by(), take: () => change_to(seen_by()) };
})));
$("eye-recipes").addEventListener("click", carefully(async () => show_sheet("Saved recipes", (await ask("recipes")).map((/** @type {string} */ name) => (
  { name, recipe: () => read_recipe(name), take: () => load_recipe(name) })))));
