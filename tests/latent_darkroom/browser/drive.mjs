// Drives the darkroom's page with Chromium, and tells what it shows after each step.
// Usage: node drive.mjs ADDRESS FOLDER WIDTHxHEIGHT < STEPS
// STEPS: a JSON list. Each step is one of
//   {"set": {"stops": 1}}      controls by their ids or selectors, as hands would set them (true: a check box is clicked; a list: a
//                              slider is moved through these)
//   {"click": "undo"}          a button; or an element's selector, {"click": "#groups button"}
//   {"key": "."}               a key
//   {"wait": ".a"}             until there is such an element
//   {"at": [x, y]}             a click into the window
//   {"drag": [[x, y], ...]}    the pointer goes through these places of the window
//   {"shot": "a.png"}          saves what is seen into FOLDER
//   {"tell": ".a"}             the texts of such elements, their attributes, and their places in the window
// and the page is waited for after each. Prints a JSON list: for each step {"recipe", "tile" (base64 of the raw pixels of the whole
// print, at most 512 wide), "mixed" (how many tiles of light mixes were seen so far), "error", "told" (a list of elements)}.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { startChromium } from "../../support/chromium.mjs";

const [address, folder, size] = process.argv.slice(2);
const [width, height] = size.split("x").map(Number);
const steps = JSON.parse(readFileSync(0, "utf8"));
const complaints = [];
const chromium = startChromium(folder, (method, params) => {
  if (method === "Runtime.exceptionThrown") complaints.push(params.exceptionDetails.exception?.description);
  if (method === "Log.entryAdded" && params.entry.source !== "network") complaints.push(params.entry.text);
});
const { send, evaluate, click } = chromium;
const pause = (ms) => new Promise((later) => setTimeout(later, ms));
async function settled() {
  for (let still = 0; still < 3;) {
    await pause(60);
    still = (await evaluate("document.readyState === 'complete' && Boolean(document.body.dataset.settled)")) ? still + 1 : 0;
  }
}
const selector = (name) => (/^[\w-]+$/.test(name) ? "#" + name : name);
async function take(step) {
  if (step.set) {
    for (const [id, value] of Object.entries(step.set)) {
      const control = `document.querySelector(${JSON.stringify(selector(id))})`;
      if (value === true) {
        await evaluate(`${control}.click()`);
        continue;
      }
      for (const v of [value].flat()) {
        await evaluate(`${control}.value = ${JSON.stringify(v)}; ${control}.dispatchEvent(new Event("input", { bubbles: true }))`);
        if (Array.isArray(value)) await pause(300);
      }
      await evaluate(`${control}.dispatchEvent(new Event("change", { bubbles: true }))`);
    }
  }
  if (step.click) {
    const [x, y] = await evaluate(`{ const e = document.querySelector(${JSON.stringify(selector(step.click))});
      e.closest("details")?.setAttribute("open", "");
      e.scrollIntoView({ block: "center" }); const r = e.getBoundingClientRect(); [r.x + r.width / 2, r.y + r.height / 2] }`);
    await click(x, y);
  }
  if (step.key) {
    await send("Input.dispatchKeyEvent", { type: "keyDown", key: step.key, text: step.key });
    await send("Input.dispatchKeyEvent", { type: "keyUp", key: step.key });
  }
  for (let waited = 0; step.wait && !(await evaluate(`Boolean(document.querySelector(${JSON.stringify(step.wait)}))`)); ++waited) {
    if (waited > 600) throw new Error(`${step.wait} does not come`);
    await pause(100);
  }
  if (step.at) await click(...step.at);
  if (step.drag) await chromium.drag(step.drag);
  await pause(500); // glides and answers that change no view
  await settled();
  if (step.shot) {
    await chromium.screenshot(join(folder, step.shot));
  }
}

const limit = setTimeout(() => { console.error("drive.mjs: not done within 250 s"); chromium.kill(); process.exit(1); }, 250000);
try {
  await chromium.open(address, width, height, ["Runtime", "Log"]);
  await evaluate("performance.setResourceTimingBufferSize(100000)");
  await settled();
  const seen = [];
  for (const step of steps) {
    await take(step);
    seen.push(await evaluate(`(async () => {
      const view = document.body.dataset.settled, state = await (await fetch("api/state")).json(), w = Math.min(512, state.width);
      const h = Math.max(1, Math.round(w / (state.aspect[0] / state.aspect[1])));
      const raw = new Uint8Array(await (await fetch(\`api/tile?view=\${view}&width=\${w}&area=0,0,\${w},\${h}&format=raw\`)).arrayBuffer());
      let text = "";
      for (const byte of raw) text += String.fromCharCode(byte);
      const told = [...document.querySelectorAll(${JSON.stringify(step.tell ?? "no-such-element")})].map((e) => (
        { text: e.textContent, rect: e.getBoundingClientRect().toJSON(), ...Object.fromEntries([...e.attributes].map((a) => [a.name, a.value])) }));
      return { view, told, recipe: JSON.parse(document.body.dataset.recipe), width: w, tile: btoa(text), error: document.getElementById("error").textContent,
               probed: document.getElementById("probed").textContent, jobs: document.getElementById("jobs").textContent,
               mixed: performance.getEntriesByType("resource").filter((e) => /tile.*mixed=1/.test(e.name) && !e.name.includes("raw")).length,
               clipping: document.getElementById("clipping").textContent };
    })()`));
  }
  console.log(JSON.stringify({ seen, complaints }));
  await chromium.close();
} catch (error) {
  console.error(`drive.mjs: ${error.message} ${complaints.join("; ")}`);
  chromium.kill();
  process.exitCode = 1;
}
clearTimeout(limit);
await chromium.done;
