// Shows the print that the recipe makes, as soon as the samples allow.
// @ts-check
import { $, badge, show_error } from "./dom.js";
import { show_histogram } from "./histogram.js";
import { keep } from "./history.js";
import { colours_of, light_of, recipe, when_changed } from "./recipe.js";
import { ask, begin_turn, in_turn, state, superseded, turn } from "./server.js";
import { at_stage, badge_of, first_share, stages_of } from "./stages.js";
import { add_image, height_of, inside, loaded, seen_width, viewer } from "./viewer.js";

/** @typedef {import("./recipe.js").Recipe} Recipe */
/** @typedef {import("./stages.js").Stage} Stage */

/** What is shown, as the server names it. @type {string | undefined} */
export let view;
export const forget_view = () => { view = undefined; };
export let commands = ""; // that make the print
/** What is measured of each print when it is there. @type {(() => Promise<void>)[]} */
export const measures = [];
/** @type {import("./stages.js").Seen} */
const seen = { light: "", colours: "", samples: 0, stage: { share: 0, mixed: false }, apart: { colours: "", share: 0 } };
let lights_touched = false;
export const touch_lights = () => { lights_touched = true; };
/** Of the viewer. @type {any} */
let item;
let running = false, finished = 0; // the last turn that is
let late = 0; // says so when nothing of a turn is there soon

/** Puts the view over what is shown, and in its place once all of it is there. False: it is not wanted any more.
 * @param {string} id @param {boolean} mixed */
async function show(id, mixed) {
  const mine = turn, first = viewer.world.getItemCount() === 0, before = item;
  const fresh = await add_image(id, () => in_turn(mixed));
  if (first) viewer.viewport.goHome(true);
  await Promise.race([loaded(fresh), superseded]);
  if (turn !== mine) {
    viewer.world.removeItem(fresh);
    return false;
  }
  item = fresh;
  if (before) viewer.world.removeItem(before);
  return true;
}

/** @param {Recipe} asked @param {boolean} mixed */
const ask_view = (asked, mixed) => ask(`views?${in_turn(mixed)}`, { method: "POST", body: JSON.stringify(asked) });
const rest = (/** @type {number} */ ms) => Promise.race([superseded, new Promise((later) => setTimeout(later, ms))]);

/** @param {Recipe} asked */
async function show_stages(asked) {
  const mine = turn;
  for (const stage of stages_of(asked, seen)) {
    const exact = stage.share === 1 && !stage.mixed;
    const made = await ask_view(at_stage(asked, stage), stage.mixed);
    if (turn !== mine) return;
    show_error("");
    if (exact) commands = made.commands;
    if (recipe === asked) keep(asked, exact ? made.recipe : asked);
    if (!exact || made.view !== view || !item || seen.samples < state.samples) {
      if (!await show(made.view, stage.mixed)) return;
    }
    Object.assign(seen, { light: light_of(asked), colours: colours_of(asked), stage, samples: exact ? state.samples : 0 });
    view = made.view;
    clearTimeout(late);
    badge(exact ? "" : badge_of(stage));
    await show_histogram(made.view, stage.mixed);
    if (!exact) await rest(300); // for the next step of a slider
    if (turn !== mine) return;
    if (exact) finished = mine;
  }
}

// Shows the recipe: one view at a time, and always the last one that was asked for.
async function update() {
  begin_turn();
  document.body.dataset.settled = "";
  if (running) return;
  running = true;
  while (finished !== turn) {
    const now = turn;
    late = setTimeout(() => $("badge").textContent || badge("developing …"), 200);
    try {
      await show_stages(recipe);
    } catch (error) {
      if (!(/** @type {any} */ (error).superseded)) {
        show_error(error);
        badge("");
        item?.reset(); // tiles of it may have been given up
        finished = now;
      }
    }
    clearTimeout(late);
  }
  running = false;
  const shown = turn;
  for (const measure of measures) await measure();
  if (turn !== shown) return;
  document.body.dataset.recipe = JSON.stringify(recipe);
  document.body.dataset.settled = view ?? "";
  keep_lights_apart();
}

// So that the next mix is there at once: of a part of the samples; of all, once lights have been touched.
async function keep_lights_apart() {
  if (state.light_groups.length < 2 || running) return;
  const mine = turn, shares = [first_share(), ...(lights_touched ? [1] : [])];
  try {
    for (const share of shares) {
      const made = await ask_view(at_stage(recipe, { share, mixed: true }), true), w = seen_width();
      const centre = viewer.viewport.getCenter(), x = inside(centre.x, w), y = inside(centre.y, height_of(w), w);
      const response = await fetch(`api/tile?view=${made.view}&width=${w}&area=${x},${y},${x + 1},${y + 1}&format=raw&${in_turn(true)}`);
      if (!response.ok || turn !== mine) return;
      seen.apart = { colours: seen.colours, share };
    }
  } catch { /* given up */ }
}

when_changed(update);

// Files that grow: looked at now and then, while somebody looks at the page.
export function show_samples() {
  const per_pixel = state.samples / (state.width * state.height);
  $("samples").textContent = `${state.samples.toLocaleString("en")} samples, ${per_pixel.toPrecision(3)} a pixel of ${state.width} × ${state.height}`;
}
setInterval(async () => {
  if (running || document.hidden) return;
  try {
    const now = await ask("samples");
    if (now.samples <= state.samples || running) return;
    state.samples = now.samples;
    seen.apart.colours = "";
    show_samples();
    update();
  } catch { /* the server has ended, or will answer again */ }
}, 2000);
