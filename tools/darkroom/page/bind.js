// A control of one key of the recipe.
// @ts-check
import { $ } from "./dom.js";
import { changed, get, put, shows } from "./recipe.js";

/** `usual`: the value by default, which recipes leave out.
 * @param {string} id @param {"develop" | "convert"} section @param {string} key @param {any} usual @param {(v: any) => string} [text] */
export function bind(id, section, key, usual, text = String) {
  const control = $(id), output = document.querySelector(`output[for="${id}"]`);
  const numeric = control.type === "range" || control.type === "number";
  shows.push(() => {
    const value = get(section, key) ?? usual;
    if (control.type === "checkbox") { control.checked = value === true; return; }
    if (control.tagName === "SELECT" && ![...control.options].some((o) => o.value === String(value))) control.add(new Option(String(value)));
    control.value = String(value === true ? 1 : value);
    if (output) output.textContent = text(Number(control.value));
  });
  control.addEventListener(control.type === "range" ? "input" : "change", () => {
    const value = control.type === "checkbox" ? control.checked : numeric && control.value !== "" ? Number(control.value) : control.value;
    put(section, key, value === usual ? undefined : value);
    changed();
  });
}
