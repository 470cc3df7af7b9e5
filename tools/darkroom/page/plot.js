// The spectrum of a pixel as a plot: a step for each bin, in a band of plus and minus its standard error.
// @ts-check

const kWidth = 320, kHeight = 130, kLeft = 44, kBottom = 18, kTop = 6;

/** @param {SVGElement} svg @param {string} tag @param {{[key: string]: string | number}} attributes */
export function add(svg, tag, attributes, text = "") {
  const child = svg.appendChild(document.createElementNS("http://www.w3.org/2000/svg", tag));
  for (const [name, value] of Object.entries(attributes)) child.setAttribute(name, String(value));
  child.textContent = text;
  return child;
}

/** Marks at 1, 2 or 5 times a power of ten, at most `most` from 0 to `end`. @param {number} end @param {number} most */
export function step_of(end, most) {
  const least = end / most, power = 10 ** Math.floor(Math.log10(least));
  return power * (/** @type {number} */ ([1, 2, 5, 10].find((m) => m * power >= least * (1 - 1e-9))));
}

/** @param {number} v @param {number} digits */
export const short = (v, digits) => v === 0 || (Math.abs(v) >= 0.01 && Math.abs(v) < 1000) ? String(Number(v.toPrecision(digits))) : v.toExponential(digits - 1);

/** @param {SVGElement} svg @param {{from_nm: number, to_nm: number, values: number[], standard_errors: number[]}} spectrum */
export function plot_spectrum(svg, spectrum) {
  const { from_nm, to_nm, values, standard_errors } = spectrum, bin = (to_nm - from_nm) / values.length;
  const most = Math.max(...values.map((v, i) => v + standard_errors[i]), 1e-30);
  const x = (/** @type {number} */ nm) => kLeft + (nm - from_nm) / (to_nm - from_nm) * (kWidth - kLeft - 2);
  const y = (/** @type {number} */ v) => kHeight - kBottom - Math.min(Math.max(v / most, 0), 1) * (kHeight - kBottom - kTop);
  const steps = (/** @type {(i: number) => number} */ of) =>
    values.flatMap((_, i) => [[i, of(i)], [i + 1, of(i)]]).map(([i, v]) => `${x(from_nm + i * bin).toFixed(1)},${y(v).toFixed(1)}`);
  svg.setAttribute("viewBox", `0 0 ${kWidth} ${kHeight}`);
  svg.replaceChildren();
  for (let nm = Math.ceil(from_nm / 100) * 100; nm <= to_nm; nm += 100) {
    add(svg, "line", { class: "grid", x1: x(nm), x2: x(nm), y1: kTop, y2: kHeight - kBottom });
    add(svg, "text", { x: x(nm), y: kHeight - 5, "text-anchor": "middle" }, String(nm));
  }
  const step = step_of(most, 3);
  for (let v = 0; v <= most; v += step) {
    add(svg, "line", { class: "grid", x1: kLeft, x2: kWidth, y1: y(v), y2: y(v) });
    add(svg, "text", { x: kLeft - 4, y: y(v) + 3, "text-anchor": "end" }, short(v, v >= 0.01 ? 3 : 1));
  }
  const upper = steps((i) => values[i] + standard_errors[i]), lower = steps((i) => values[i] - standard_errors[i]).reverse();
  add(svg, "polygon", { class: "error", points: [...upper, ...lower].join(" ") });
  add(svg, "polyline", { class: "mean", points: steps((i) => values[i]).join(" ") });
}
