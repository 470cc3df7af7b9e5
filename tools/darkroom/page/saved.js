// Recipes that are kept in the folder of the server.
// @ts-check
import { $, carefully } from "./dom.js";
import { forget_view } from "./picture.js";
import { change_to, recipe } from "./recipe.js";
import { ask, state } from "./server.js";

export const read_recipe = (/** @type {string} */ name) => ask(`recipes/${encodeURIComponent(name)}`);
export async function load_recipe(/** @type {string} */ name) {
  const read = await read_recipe(name);
  $("name").value = name;
  $("recipes").value = name;
  show_names();
  forget_view();
  change_to(read);
}

/** @param {string[]} names @param {string} loaded */
function list_recipes(names, loaded) {
  $("recipes").replaceChildren(new Option(""), ...names.map((name) => new Option(name)));
  $("recipes").value = loaded;
  show_names();
}
function show_names() {
  const loaded = $("recipes").value;
  $("rename").disabled = !loaded || $("name").value === loaded;
  $("duplicate").disabled = !loaded;
}
$("name").addEventListener("input", show_names);
list_recipes(state.recipes, "");
/** @param {string} name @param {RequestInit} how @param {string} loaded */
async function change_recipe(name, how, loaded) {
  await ask(`recipes/${encodeURIComponent(name)}`, how);
  $("name").value = loaded;
  list_recipes(await ask("recipes"), loaded);
}
$("save").addEventListener("click", carefully(() => change_recipe($("name").value, { method: "PUT", body: JSON.stringify(recipe) }, $("name").value)));
$("rename").addEventListener("click", carefully(() => change_recipe($("recipes").value, { method: "POST", body: JSON.stringify({ rename: $("name").value }) }, $("name").value)));
$("duplicate").addEventListener("click", carefully(async () => {
  const from = $("recipes").value, names = await ask("recipes"), [, stem] = /^(.*?)(?: \d+)?$/.exec(from) ?? [];
  let copy = from;
  for (let i = 2; names.includes(copy); ++i) copy = `${stem} ${i}`;
  await change_recipe(from, { method: "POST", body: JSON.stringify({ copy }) }, copy);
}));
$("recipes").addEventListener("change", carefully(async () => {
  if ($("recipes").value) await load_recipe($("recipes").value);
}));
