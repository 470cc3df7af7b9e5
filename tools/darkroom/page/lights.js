// Settings of light groups, as recipes have them: "NAME=6500K,wratten-80a,2.5".
// @ts-check
import { signed } from "./dom.js";
import { state } from "./server.js";

/** @typedef {{name: string, spectrum: string, gels: string[], factor: number}} Setting */

/** @type {string[]} */
const groups = state.light_groups.map((/** @type {any} */ group) => group.name);
export const is_spectrum = (/** @type {string} */ text) => /^\d+(\.\d+)?k$/i.test(text) || state.lights.some((/** @type {any} */ light) => light.name === text);

/** The settings of all groups. @param {import("./recipe.js").Recipe} recipe @returns {Setting[]} */
export function settings_of(recipe) {
  const lights = [recipe.develop?.light ?? []].flat().map(String);
  return groups.map((name) => {
    /** @type {Setting} */
    const setting = { name, spectrum: "", gels: [], factor: 1 };
    const text = lights.find((light) => light.startsWith(name + "=")) ?? "";
    for (const part of text.slice(name.length + 1).split(",").filter(Boolean)) {
      if (is_spectrum(part)) setting.spectrum = part;
      else if (Number.isFinite(Number(part))) setting.factor *= Number(part);
      else setting.gels.push(part);
    }
    return setting;
  });
}
/** @param {number} factor */
export const stops_of = (factor) => factor === 0 ? "off" : signed(Math.log2(factor));
/** @param {Setting} setting */
export const text_of = ({ spectrum, gels, factor }) => [stops_of(factor), spectrum, ...gels].filter(Boolean).join(", ");
