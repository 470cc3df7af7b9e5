// The recipes that were shown, to go back to.
// @ts-check
import { $ } from "./dom.js";
import { change_to, set_recipe, show_controls, shows } from "./recipe.js";

/** @typedef {import("./recipe.js").Recipe} Recipe */

/** @type {string[]} */
let history = [];
let place = -1; // in the history

/** @param {Recipe} made what the server made of the recipe: with its exposure as a number */
export function keep(made) {
  set_recipe(made);
  const text = JSON.stringify(made);
  if (history[place] !== text) {
    history = [...history.slice(0, place + 1), text].slice(-500);
    place = history.length - 1;
  }
  show_controls();
}
/** @param {number} to */
function go(to) {
  if (to < 0 || to >= history.length) return;
  place = to;
  change_to(JSON.parse(history[place]));
}

/** What a recipe changed, in few words. @param {string} text @param {string | undefined} before */
function change_of(text, before) {
  if (!before) return "the beginning";
  const [to, from] = [JSON.parse(text), JSON.parse(before)];
  return ["develop", "convert"].flatMap((section) => Object.keys({ ...from[section], ...to[section] })
    .filter((key) => JSON.stringify(to[section]?.[key]) !== JSON.stringify(from[section]?.[key]))
    .map((key) => `${key} ${to[section]?.[key] ?? "as by default"}`)).join(", ");
}
const kListed = 30; // of the history
function show_history() {
  const first = Math.max(0, history.length - kListed);
  $("history").replaceChildren(...history.slice(first).map((text, i) => {
    const line = document.createElement("li"), what = change_of(text, history[first + i - 1]);
    const button = line.appendChild(Object.assign(document.createElement("button"), { textContent: what, title: what }));
    if (first + i === place) button.setAttribute("aria-current", "step");
    button.addEventListener("click", () => go(first + i));
    return line;
  }).reverse());
}

export const undo = () => go(place - 1);
export const redo = () => go(place + 1);
$("undo").addEventListener("click", undo);
$("redo").addEventListener("click", redo);
shows.push(() => {
  show_history();
  $("undo").disabled = place < 1;
  $("redo").disabled = place > history.length - 2;
});
