// The darkroom's page. What it shows and keeps is a recipe; every control reads its value from there and writes it back.
// @ts-check
/* global OpenSeadragon */
import { plot_spectrum, short } from "./plot.js";
import { draw_ruler } from "./ruler.js";

/** @typedef {{[key: string]: any}} Section */
/** @typedef {{"latent-recipe": number, develop?: Section, convert?: Section}} Recipe */

/** @param {string} id @returns {any} */
const $ = (id) => document.getElementById(id);

/** @param {string} path @param {RequestInit} [how] */
async function ask(path, how) {
  const response = await fetch("api/" + path, how);
  const json = await response.json();
  if (!response.ok) throw Object.assign(new Error(json.error ?? response.statusText), { superseded: response.status === 410 });
  return json;
}

const state = await ask("state");
/** @type {Recipe} */
let recipe = { "latent-recipe": 1 };
/** @type {string[]} */
let history = [];
let place = -1; // in the history
let commands = "";
/** @type {string | undefined} */
let view;

// --- The recipe, by section and key; undefined: as by default.

/** @param {"develop" | "convert"} section @param {string} key */
const get = (section, key) => recipe[section]?.[key];
/** @param {"develop" | "convert"} section @param {string} key @param {any} value */
function put(section, key, value) {
  const values = { ...recipe[section] };
  if (value === undefined || value === "") delete values[key];
  else values[key] = value;
  recipe = { ...recipe, [section]: values };
}

/** @param {unknown} error */
function show_error(error) {
  $("error").textContent = error ? String(/** @type {any} */ (error).message ?? error) : "";
  $("error").hidden = !error;
}

// --- The picture: levels of a pyramid over the film, each developed at its own size.

const kTile = 512;
const kViewer = {
  drawer: "canvas", showNavigationControl: false, immediateRender: true, imageLoaderLimit: 3, timeout: 600000,
  gestureSettingsMouse: { clickToZoom: false }, maxZoomPixelRatio: 16, minZoomImageRatio: 0.5, animationTime: 0.3, visibilityRatio: 0.2,
  imageSmoothingEnabled: false, subPixelRoundingForTransparency: OpenSeadragon.SUBPIXEL_ROUNDING_OCCURRENCES.ALWAYS,
};
const viewer = OpenSeadragon({ ...kViewer, element: $("picture") });

/** @param {number} width */
const height_of = (width) => Math.max(1, Math.round(width / (state.aspect[0] / state.aspect[1])));
const print_width = () => parseInt(get("develop", "size") ?? state.width, 10) || state.width;

let seen_width = 0; // of the level that tiles were last asked of

// What was asked for in an earlier turn, the server gives up: each wish begins a turn.
const tab = Math.random().toString(36).slice(2);
let turn = 0;
/** @type {() => void} */
let supersede = () => {};
let superseded = new Promise((done) => { supersede = () => done(undefined); });
function begin_turn() {
  ++turn;
  supersede();
  superseded = new Promise((done) => { supersede = () => done(undefined); });
}
/** @param {boolean} mixed */
const in_turn = (mixed) => `tab=${tab}&turn=${turn}${mixed ? "&mixed=1" : ""}`;

/** @param {string} id @param {number} width @param {() => string} how */
function source_of(id, width, how) {
  const height = height_of(width), levels = Math.max(0, Math.ceil(Math.log2(width / 256)));
  return {
    width, height, tileSize: kTile, tileOverlap: 1,  // without, tiles are drawn a pixel too large
    minLevel: 0, maxLevel: levels,
    getTileUrl: (/** @type {number} */ level, /** @type {number} */ x, /** @type {number} */ y) => {
      const w = Math.ceil(width / 2 ** (levels - level)), h = height_of(w);
      seen_width = w;
      const x0 = Math.min(x * kTile, w - 1), y0 = Math.min(y * kTile, h - 1);
      const area = [Math.max(x0 - 1, 0), Math.max(y0 - 1, 0), Math.min(x0 + kTile + 1, w), Math.min(y0 + kTile + 1, h)];
      return new URL(`api/tile?view=${id}&width=${w}&area=${area}&${how()}`, location.href).href;
    },
  };
}

/** @param {any} item */
function loaded(item) {
  return new Promise((done) => {
    const ready = () => item.getFullyLoaded() && (item.removeHandler("fully-loaded-change", ready), done(undefined));
    item.addHandler("fully-loaded-change", ready);
    ready();
  });
}

/** @param {string} id @param {() => string} how @returns {Promise<any>} */
const add_image = (id, how, to = viewer) => new Promise((success, failure) =>
  to.addTiledImage({ tileSource: source_of(id, print_width(), how), x: 0, y: 0, width: 1, success: (/** @type {any} */ e) => success(e.item), error: failure }));

viewer.addHandler("tile-load-failed", async (/** @type {any} */ event) => {
  const url = new URL(event.tile.getUrl()), asked = url.searchParams.get("turn");
  if (asked && Number(asked) !== turn) return;
  const response = await fetch(url);
  if (!response.ok) show_error((await response.json()).error);
});

/** @type {any} */
let item;
/** @type {any} */
let held; // the print that is compared with, under the divider
let running = false, finished = 0; // the last turn that is
/** @type {"" | "mixed" | "exact"} */
let warm = ""; // which lights are kept apart, as soon as nothing else is to be done

/** Puts the view over what is shown, and in its place once all of it is there. False: it is not wanted any more.
 * @param {string} id @param {boolean} mixed */
async function show(id, mixed) {
  const mine = turn, first = viewer.world.getItemCount() === 0, before = item;
  const fresh = await add_image(id, () => in_turn(mixed));
  if (held) viewer.world.setItemIndex(held, viewer.world.getItemCount() - 1);
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

const kPreview = 1.5e6; // samples, which are developed at once
const kSteps = 8;       // times as many, in each picture until all are in
/** @typedef {{share: number, mixed: boolean}} Stage */
/** @type {{light: string, samples: number, stage: Stage, lights_touched: boolean}} */
const seen = { light: "", samples: 0, stage: { share: 0, mixed: false }, lights_touched: false };

/** @param {Recipe} asked */
const light_of = (asked) => JSON.stringify(asked.develop ?? {});
/** @param {Recipe} asked */
const without_lights = (asked) => light_of({ ...asked, develop: { ...asked.develop, light: undefined } });

// A part of the samples that is a preview; 1: there are few.
function first_share() {
  const share = Number((kPreview / state.samples).toPrecision(3));
  return share > 0.5 ? 1 : share;
}

/** Pictures of more and more of the samples; the last is the print. One that has been seen already comes first: it is kept.
 * @param {Recipe} asked @returns {Stage[]} */
function stages_of(asked) {
  const exact = { share: 1, mixed: false }, first = first_share(), same = light_of(asked) === seen.light;
  if (same && seen.samples > 0 && seen.samples < state.samples) return [exact];  // more samples: what is shown stays until they are in
  if (same && !seen.stage.mixed && seen.stage.share === 1) return [exact];
  /** @type {Stage[]} */
  const stages = [];
  const mixes = state.light_groups.length > 1 && seen.light !== "" && !same && without_lights(asked) === without_lights(JSON.parse(`{"latent-recipe": 1, "develop": ${seen.light}}`));
  if (mixes) stages.push({ share: warm === "exact" ? 1 : first, mixed: true });
  else if (same) stages.push(seen.stage);
  const from = stages[0]?.share ?? first / kSteps;
  for (let share = from * kSteps; share < 0.5; share *= kSteps) stages.push({ share, mixed: false });
  return [...stages, exact];
}

/** @param {Recipe} asked @param {Stage} stage @returns {Recipe} */
function at_stage(asked, stage) {
  if (stage.share === 1) return asked;
  return { ...asked, develop: { ...asked.develop, fraction: Number((stage.share * Number(asked.develop?.fraction ?? 1)).toPrecision(3)) } };
}

/** @param {Recipe} asked @param {boolean} mixed */
const ask_view = (asked, mixed) => ask(`views?${in_turn(mixed)}`, { method: "POST", body: JSON.stringify(asked) });
const rest = (/** @type {number} */ ms) => Promise.race([superseded, new Promise((later) => setTimeout(later, ms))]);

/** @param {string} text */
function badge(text) {
  $("badge").textContent = text;
  $("badge").hidden = !text;
}
/** @param {Stage} stage */
function badge_of(stage) {
  if (stage.mixed && stage.share === 1) return "lights mixed · the exact picture follows";
  return `preview of ${(100 * stage.share).toPrecision(2)} % of the samples · more follow`;
}

/** @param {Recipe} asked */
async function show_stages(asked) {
  const mine = turn;
  for (const stage of stages_of(asked)) {
    const exact = stage.share === 1 && !stage.mixed;
    const made = await ask_view(at_stage(asked, stage), stage.mixed);
    show_error("");
    if (exact) {
      commands = made.commands;
      if (recipe === asked) keep(made.recipe);
    }
    if (!exact || made.view !== view || !item || seen.samples < state.samples) {
      if (!await show(made.view, stage.mixed)) return;
    }
    Object.assign(seen, { light: light_of(asked), stage, samples: exact ? state.samples : 0 });
    view = made.view;
    badge(exact ? "" : badge_of(stage));
    await show_histogram(made.view, stage.mixed);
    if (!exact) await rest(300); // for the next step of a slider
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
    const late = setTimeout(() => $("badge").textContent || badge("developing …"), 200);
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
  await probe_again();
  await show_noise();
  if (turn !== shown) return;
  document.body.dataset.recipe = JSON.stringify(recipe);
  document.body.dataset.settled = view ?? "";
  keep_lights_apart();
}

// So that the next mix is there at once: of a part of the samples; of all, once lights have been touched.
async function keep_lights_apart() {
  if (state.light_groups.length < 2 || running) return;
  const mine = turn, shares = [first_share(), ...(seen.lights_touched ? [1] : [])];
  warm = "";
  try {
    for (const share of shares) {
      const made = await ask_view(at_stage(recipe, { share, mixed: true }), true), w = seen_width;
      const centre = viewer.viewport.getCenter(), x = inside(centre.x, w), y = inside(centre.y, height_of(w), w);
      const response = await fetch(`api/tile?view=${made.view}&width=${w}&area=${x},${y},${x + 1},${y + 1}&format=raw&${in_turn(true)}`);
      if (!response.ok || turn !== mine) return;
      warm = share === 1 ? "exact" : "mixed";
    }
  } catch { /* given up */ }
}
/** A pixel inside. @param {number} v @param {number} most */
const inside = (v, most, scale = most) => Math.floor(Math.min(Math.max(v * scale, 0), most - 1));

// Files that grow: looked at now and then, while somebody looks at the page.
function show_samples() {
  const per_pixel = state.samples / (state.width * state.height);
  $("samples").textContent = `${state.samples.toLocaleString("en")} samples, ${per_pixel.toPrecision(3)} a pixel of ${state.width} × ${state.height}`;
}
setInterval(async () => {
  if (running || document.hidden) return;
  try {
    const now = await ask("samples");
    if (now.samples <= state.samples || running) return;
    state.samples = now.samples;
    show_samples();
    update();
  } catch { /* the server has ended, or will answer again */ }
}, 2000);

/** @param {string} id @param {boolean} mixed */
async function show_histogram(id, mixed) {
  let width = seen_width; // what is developed already, but no more than there is a histogram of
  while (Math.max(width, height_of(width)) > 2048) width = Math.ceil(width / 2);
  const h = await ask(`histogram?view=${id}&width=${width}&${in_turn(mixed)}`);
  const canvas = $("histogram"), context = canvas.getContext("2d");
  context.clearRect(0, 0, canvas.width, canvas.height);
  context.globalCompositeOperation = "lighter";
  const most = Math.max(...[h.red, h.green, h.blue].flatMap((counts) => counts.slice(1, 255)), 1);
  for (const [counts, colour] of [[h.red, "#c33"], [h.green, "#3a3"], [h.blue, "#44d"]]) {
    context.fillStyle = colour;
    for (let i = 0; i < 256; ++i) {
      const bar = Math.min(1, Math.sqrt(counts[i] / most)) * canvas.height;
      context.fillRect(i * canvas.width / 256, canvas.height - bar, canvas.width / 256, bar);
    }
  }
  const share = (/** @type {number} */ n) => `${(100 * n / Math.max(1, h.pixels)).toFixed(1)} %`;
  $("clipping").textContent = `burnt ${share(h.burnt)} · black ${share(h.black)} · out of gamut ${share(h.out_of_gamut)}`;
}

// --- History.

/** @param {Recipe} made what the server made of the recipe: with its exposure as a number */
function keep(made) {
  recipe = made;
  const text = JSON.stringify(made);
  if (history[place] !== text) {
    history = [...history.slice(0, place + 1), text].slice(-500);
    place = history.length - 1;
  }
  show_controls();
}
/** @param {number} to */
function go(to) {
  if (to < 0 || to >= history.length) return;
  place = to;
  recipe = JSON.parse(history[place]);
  show_controls();
  update();
}

/** What a recipe changed, in few words. @param {string} text @param {string | undefined} before */
function change_of(text, before) {
  if (!before) return "the beginning";
  const [to, from] = [JSON.parse(text), JSON.parse(before)];
  return ["develop", "convert"].flatMap((section) => Object.keys({ ...from[section], ...to[section] })
    .filter((key) => JSON.stringify(to[section]?.[key]) !== JSON.stringify(from[section]?.[key]))
    .map((key) => `${key} ${to[section]?.[key] ?? "as by default"}`)).join(", ");
}
const kListed = 30; // of the history
function show_history() {
  const first = Math.max(0, history.length - kListed);
  $("history").replaceChildren(...history.slice(first).map((text, i) => {
    const line = document.createElement("li"), what = change_of(text, history[first + i - 1]);
    const button = line.appendChild(Object.assign(document.createElement("button"), { textContent: what, title: what }));
    if (first + i === place) button.setAttribute("aria-current", "step");
    button.addEventListener("click", () => go(first + i));
    return line;
  }).reverse());
}

// --- Controls.

/** @type {(() => void)[]} */
const shows = [];
function show_controls() {
  for (const show of shows) show();
  show_history();
  $("undo").disabled = place < 1;
  $("redo").disabled = place > history.length - 2;
  show_crop();
}
const changed = () => { show_controls(); update(); };

/** A control of one key. `usual`: the value by default, which recipes leave out.
 * @param {string} id @param {"develop" | "convert"} section @param {string} key @param {any} usual @param {(v: any) => string} [text] */
function bind(id, section, key, usual, text = String) {
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
const signed = (/** @type {number} */ v) => (v > 0 ? "+" : "") + v.toFixed(2);
bind("stops", "convert", "stops", 0, signed);
bind("tone", "convert", "tone", "film");
bind("contrast", "convert", "contrast", 1, (v) => v.toFixed(2));
bind("black", "convert", "black", 0, (v) => v.toFixed(3));
bind("gamut", "convert", "gamut", "luminance");
bind("profile", "convert", "profile", "srgb");
bind("denoise", "develop", "denoise", 0, (v) => v.toFixed(2));
bind("fireflies", "develop", "dim-fireflies", false);
bind("observer", "develop", "observer", "");
bind("filter", "develop", "lens-filter", "");
bind("size", "develop", "size", state.width);
bind("crop", "develop", "crop", "");
bind("dpi", "convert", "dpi", "");
bind("proof", "convert", "proof", "");
bind("intent", "convert", "intent", "perceptual");
bind("glare", "convert", "glare", "");
bind("shutter", "develop", "shutter", "");
bind("exposure-follows", "develop", "exposure-follows", false);
bind("enlarger", "convert", "print-exposure", 0, signed);
bind("grain", "convert", "grain", false);

shows.push(() => { $("sensitivity").textContent = `sensitivity ${Number(get("convert", "sensitivity") ?? 1).toPrecision(4)}`; });
$("auto").addEventListener("click", () => { put("convert", "sensitivity", undefined); put("convert", "auto", true); changed(); });

$("clipped").addEventListener("change", () => { put("convert", "show", $("clipped").checked ? "clipped" : undefined); changed(); });
shows.push(() => { $("clipped").checked = get("convert", "show") === "clipped"; });

for (const light of state.lights) $("white").querySelector('[value="kelvin"]').before(Object.assign(new Option(light.name), { title: light.what }));
shows.push(() => {
  const white = String(get("convert", "white") ?? ""), kelvin = /^(\d+(\.\d+)?)[kK]$/.exec(white);
  if (kelvin) $("kelvin").value = kelvin[1];
  const named = [...$("white").options].some((o) => o.value === white);
  $("white").value = kelvin ? "kelvin" : named ? white : "picked";
  $("white").querySelector('[value="picked"]').textContent = `x, y = ${white}`;
  $("kelvin").nextElementSibling.textContent = `${$("kelvin").value} K`;
});
$("white").addEventListener("change", () => {
  put("convert", "white", $("white").value === "kelvin" ? `${$("kelvin").value}K` : $("white").value);
  changed();
});
$("kelvin").addEventListener("input", () => { put("convert", "white", `${$("kelvin").value}K`); changed(); });

// The aperture: "f:8,blades:6", and what else a recipe says of it.
const aperture_parts = () => String(get("develop", "aperture") ?? "").split(",").filter(Boolean);
for (const [id, prefix] of [["aperture", "f:"], ["blades", "blades:"]]) {
  $(id).addEventListener("change", () => {
    const others = aperture_parts().filter((part) => !part.startsWith(prefix) && !(id === "aperture" && Number.isFinite(Number(part))));
    put("develop", "aperture", [...others, ...$(id).value ? [prefix + $(id).value] : []].join(","));
    changed();
  });
  shows.push(() => { $(id).value = aperture_parts().find((part) => part.startsWith(prefix))?.slice(prefix.length) ?? ""; });
}
bind("focus", "develop", "focus", "");

// --- Film and paper: the exposures of a film need a paper, which decides much of the rest.

/** What a recipe on this film has, on this paper or with this look. @param {Recipe} from @param {{film?: string, paper?: string, look?: string}} chosen @returns {Recipe} */
function on_film(from, { film, paper, look }) {
  const develop = { ...from.develop, film }, convert = { ...from.convert, paper, look };
  for (const key of ["observer", "camera-output", "raw-balance"]) delete develop[key];
  for (const key of ["white", "sensitivity", "print-exposure", "grain"]) delete convert[key];
  if (film && paper !== "scan") for (const key of ["tone", "contrast", "black"]) delete convert[key];
  for (const section of [develop, convert]) for (const key of Object.keys(section)) if (!section[key]) delete section[key];
  return { ...from, develop, convert };
}
/** @param {{film?: string, paper?: string, look?: string}} chosen */
function choose_film(chosen) {
  recipe = on_film(recipe, chosen);
  changed();
}
for (const [id, entries] of /** @type {[string, any[]][]} */ ([["film", state.films], ["look", state.looks],
  ["paper", [{ name: "scan", what: "scanned, without paper" }, { name: "light-table", what: "" }, { name: "projection", what: "" }, ...state.papers]]]))
  for (const entry of entries) $(id).append(Object.assign(new Option(entry.name), { title: entry.what }));
const film_of_look = (/** @type {string} */ look) => state.looks.find((/** @type {any} */ l) => l.name === look)?.film;
$("film").addEventListener("change", () => choose_film({ film: $("film").value, paper: $("film").value && ($("paper").value || "scan") }));
$("paper").addEventListener("change", () => choose_film({ film: $("paper").value && ($("film").value || "portra-400"), paper: $("paper").value }));
$("look").addEventListener("change", () => choose_film({ film: film_of_look($("look").value), look: $("look").value }));
shows.push(() => {
  const film = get("develop", "film"), paper = get("convert", "paper"), look = get("convert", "look");
  $("film").value = film ?? "", $("paper").value = paper ?? "", $("look").value = look ?? "";
  $("on-film").hidden = !film;
  for (const part of document.querySelectorAll(".plain"))
    for (const control of /** @type {NodeListOf<HTMLInputElement>} */ (part.querySelectorAll("input, select, button")))
      control.disabled = Boolean(film) && !(paper === "scan" && control.closest("details")?.contains($("tone")));
});

// --- Light mix: "NAME=6500K,wratten-80a,2.5".

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
  seen.lights_touched = true;
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
$("seen").hidden = !state.spectral;
$("lens").hidden = state.f_number === null;
$("focus-here").hidden = !state.depth;
$("exposing").hidden = !state.shutter;
$("follows").hidden = state.f_number === null && !state.shutter;
if (state.f_number !== null) Object.assign($("aperture"), { placeholder: state.f_number.toFixed(1), min: state.f_number.toFixed(1) });
for (const o of state.observers) $("observers").append(Object.assign(document.createElement("option"), { value: o.name, label: o.what }));
for (const path of state.profiles) $("proofs").append(Object.assign(document.createElement("option"), { value: path }));
for (const f of state.lens_filters) $("filters").append(Object.assign(document.createElement("option"), { value: f }));

// --- Crop, in pixels of the print.

function crop() {
  const numbers = String(get("develop", "crop") ?? "").split(",").map(Number), width = print_width();
  return numbers.length === 4 ? numbers : [0, 0, width, height_of(width)];
}
function show_crop() {
  const old = $("frame");
  if (old) viewer.removeOverlay(old);
  show_rulers();
  if (!get("develop", "crop") || viewer.world.getItemCount() === 0) return;
  const [x0, y0, x1, y1] = crop().map((n) => n / print_width());
  const frame = Object.assign(document.createElement("div"), { id: "frame", className: "crop" });
  viewer.addOverlay({ element: frame, location: new OpenSeadragon.Rect(x0, y0, x1 - x0, y1 - y0) });
}
/** @param {any} area OpenSeadragon.Rect in widths of the picture */
function crop_to(area) {
  const w = print_width(), h = height_of(w);
  const edge = (/** @type {number} */ v, /** @type {number} */ most) => Math.round(Math.min(Math.max(v * w, 0), most));
  const wanted = [edge(area.x, w), edge(area.y, h), edge(area.x + area.width, w), edge(area.y + area.height, h)];
  if (wanted[0] < wanted[2] && wanted[1] < wanted[3]) put("develop", "crop", wanted.join(","));
  changed();
}
$("cut").addEventListener("click", () => crop_to(viewer.viewport.getBounds(true)));
$("uncut").addEventListener("click", () => { put("develop", "crop", undefined); changed(); });

/** The shape of the paper, as large as fits into the area, gets the pixels that the paper has: so the width of the whole picture follows.
 * @param {any} area OpenSeadragon.Rect in widths of the picture */
function crop_to_paper(area) {
  const dpi = Number($("dpi").value || $("dpi").placeholder), [across, down] = [$("paper-width"), $("paper-height")].map((side) => Math.round(Number(side.value) / 2.54 * dpi));
  if (!(dpi > 0 && across > 0 && down > 0)) return;
  const top = 1 / (state.aspect[0] / state.aspect[1]);
  const x0 = Math.max(area.x, 0), y0 = Math.max(area.y, 0);
  const w = Math.min(area.x + area.width, 1) - x0, h = Math.min(area.y + area.height, top) - y0;
  if (!(w > 0 && h > 0)) return;
  const part = Math.min(w, h * across / down);  // of the picture's width
  const width = Math.ceil(across / part), height = height_of(width);
  const left = Math.round(Math.min((x0 + (w - part) / 2) * width, width - across)), upper = Math.round(Math.min((y0 + (h - part * down / across) / 2) * width, height - down));
  put("develop", "size", width);
  put("develop", "crop", [Math.max(left, 0), Math.max(upper, 0), Math.max(left, 0) + across, Math.max(upper, 0) + Math.min(down, height)].join(","));
  put("convert", "dpi", dpi);
  view = undefined;
  changed();
}
$("to-paper").addEventListener("click", () => crop_to_paper(viewer.viewport.getBounds(true)));
shows.push(() => {
  const dpi = get("convert", "dpi"), width = print_width(), [x0, y0, x1, y1] = crop();
  const cm = (/** @type {number} */ pixels) => (pixels / dpi * 2.54).toFixed(1);
  $("on-paper").textContent = `${x1 - x0} × ${y1 - y0} px${dpi ? `, ${cm(x1 - x0)} × ${cm(y1 - y0)} cm` : ""}, ${(state.samples / (width * height_of(width))).toPrecision(3)} samples each`;
});

function show_rulers() {
  const main = /** @type {HTMLElement} */ ($("picture").parentElement), dpi = get("convert", "dpi"), width = print_width();
  main.classList.toggle("ruled", $("rulers").checked);
  if (!$("rulers").checked) return;
  const origin = viewer.viewport.pixelFromPoint(new OpenSeadragon.Point(0, 0), true);
  const pixel = (viewer.viewport.pixelFromPoint(new OpenSeadragon.Point(1, 0), true).x - origin.x) / width, unit = dpi ? pixel * dpi / 25.4 : pixel;
  const [x0, y0, x1, y1] = crop().map((n) => n * pixel);
  draw_ruler($("ruler-across"), "across", { length: $("picture").clientWidth, zero: origin.x + x0, unit, from: origin.x + x0, to: origin.x + x1 });
  draw_ruler($("ruler-down"), "down", { length: $("picture").clientHeight, zero: origin.y + y0, unit, from: origin.y + y0, to: origin.y + y1 });
  $("ruler-unit").textContent = dpi ? "mm" : "px";
}
$("rulers").addEventListener("change", show_rulers);
viewer.addHandler("update-viewport", show_rulers);
viewer.addHandler("resize", show_rulers);
$("size").addEventListener("change", () => { put("develop", "crop", undefined); view = undefined; });

// --- Probe, and picking a neutral.

/** What the pointer does in the picture. @typedef {"" | "probe" | "pick" | "focus-here" | "brush" | "gradient" | "draw"} Mode */
/** @type {Mode} */
let mode = "";
/** @type {Mode[]} */
const modes = ["probe", "pick", "focus-here", "brush", "gradient", "draw"];
/** @param {Mode} next */
function set_mode(next) {
  mode = mode === next ? "" : next;
  if (mode) $(mode).closest("details").open = true;
  for (const id of modes) $(id).setAttribute("aria-pressed", String(mode === id));
  $("picture").style.cursor = mode ? "crosshair" : "";
}
for (const id of modes) $(id).addEventListener("click", () => set_mode(id));
/** What is probed: a place in widths of the picture. @type {{x: number, y: number} | undefined} */
let probed;
let probed_view = ""; // of the numbers that are shown
const kBins = 47;     // of the spectrum: 10 nm
/** The numbers of the print there, or of a square of its pixels as one. */
async function probe() {
  if (!probed || !view) return undefined;
  const side = Number($("probe-side").value), w = Math.ceil(print_width() / side), pixel = print_width() / w, x = inside(probed.x, w), y = inside(probed.y, height_of(w), w);
  const at = `view=${view}&width=${w}&x=${x}&y=${y}&${in_turn(false)}`, digits = (/** @type {number} */ v) => v.toPrecision(4);
  probed_view = view;
  const p = await ask(`probe?${at}`);
  $("probed").textContent = `${side > 1 ? `${pixel.toFixed(1)} × ${pixel.toFixed(1)} pixels from` : "pixel"} ${Math.round(x * pixel)}, ${Math.round(y * pixel)}: ${Math.round(p.samples)} samples\n` +
    (p.xy ? ["X", "Y", "Z"] : ["R", "G", "B"]).map((c, i) => `${c} ${digits(p.values[i])} ± ${digits(p.standard_errors[i])}`).join("\n") +
    (p.xy ? `\nx, y ${p.xy.map((/** @type {number} */ v) => v.toFixed(4)).join(", ")}` : `\nof ${p.observer}`) + `\nRGB ${p.rgb.join(", ")}`;
  if (state.spectral && mode !== "pick") show_spectrum(await ask(`spectrum?${at}&bins=${kBins}`));
  return p;
}
/** @param {any} spectrum */
function show_spectrum(spectrum) {
  plot_spectrum($("plot"), spectrum);
  const { values, standard_errors, from_nm, to_nm } = spectrum, peak = values.indexOf(Math.max(...values)), nm = (to_nm - from_nm) / values.length;
  const share = 100 * Math.sqrt(standard_errors.reduce((/** @type {number} */ s, /** @type {number} */ e) => s + e * e, 0) / values.reduce((/** @type {number} */ s, /** @type {number} */ v) => s + v * v, 1e-300));
  const text = `most at ${Math.round(from_nm + (peak + 0.5) * nm)} nm: ${short(values[peak], 3)} ± ${short(standard_errors[peak], 2)} W/(m² sr nm); in steps of ${nm} nm, ± ${short(share, 2)} %`;
  $("plot").setAttribute("aria-label", `Spectrum of the light, ${text}`);
  $("spectrum").hidden = false;
  $("spectrum").lastElementChild.textContent = text;
}
/** Numbers never stay from another print. */
async function probe_again() {
  if (!probed || probed_view === view) return;
  try { await probe(); } catch (error) { if (!(/** @type {any} */ (error).superseded)) show_error(error); }
}
$("probe-side").addEventListener("change", () => { probed_view = ""; probe_again(); });

/** @param {{x: number, y: number}} point in widths of the picture */
async function focus_on(point) {
  const w = print_width();
  try {
    const { distance } = await ask(`distance?width=${w}&x=${inside(point.x, w)}&y=${inside(point.y, height_of(w), w)}`);
    put("develop", "focus", typeof distance === "number" ? Number(distance.toPrecision(4)) : distance);
    set_mode("");
    changed();
  } catch (error) {
    show_error(error);
  }
}

/** @param {any} position pixels of the screen */
async function use_pointer(position) {
  if ((mode !== "probe" && mode !== "pick" && mode !== "focus-here") || !view) return;
  const point = viewer.viewport.pointFromPixel(position);
  if (point.x < 0 || point.y < 0 || point.x >= 1 || point.y >= state.aspect[1] / state.aspect[0]) return;
  if (mode === "focus-here") return focus_on(point);
  probed = { x: point.x, y: point.y };
  const old = $("mark");
  if (old) viewer.removeOverlay(old);
  viewer.addOverlay({ element: Object.assign(document.createElement("div"), { id: "mark" }), location: point, placement: OpenSeadragon.Placement.CENTER });
  try {
    const p = await probe();
    if (mode === "pick") {
      if (!p.xy) throw new Error("a neutral can be picked of cie1931 alone");
      put("convert", "white", p.xy.map((/** @type {number} */ v) => v.toFixed(4)).join(","));
      set_mode("");
      changed();
    }
  } catch (error) {
    show_error(error);
  }
}
viewer.addHandler("canvas-click", (/** @type {any} */ event) => { if (event.quick) use_pointer(event.position); });

// --- Noise: the standard error of Y in areas of the print, over it.

const kNoise = [{ from: 0.01, colour: "#4575b4" }, { from: 0.02, colour: "#fee090" }, { from: 0.05, colour: "#fc8d59" }, { from: 0.1, colour: "#d73027" }];
const percent = (/** @type {number} */ v) => `${Number((100 * v).toPrecision(2))} %`;
let noisy_light = ""; // that the map is of
function hide_noise() {
  const old = $("noise-map");
  if (old) viewer.removeOverlay(old);
  $("noise-told").replaceChildren();
  noisy_light = "";
}
async function show_noise() {
  const light = `${light_of(recipe)} ${state.samples}`;
  if (!$("noise").checked) return hide_noise();
  if (!view || light === noisy_light) return;
  if (!noisy_light) $("noise-told").textContent = "measuring …";
  let width = print_width();
  while (Math.max(width, height_of(width)) > 2048) width = Math.ceil(width / 2);
  try {
    const map = await ask(`noise?view=${view}&width=${width}&${in_turn(false)}`), finer = print_width() / width; // pixels have fewer samples
    if (!$("noise").checked) return;
    hide_noise();
    noisy_light = light;
    const canvas = Object.assign(document.createElement("canvas"), { id: "noise-map", width: map.columns, height: map.rows });
    const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    map.relative.forEach((/** @type {number | null} */ relative, /** @type {number} */ i) => {
      const level = kNoise.findLast(({ from }) => (relative ?? 0) * finer >= from);
      if (!level) return;
      context.fillStyle = level.colour;
      context.fillRect(i % map.columns, Math.floor(i / map.columns), 1, 1);
    });
    viewer.addOverlay({ element: canvas, location: new OpenSeadragon.Rect(0, 0, map.columns * map.side / width, map.rows * map.side / width) });
    $("noise-told").append(`Standard error of a pixel: half above ${percent(map.median * finer)}, 5 % above ${percent(map.p95 * finer)}.`);
    for (const { from, colour } of kNoise) {
      const swatch = document.createElement("i");
      swatch.style.background = colour;
      $("noise-told").append(swatch, `from ${percent(from)}`);
    }
    if (get("develop", "denoise")) $("noise-told").append(" Before it is removed.");
    if (finer > 1) $("noise-told").append(` (from pixels ${finer.toPrecision(2)} times as wide)`);
  } catch (error) {
    if (!(/** @type {any} */ (error).superseded)) show_error(error);
  }
}
$("noise").addEventListener("change", show_noise);

// --- Dodge and burn: what the pointer draws becomes a part of the print with light of its own; or its crop.

/** The pixels of the screen that the pointer went through. @type {any[]} */
let drawn = [];
const painting = () => mode === "brush" || mode === "gradient" || mode === "draw";
/** Between the first place and the last, in pixels of the screen. */
function drawn_area() {
  const [a, b] = [drawn[0], drawn[drawn.length - 1]];
  let w = Math.abs(b.x - a.x), h = Math.abs(b.y - a.y);
  if ($("in-shape").checked) {
    const shape = $("paper-width").value / $("paper-height").value;
    w = Math.max(w, h * shape);
    h = w / shape;
  }
  return new OpenSeadragon.Rect(b.x < a.x ? a.x - w : a.x, b.y < a.y ? a.y - h : a.y, w, h);
}
function outline() {
  if (mode !== "draw" || drawn.length < 2) return drawn;
  const area = drawn_area(), corners = [area.getTopLeft(), area.getTopRight(), area.getBottomRight(), area.getBottomLeft()];
  return [...corners, corners[0]];
}
/** The longer side of the picture, where its width is 1. */
const longer = () => Math.max(1, state.aspect[1] / state.aspect[0]);
function show_stroke() {
  const brush = mode === "brush", origin = viewer.viewport.pixelFromPoint(new OpenSeadragon.Point(0, 0), true);
  const one = viewer.viewport.pixelFromPoint(new OpenSeadragon.Point(1, 0), true).x - origin.x;
  const line = $("stroke").firstElementChild, points = drawn.length === 1 ? [drawn[0], drawn[0]] : outline();
  $("stroke").toggleAttribute("hidden", drawn.length === 0);
  line.setAttribute("points", points.map((p) => `${p.x},${p.y}`).join(" "));
  line.setAttribute("stroke-width", String(brush ? 2 * Number($("dodge-radius").value) * longer() * one : 2));
}
viewer.addHandler("canvas-press", (/** @type {any} */ event) => {
  if (!painting()) return;
  drawn = [event.position];
  show_stroke();
});
viewer.addHandler("canvas-drag", (/** @type {any} */ event) => {
  if (!painting() || drawn.length === 0) return;
  event.preventDefaultAction = true;
  const least = 8; // pixels of the screen between two places of a line
  if (mode !== "brush") drawn = [drawn[0], event.position];
  else if (event.position.distanceTo(drawn[drawn.length - 1]) >= least) drawn.push(event.position);
  show_stroke();
});
viewer.addHandler("canvas-drag-end", (/** @type {any} */ event) => { if (painting()) event.preventDefaultAction = true; });
viewer.addHandler("canvas-release", () => {
  const line = drawn, area = line.length > 1 ? drawn_area() : undefined;
  drawn = [];
  show_stroke();
  if (!painting() || line.length === 0 || (mode !== "brush" && !area)) return;
  if (mode === "draw") {
    const chosen = viewer.viewport.viewerElementToViewportRectangle(area);
    set_mode("");
    return $("in-shape").checked ? crop_to_paper(chosen) : crop_to(chosen);
  }
  const top = state.aspect[1] / state.aspect[0], digits = (/** @type {number} */ v) => String(Number(v.toFixed(4)));
  const places = line.flatMap((p) => { const at = viewer.viewport.pointFromPixel(p, true); return [digits(at.x), digits(at.y / top)]; });
  const stops = Number($("dodge-stops").value), radius = Number($("dodge-radius").value);
  put_dodges([...dodges(), mode === "brush" ? `brush:${[stops, radius, ...places]}` : `gradient:${[stops, ...places]}`]);
});
/** @returns {string[]} */
const dodges = () => [get("convert", "dodge") ?? []].flat();
/** @param {string[]} all */
function put_dodges(all) {
  put("convert", "dodge", all.length ? all : undefined);
  changed();
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

// --- Compare: the print that is held lies over the other, left of the divider, or beside it.

const divider = $("divider");
let split = 0.5;
function show_divider() {
  divider.hidden = !held;
  if (!held) return;
  const at = split * $("picture").clientWidth, size = held.getContentSize();
  divider.style.left = `${$("picture").offsetLeft + at}px`;
  divider.setAttribute("aria-valuenow", String(Math.round(100 * split)));
  const x = viewer.viewport.pointFromPixel(new OpenSeadragon.Point(at, 0), true).x * size.x;
  held.setClip(new OpenSeadragon.Rect(0, 0, Math.min(Math.max(x, 0.001), size.x), size.y));
}
viewer.addHandler("update-viewport", show_divider);
let held_view = "", beside = false;
/** Of the held print when it is beside the other. @type {any} */
let follower;
async function show_held() {
  const halves = Boolean(held_view) && beside;
  if (held) viewer.world.removeItem(held);
  held = undefined;
  follower?.world.removeAll();
  /** @type {HTMLElement} */ ($("picture").parentElement).classList.toggle("beside", halves);
  $("beside").hidden = !halves;
  if (halves) {
    follower ??= OpenSeadragon({ ...kViewer, element: $("beside"), mouseNavEnabled: false });
    await add_image(held_view, () => "", follower);
    follow();
  } else if (held_view) {
    held = await add_image(held_view, () => "");
  }
  $("hold").setAttribute("aria-pressed", String(Boolean(held_view)));
  $("halves").setAttribute("aria-pressed", String(halves));
  $("halves").disabled = !held_view;
  show_divider();
}
function follow() {
  if ($("beside").hidden || !follower) return;
  follower.viewport.zoomTo(viewer.viewport.getZoom(true), null, true);
  follower.viewport.panTo(viewer.viewport.getCenter(true), true);
}
viewer.addHandler("update-viewport", follow);
function compare() {
  held_view = held_view ? "" : view ?? "";
  show_held();
}
function halve() {
  beside = !beside;
  show_held();
}
$("hold").addEventListener("click", compare);
$("halves").addEventListener("click", halve);
divider.addEventListener("pointerdown", (/** @type {PointerEvent} */ e) => divider.setPointerCapture(e.pointerId));
divider.addEventListener("pointermove", (/** @type {PointerEvent} */ e) => {
  if (!divider.hasPointerCapture(e.pointerId)) return;
  split = Math.min(Math.max((e.clientX - $("picture").offsetLeft) / $("picture").clientWidth, 0), 1);
  show_divider();
});
divider.addEventListener("keydown", (/** @type {KeyboardEvent} */ e) => {
  const step = e.key === "ArrowLeft" ? -0.02 : e.key === "ArrowRight" ? 0.02 : 0;
  if (step) { split = Math.min(Math.max(split + step, 0), 1); show_divider(); e.stopPropagation(); }
});

// --- Recipes, prints, commands.

/** @param {() => Promise<void>} work */
const carefully = (work) => async () => { try { show_error(""); await work(); } catch (error) { show_error(error); } };

// --- Choices by eye: the print in view, small and of few samples, with each of them.

let sheet = 0; // the last that was opened
/** @param {string} title @param {{name: string, what?: string, recipe: () => Promise<Recipe>, take: () => void}[]} choices */
async function show_sheet(title, choices) {
  const mine = ++sheet, width = 240, share = Math.min(1, Number((3e5 / state.samples).toPrecision(3)));
  $("sheet-title").textContent = title;
  $("find").value = "";
  const buttons = choices.map((choice) => {
    const button = document.createElement("button");
    button.append(Object.assign(document.createElement("img"), { alt: "", width, height: height_of(width) }), choice.name, ...(choice.what ? [document.createElement("br"), Object.assign(document.createElement("small"), { textContent: choice.what })] : []));
    button.addEventListener("click", () => { $("sheet").close(); choice.take(); });
    return button;
  });
  $("thumbnails").replaceChildren(...buttons);
  $("sheet").showModal();
  const waiting = new Set(choices.keys());
  while (waiting.size > 0 && sheet === mine && $("sheet").open) {
    const i = [...waiting].find((n) => !buttons[n].hidden) ?? [...waiting][0], choice = choices[i];
    waiting.delete(i);
    try {
      const whole = await choice.recipe(), develop = { ...whole.develop };
      delete develop.size;
      delete develop.crop;
      const made = await ask("views", { method: "POST", body: JSON.stringify(at_stage({ ...whole, develop }, { share, mixed: false })) });
      const image = /** @type {HTMLImageElement} */ (buttons[i].firstChild);
      image.src = new URL(`api/tile?view=${made.view}&width=${width}&area=0,0,${width},${height_of(width)}`, location.href).href;
      image.alt = `The print with ${choice.name}`;
      await image.decode();
    } catch (error) {
      buttons[i].title = String(/** @type {any} */ (error).message);
      buttons[i].append(document.createElement("br"), Object.assign(document.createElement("small"), { textContent: buttons[i].title }));
    }
  }
}
$("find").addEventListener("input", () => {
  const words = $("find").value.toLowerCase().split(/\s+/);
  for (const button of $("thumbnails").children) button.hidden = !words.every((/** @type {string} */ word) => button.textContent.toLowerCase().includes(word));
});
$("eye-filters").addEventListener("click", () => show_sheet("Filters in front of the lens", state.lens_filters.map((/** @type {string} */ name) => {
  const behind = () => ({ ...recipe, develop: { ...recipe.develop, "lens-filter": name } });
  return { name, recipe: async () => behind(), take: () => { recipe = behind(); changed(); } };
})));
$("eye-films").addEventListener("click", () => show_sheet("Films, scanned, and looks of film and paper", [
  ...state.looks.map((/** @type {any} */ l) => ({ name: l.name, what: `${l.film}: ${l.what}`, recipe: async () => on_film(recipe, { film: l.film, look: l.name }), take: () => choose_film({ film: l.film, look: l.name }) })),
  ...state.films.map((/** @type {any} */ f) => ({ name: f.name, what: f.what, recipe: async () => on_film(recipe, { film: f.name, paper: "scan" }), take: () => choose_film({ film: f.name, paper: "scan" }) })),
]));
$("eye-observers").addEventListener("click", () => show_sheet("Observers, cameras and black-and-white films", state.observers.map((/** @type {any} */ o) => {
  const seen_by = () => { const from = on_film(recipe, {}); return { ...from, develop: { ...from.develop, observer: o.name } }; };
  return { name: o.name, what: o.what, recipe: async () => seen_by(), take: () => { recipe = seen_by(); changed(); } };
})));
const read_recipe = (/** @type {string} */ name) => ask(`recipes/${encodeURIComponent(name)}`);
$("eye-recipes").addEventListener("click", carefully(async () => show_sheet("Saved recipes", (await ask("recipes")).map((/** @type {string} */ name) => (
  { name, recipe: () => read_recipe(name), take: () => load_recipe(name) })))));
async function load_recipe(/** @type {string} */ name) {
  recipe = await read_recipe(name);
  $("name").value = name;
  $("recipes").value = name;
  show_names();
  view = undefined;
  changed();
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
$("print").addEventListener("click", carefully(async () => {
  const name = `${$("name").value}.${$("format").value}`;
  await ask("prints", { method: "POST", body: JSON.stringify({ name, recipe, replace: $("replace").checked }) });
  await show_prints();
}));
$("copy").addEventListener("click", carefully(async () => {
  await navigator.clipboard.writeText(commands);
  $("status").textContent = "copied";
}));
let watching = false;
async function show_prints() {
  if (watching) return;
  watching = true;
  for (;;) {
    const jobs = await ask("prints");
    $("jobs").replaceChildren(...jobs.map((/** @type {any} */ job) => {
      const percent = job.done === null ? "" : ` ${Math.round(100 * job.done)} %`;
      const line = Object.assign(document.createElement("li"), { textContent: `${job.name}: ${job.message && job.state === "running" ? "" : job.state} ${job.message}${percent} ` });
      if (job.state === "waiting" || job.state === "running") {
        const stop = line.appendChild(Object.assign(document.createElement("button"), { textContent: "Cancel" }));
        stop.addEventListener("click", () => ask(`prints/${job.id}`, { method: "DELETE" }));
      }
      if (job.state === "running") {
        const bar = Object.assign(document.createElement("progress"), { max: 1 });
        if (job.done !== null) bar.value = job.done;
        line.append(bar);
      }
      return line;
    }));
    if (!jobs.some((/** @type {any} */ job) => job.state === "waiting" || job.state === "running")) break;
    await new Promise((later) => setTimeout(later, 500));
  }
  watching = false;
}

// --- The rest.

$("undo").addEventListener("click", () => go(place - 1));
$("redo").addEventListener("click", () => go(place + 1));
$("reset").addEventListener("click", () => { recipe = { "latent-recipe": 1 }; view = undefined; changed(); });
$("fit").addEventListener("click", () => viewer.viewport.goHome());
$("one").addEventListener("click", () => viewer.viewport.zoomTo(print_width() / $("picture").clientWidth / devicePixelRatio));
$("help").addEventListener("click", () => $("keys").showModal());
const surround = () => {
  const grey = Math.round(2.55 * $("surround").value);
  document.documentElement.style.setProperty("--surround", `rgb(${grey}, ${grey}, ${grey})`);
};
$("surround").addEventListener("input", surround);
surround();
document.addEventListener("keydown", (event) => {
  const typing = event.target instanceof HTMLInputElement && !["range", "checkbox"].includes(event.target.type);
  if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z" && !typing) {
    event.preventDefault();
    go(place + (event.shiftKey ? 1 : -1));
    return;
  }
  if (typing || event.ctrlKey || event.metaKey || event.altKey) return;
  const third = (/** @type {number} */ sign) => {
    put("convert", "stops", Number((Number(get("convert", "stops") ?? 0) + sign / 3).toFixed(2)) || undefined);
    changed();
  };
  /** @type {{[key: string]: () => void}} */
  const keys = {
    "?": () => $("keys").showModal(), ",": () => third(-1), ".": () => third(1), f: () => viewer.viewport.goHome(), 1: () => $("one").click(),
    c: compare, s: () => $("halves").click(), n: () => $("noise").click(), r: () => $("rulers").click(), x: () => set_mode("draw"), d: () => set_mode("brush"), p: () => set_mode("probe"),
    Enter: () => { if (event.target === viewer.canvas || event.target === document.body) use_pointer(viewer.viewport.pixelFromPoint(viewer.viewport.getCenter())); }, Escape: () => set_mode(""),
  };
  keys[event.key]?.();
});

show_samples();
show_controls();
update();
