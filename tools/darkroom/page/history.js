// The recipes that were shown, to go back to.
// @ts-check
import { $ } from "./dom.js";
import { settings_of, text_of } from "./lights.js";
import { change_to, decision, set_recipe, show_controls, shows } from "./recipe.js";

/** @typedef {import("./recipe.js").Recipe} Recipe */

/** @type {string[]} */
let history = [];
let place = -1; // in the history

let kept_of = -1; // the decision that the last one is of

/** @param {Recipe} asked what was decided @param {Recipe} made what the server made of it: with its exposure as a number */
export function keep(asked, made) {
  set_recipe(made);
  const text = JSON.stringify(made), last = place === history.length - 1;
  if (history[place] === JSON.stringify(asked) || (last && kept_of === decision)) {
    history[place] = text;
  } else if (history[place] !== text) {
    history = [...history.slice(0, place + 1), text].slice(-500);
    place = history.length - 1;
  }
  kept_of = place > 0 ? decision : -1;
  if (text === JSON.stringify(asked)) show_place();
  else show_controls();
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
    .flatMap((key) => key === "light" ? change_of_lights(to, from) : `${key} ${to[section]?.[key] ?? "by default"}`)).join(", ");
}
/** @param {Recipe} to @param {Recipe} from */
function change_of_lights(to, from) {
  const was = new Map(settings_of(from).map((light) => [light.name, text_of(light)]));
  return settings_of(to).filter((light) => text_of(light) !== was.get(light.name)).map((light) => `${light.name} ${text_of(light)}`);
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
function show_place() {
  show_history();
  $("undo").disabled = place < 1;
  $("redo").disabled = place > history.length - 2;
}
shows.push(show_place);
