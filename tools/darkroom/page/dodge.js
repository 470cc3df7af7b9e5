// Dodge and burn: parts of the print with light of their own.
// @ts-check
import { $, signed } from "./dom.js";
import { changed, get, put, shows } from "./recipe.js";
import { state } from "./server.js";

/** The longer side of the picture, where its width is 1. */
export const longer = () => Math.max(1, state.aspect[1] / state.aspect[0]);

/** @returns {string[]} */
const dodges = () => [get("convert", "dodge") ?? []].flat();
/** @param {string[]} all */
function put_dodges(all) {
  put("convert", "dodge", all.length ? all : undefined);
  changed();
}
/** @param {"brush" | "gradient"} kind @param {{x: number, y: number}[]} line in widths of the picture */
export function add_dodge(kind, line) {
  const top = state.aspect[1] / state.aspect[0], digits = (/** @type {number} */ v) => String(Number(v.toFixed(4)));
  const places = line.flatMap(({ x, y }) => [digits(x), digits(y / top)]);
  const stops = Number($("dodge-stops").value), radius = Number($("dodge-radius").value);
  put_dodges([...dodges(), `${kind}:${kind === "brush" ? [stops, radius, ...places] : [stops, ...places]}`]);
}
shows.push(() => $("dodges").replaceChildren(...dodges().map((text, i) => {
  const [kind, numbers] = text.split(":"), line = document.createElement("li");
  const remove = Object.assign(document.createElement("button"), { textContent: "Remove", title: `Remove ${text}` });
  remove.addEventListener("click", () => put_dodges(dodges().filter((_, j) => j !== i)));
  line.append(`${kind}, ${signed(parseFloat(numbers))} stops `, remove);
  return line;
})));
for (const id of ["dodge-stops", "dodge-radius"]) {
  const output = document.querySelector(`output[for="${id}"]`), text = (/** @type {string} */ v) => id === "dodge-stops" ? signed(Number(v)) : v;
  const follow = () => { if (output) output.textContent = text($(id).value); };
  $(id).addEventListener("input", follow);
  follow();
}
