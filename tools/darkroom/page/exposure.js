// Exposure, white, tone, and how colours are printed.
// @ts-check
import { bind } from "./bind.js";
import { $, signed } from "./dom.js";
import { changed, get, put, shows } from "./recipe.js";
import { state } from "./server.js";

bind("stops", "convert", "stops", 0, signed);
bind("tone", "convert", "tone", "film");
bind("contrast", "convert", "contrast", 1, (v) => v.toFixed(2));
bind("black", "convert", "black", 0, (v) => v.toFixed(3));
bind("gamut", "convert", "gamut", "luminance");
bind("profile", "convert", "profile", "srgb");
bind("proof", "convert", "proof", "");
bind("intent", "convert", "intent", "perceptual");

shows.push(() => {
  const sensitivity = get("convert", "sensitivity");
  $("sensitivity").textContent = sensitivity ? `sensitivity ${Number(sensitivity).toPrecision(4)}` : "";
});
/** Takes the place of how bright the print was. @param {"auto" | "exposure"} key @param {any} value */
function expose(key, value) {
  for (const other of ["sensitivity", "key", "auto", "exposure"]) put("convert", other, undefined);
  put("convert", key, value);
  changed();
}
$("auto").addEventListener("click", () => expose("auto", true));

// The exposure of a camera: "iso:100,time:1/125,f:8". One that is set brings the others; one that is emptied ends it.
const settings = [["iso", "iso", "100"], ["time", "time", "1/125"], ["f-number", "f", "8"]];
for (const [id] of settings) {
  $(id).addEventListener("change", () => {
    const all = settings.map(([other, name, usual]) => `${name}:${$(other).value.trim() || usual}`);
    expose("exposure", $(id).value.trim() ? all.join(",") : undefined);
  });
}
shows.push(() => {
  const parts = new Map(String(get("convert", "exposure") ?? "").split(",").map((part) => /** @type {[string, string]} */ (part.split(":"))));
  for (const [id, name] of settings) $(id).value = parts.get(name) ?? "";
});

$("clipped").addEventListener("change", () => { put("convert", "show", $("clipped").checked ? "clipped" : undefined); changed(); });
shows.push(() => { $("clipped").checked = get("convert", "show") === "clipped"; });

for (const light of state.lights) $("white").querySelector('[value="kelvin"]').before(Object.assign(new Option(light.name), { title: light.what }));
shows.push(() => {
  const white = String(get("convert", "white") ?? ""), kelvin = /^(\d+(\.\d+)?)[kK]$/.exec(white);
  if (kelvin) $("kelvin").value = kelvin[1];
  const named = [...$("white").options].some((o) => o.value === white);
  $("white").value = kelvin ? "kelvin" : named ? white : "picked";
  $("white").querySelector('[value="picked"]').textContent = `picked: ${white}`;
  $("kelvin").nextElementSibling.textContent = kelvin ? `${$("kelvin").value} K` : "–";
});
$("white").addEventListener("change", () => {
  put("convert", "white", $("white").value === "kelvin" ? `${$("kelvin").value}K` : $("white").value);
  changed();
});
$("kelvin").addEventListener("input", () => { put("convert", "white", `${$("kelvin").value}K`); changed(); });

for (const path of state.profiles) $("proofs").append(Object.assign(document.createElement("option"), { value: path }));
