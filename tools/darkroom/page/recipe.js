// The recipe that the page shows and keeps. Every control reads its value from there and writes it back.
// @ts-check

/** @typedef {{[key: string]: any}} Section */
/** @typedef {{"latent-recipe": number, develop?: Section, convert?: Section}} Recipe */

/** @type {Recipe} */
export let recipe = { "latent-recipe": 1 };

/** The value of a key; undefined: as by default. @param {"develop" | "convert"} section @param {string} key */
export const get = (section, key) => recipe[section]?.[key];
/** @param {"develop" | "convert"} section @param {string} key @param {any} value */
export function put(section, key, value) {
  const values = { ...recipe[section] };
  if (value === undefined || value === "") delete values[key];
  else values[key] = value;
  recipe = { ...recipe, [section]: values };
}

/** @param {Recipe} asked */
export const light_of = (asked) => JSON.stringify(asked.develop ?? {});
/** @param {Recipe} asked */
export const without_lights = (asked) => light_of({ ...asked, develop: { ...asked.develop, light: undefined } });

/** Controls, which show what the recipe has. @type {(() => void)[]} */
export const shows = [];
export const show_controls = () => shows.forEach((show) => show());

/** What else is to be done when it has changed. @type {() => void} */
let then = () => {};
/** @param {() => void} update */
export const when_changed = (update) => { then = update; };
export function changed() {
  show_controls();
  then();
}
/** @param {Recipe} next */
export const set_recipe = (next) => { recipe = next; };
/** @param {Recipe} next */
export function change_to(next) {
  recipe = next;
  changed();
}
