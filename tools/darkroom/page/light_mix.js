// Light mix: "NAME=6500K,wratten-80a,2.5".
// @ts-check
import { $, show_error, signed } from "./dom.js";
import { touch_lights } from "./picture.js";
import { changed, get, put, show_controls, shows } from "./recipe.js";
import { state } from "./server.js";

/** @typedef {import("./recipe.js").Section} Section */
/** @typedef {{spectrum: string, gels: string[], factor: number}} Setting */
/** @type {string[]} */
const groups = state.light_groups.map((/** @type {any} */ group) => group.name);
const is_kelvin = (/** @type {string} */ text) => /^\d+(\.\d+)?k?$/i.test(text);
const is_spectrum = (/** @type {string} */ text) => /^\d+(\.\d+)?k$/i.test(text) || state.lights.some((/** @type {any} */ light) => light.name === text);
/** @param {string} name @returns {Setting} */
function setting_of(name) {
  const lights = [get("develop", "light") ?? []].flat();
  const text = lights.find((l) => String(l).startsWith(name + "=")) ?? "";
  /** @type {Setting} */
  const setting = { spectrum: "", gels: [], factor: 1 };
  for (const part of String(text).slice(name.length + 1).split(",").filter(Boolean)) {
    if (is_spectrum(part)) setting.spectrum = part;
    else if (Number.isFinite(Number(part))) setting.factor *= Number(part);
    else setting.gels.push(part);
  }
  return setting;
}
/** @type {Map<string, number>} */
const unmuted = new Map(); // factors from before they were 0
/** @param {Map<string, Setting>} settings */
function put_lights(settings) {
  const texts = [];
  for (const [name, s] of settings) {
    const parts = [s.spectrum, ...s.gels, s.factor !== 1 && String(Number(s.factor.toPrecision(6)))].filter(Boolean);
    if (parts.length > 0) texts.push(`${name}=${parts.join(",")}`);
  }
  put("develop", "light", texts.length > 0 ? texts : undefined);
  touch_lights();
  changed();
}
/** @param {string} name @param {Partial<Setting>} change */
function put_light(name, change) {
  put_lights(new Map(groups.map((n) => [n, { ...setting_of(n), ...(n === name ? change : {}) }])));
}
const mute = (/** @type {string} */ name) => {
  const { factor } = setting_of(name);
  if (factor !== 0) unmuted.set(name, factor);
  return 0;
};
for (const { name, replaceable } of state.light_groups) {
  const row = document.createElement("div");
  row.className = "group";
  /** @param {string} tag @param {Section} properties */
  const add = (tag, properties, to = row) => to.appendChild(Object.assign(document.createElement(tag), properties));
  add("b", { textContent: name, title: name });
  const stops = /** @type {any} */ (add("input", { type: "range", min: "-6", max: "6", step: "0.05" })), output = add("output", {});
  const below = add("div", {}), off = add("button", { textContent: "Mute" }, below), solo = add("button", { textContent: "Solo" }, below);
  off.setAttribute("aria-label", `Mute ${name}`);
  solo.setAttribute("aria-label", `Solo ${name}`);
  stops.setAttribute("aria-label", `Stops of ${name}`);
  /** @param {string} list @param {Section} properties */
  const add_choice = (list, properties) => {
    const input = /** @type {any} */ (add("input", { autocomplete: "off", hidden: !state.spectral, ...properties }, below));
    input.setAttribute("list", list);
    input.setAttribute("aria-label", `${properties.placeholder} of ${name}`);
    return input;
  };
  const lamp = add_choice("lamps", { placeholder: "Lamp", title: replaceable ? "Its spectrum: kelvin, or the name of a light" : "The lights of this name have different spectra, or their spectrum is not known", disabled: !replaceable });
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
    const alone = setting_of(name).factor !== 0 && groups.every((n) => n === name || setting_of(n).factor === 0);
    const restored = (/** @type {string} */ n) => setting_of(n).factor || (unmuted.get(n) ?? 1);
    put_lights(new Map(groups.map((n) => [n, { ...setting_of(n), factor: n === name || alone ? restored(n) : mute(n) }])));
  });
  shows.push(() => {
    const s = setting_of(name), muted = s.factor === 0, value = Math.log2(muted ? unmuted.get(name) ?? 1 : s.factor);
    stops.value = String(value);
    output.textContent = muted ? "off" : signed(value);
    lamp.value = s.spectrum;
    gel.value = s.gels.join(",");
    gel.title = gel.value || "Filters before it, separated by commas";
    off.setAttribute("aria-pressed", String(muted));
    solo.setAttribute("aria-pressed", String(!muted && groups.length > 1 && groups.every((n) => n === name || setting_of(n).factor === 0)));
  });
  $("groups").append(row);
}
for (const light of [...["2700K", "3200K", "4300K", "5600K", "10000K"].map((name) => ({ name, what: "" })), ...state.lights])
  $("lamps").append(Object.assign(document.createElement("option"), { value: light.name, label: light.what }));
$("light").hidden = state.light_groups.length === 0;
