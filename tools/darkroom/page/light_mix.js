// Light mix: how bright each group of lights is, and in which colour.
// @ts-check
import { $, show_error } from "./dom.js";
import { is_spectrum, settings_of, stops_of } from "./lights.js";
import { touch_lights } from "./picture.js";
import { changed, put, recipe, show_controls, shows } from "./recipe.js";
import { state } from "./server.js";

/** @typedef {import("./lights.js").Setting} Setting */
const is_kelvin = (/** @type {string} */ text) => /^\d+(\.\d+)?k?$/i.test(text);
const setting_of = (/** @type {string} */ name) => /** @type {Setting} */ (settings_of(recipe).find((setting) => setting.name === name));
/** @type {Map<string, number>} */
const unmuted = new Map(); // factors from before they were 0
/** @param {(setting: Setting) => Partial<Setting>} change */
function change_lights(change) {
  const texts = [];
  for (const old of settings_of(recipe)) {
    const { name, spectrum, gels, factor } = { ...old, ...change(old) };
    const parts = [spectrum, ...gels, factor !== 1 && String(Number(factor.toPrecision(6)))].filter(Boolean);
    if (parts.length > 0) texts.push(`${name}=${parts.join(",")}`);
  }
  put("develop", "light", texts.length > 0 ? texts : undefined);
  touch_lights();
  changed();
}
/** @param {string} name @param {Partial<Setting>} change */
const put_light = (name, change) => change_lights((old) => old.name === name ? change : {});
/** Whether the others are off, and it is not. @param {string} name */
const is_alone = (name) => settings_of(recipe).every((setting) => (setting.factor !== 0) === (setting.name === name));
const mute = (/** @type {string} */ name) => {
  const { factor } = setting_of(name);
  if (factor !== 0) unmuted.set(name, factor);
  return 0;
};
for (const { name, replaceable } of state.light_groups.toSorted((/** @type {any} */ a, /** @type {any} */ b) => Number(a.name === "unnamed") - Number(b.name === "unnamed"))) {
  const row = document.createElement("div");
  row.className = "group";
  /** @param {HTMLElement} to @param {string} tag @param {{[key: string]: any}} properties @returns {any} */
  const add = (to, tag, properties) => to.appendChild(Object.assign(document.createElement(tag), properties));
  add(row, "b", { textContent: name, title: name === "unnamed" ? "All lights without a name" : name });
  const stops = add(row, "input", { type: "range", min: "-6", max: "6", step: "0.05" }), output = add(row, "output", {});
  const below = add(row, "div", {}), off = add(below, "button", { textContent: "Mute" }), solo = add(below, "button", { textContent: "Solo" });
  off.setAttribute("aria-label", `Mute ${name}`);
  solo.setAttribute("aria-label", `Solo ${name}`);
  stops.setAttribute("aria-label", `Stops of ${name}`);
  /** @param {string} list @param {{[key: string]: any}} properties */
  const add_choice = (list, properties) => {
    const input = add(below, "input", { autocomplete: "off", hidden: !state.spectral, ...properties });
    input.setAttribute("list", list);
    input.setAttribute("aria-label", `${properties.placeholder} of ${name}`);
    return input;
  };
  const lamp = add_choice("lamps", { placeholder: "Colour", title: replaceable ? "Another colour of light: a temperature, such as 3200K, or the name of a light, such as F11" : "The lights of this name have different spectra, or their spectrum is not known: only gels can colour them", disabled: !replaceable });
  const gel = add_choice("filters", { placeholder: "Gel" });
  stops.addEventListener("input", () => put_light(name, { factor: 2 ** Number(stops.value) }));
  lamp.addEventListener("change", () => {
    const spectrum = is_kelvin(lamp.value) ? parseFloat(lamp.value) + "K" : lamp.value.trim();
    if (spectrum === "" || is_spectrum(spectrum)) return put_light(name, { spectrum });
    show_controls();
    show_error(`${spectrum}: not a temperature, such as 3200K, or the name of a light`);
  });
  gel.addEventListener("change", () => put_light(name, { gels: gel.value.split(",").map((/** @type {string} */ g) => g.trim()).filter(Boolean) }));
  off.addEventListener("click", () => put_light(name, { factor: setting_of(name).factor === 0 ? unmuted.get(name) ?? 1 : mute(name) }));
  solo.addEventListener("click", () => {
    const all = is_alone(name);
    change_lights((old) => ({ factor: all || old.name === name ? old.factor || (unmuted.get(old.name) ?? 1) : mute(old.name) }));
  });
  shows.push(() => {
    const s = setting_of(name), muted = s.factor === 0, value = Math.log2(muted ? unmuted.get(name) ?? 1 : s.factor);
    stops.value = String(value);
    output.textContent = stops_of(s.factor);
    lamp.value = s.spectrum;
    gel.value = s.gels.join(",");
    gel.title = gel.value || "Filters before the light, separated by commas";
    off.setAttribute("aria-pressed", String(muted));
    solo.setAttribute("aria-pressed", String(state.light_groups.length > 1 && is_alone(name)));
  });
  $("groups").append(row);
}
for (const light of [...["2700K", "3200K", "4300K", "5600K", "10000K"].map((name) => ({ name, what: "" })), ...state.lights])
  $("lamps").append(Object.assign(document.createElement("option"), { value: light.name, label: light.what }));
$("light").hidden = state.light_groups.length === 0;
