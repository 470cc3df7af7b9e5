// A ruler along an edge of the picture.
// @ts-check
import { add, step_of } from "./plot.js";

const kThick = 20;

/** @param {SVGElement} svg @param {"across" | "down"} way
 * @param {{length: number, zero: number, unit: number, from: number, to: number}} scale in pixels of the screen: how long it is, where
 * its 0 lies, how long a unit is, and which part is marked */
export function draw_ruler(svg, way, { length, zero, unit, from, to }) {
  const across = way === "across";
  svg.setAttribute("viewBox", across ? `0 0 ${length} ${kThick}` : `0 0 ${kThick} ${length}`);
  svg.replaceChildren();
  add(svg, "rect", across ? { class: "part", x: from, y: 0, width: to - from, height: kThick } : { class: "part", x: 0, y: from, width: kThick, height: to - from });
  const step = step_of(length / unit, length / 60), first = Math.ceil(-zero / unit / (step / 5)), last = Math.floor((length - zero) / unit / (step / 5));
  for (let i = first; i <= last; ++i) {
    const at = zero + i * step / 5 * unit, long = i % 5 === 0, end = kThick - (long ? 9 : 4);
    add(svg, "line", across ? { x1: at, x2: at, y1: end, y2: kThick } : { y1: at, y2: at, x1: end, x2: kThick });
    if (!long) continue;
    const text = String(Number((i * step / 5).toPrecision(6)));
    if (across) add(svg, "text", { x: at, y: 10, "text-anchor": "middle" }, text);
    else add(svg, "text", { x: 0, y: 0, "text-anchor": "middle", transform: `translate(10 ${at}) rotate(-90)` }, text);
  }
}
