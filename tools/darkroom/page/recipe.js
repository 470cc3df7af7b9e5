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
/** The same for all recipes whose lights differ in how bright they are alone. @param {Recipe} asked */
export function colours_of(asked) {
  const colours = [asked.develop?.light ?? []].flat().map((text) => {
    const at = text.lastIndexOf("=") + 1, parts = text.slice(at).split(",").filter((/** @type {string} */ part) => !Number.isFinite(Number(part)));
    return parts.length > 0 ? text.slice(0, at) + parts : "";
  });
  return light_of({ ...asked, develop: { ...asked.develop, light: undefined } }) + colours.filter(Boolean).join(" ");
}

/** Controls, which show what the recipe has. @type {(() => void)[]} */
export const shows = [];
export const show_controls = () => shows.forEach((show) => show());

// Changes belong to one decision while a slider is moved.
let gesture = 0;
for (const end of ["change", "click", "keyup", "pointerup"]) document.addEventListener(end, () => { ++gesture; }, true);
/** The decision that made the recipe. */
export let decision = 0;

/** What else is to be done when it has changed. @type {() => void} */
let then = () => {};
/** @param {() => void} update */
export const when_changed = (update) => { then = update; };
export function changed() {
  decision = gesture;
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
