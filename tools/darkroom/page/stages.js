// From a first preview to the print: pictures of more and more of the samples.
// @ts-check
import { colours_of, light_of } from "./recipe.js";
import { state } from "./server.js";

/** @typedef {import("./recipe.js").Recipe} Recipe */

const kPreview = 1.5e6; // samples, which are developed at once
const kSteps = 8;       // times as many, in each picture until all are in
/** @typedef {{share: number, mixed: boolean}} Stage */
/** What is shown; and the lights that are kept apart, of a part of the samples, so that they can be mixed at once.
 * @typedef {{light: string, colours: string, samples: number, stage: Stage, apart: {colours: string, share: number}}} Seen */

// A part of the samples that is a preview; 1: there are few.
export function first_share() {
  const share = Number((kPreview / state.samples).toPrecision(3));
  return share > 0.5 ? 1 : share;
}

/** Pictures of more and more of the samples; the last is the print. One that has been seen already comes first: it is kept.
 * @param {Recipe} asked @param {Seen} seen @returns {Stage[]} */
export function stages_of(asked, seen) {
  const exact = { share: 1, mixed: false }, first = first_share(), same = light_of(asked) === seen.light;
  if (same && seen.samples > 0 && seen.samples < state.samples) return [exact];  // more samples: what is shown stays until they are in
  if (same && !seen.stage.mixed && seen.stage.share === 1) return [exact];
  /** @type {Stage[]} */
  const stages = [];
  const mixes = state.light_groups.length > 1 && !same && colours_of(asked) === seen.colours;
  if (mixes) stages.push({ share: seen.apart.colours === seen.colours ? seen.apart.share : first, mixed: true });
  else if (same) stages.push(seen.stage);
  const from = stages[0]?.share ?? first / kSteps;
  for (let share = from * kSteps; share < 0.5; share *= kSteps) stages.push({ share, mixed: false });
  return [...stages, exact];
}

/** @param {Recipe} asked @param {Stage} stage @returns {Recipe} */
export function at_stage(asked, stage) {
  if (stage.share === 1) return asked;
  return { ...asked, develop: { ...asked.develop, fraction: Number((stage.share * Number(asked.develop?.fraction ?? 1)).toPrecision(3)) } };
}

/** @param {Stage} stage */
export function badge_of(stage) {
  if (stage.mixed && stage.share === 1) return "lights mixed · the exact picture follows";
  return `preview of ${(100 * stage.share).toPrecision(2)} % of the samples · more follow`;
}
