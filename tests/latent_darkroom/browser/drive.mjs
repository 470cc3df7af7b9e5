// Drives the darkroom's page with Chromium, and tells what it shows after each step.
// Usage: node drive.mjs ADDRESS FOLDER WIDTHxHEIGHT < STEPS
// STEPS: a JSON list. Each step is one of
//   {"set": {"stops": 1}}      controls by their ids or selectors, as hands would set them (true: a check box is clicked)
//   {"click": "undo"}          a button; or an element's selector, {"click": "#groups button"}
//   {"key": "."}               a key
//   {"at": [x, y]}             a click into the window
//   {"shot": "a.png"}          saves what is seen into FOLDER
// and the page is waited for after each. Prints a JSON list: for each step {"recipe", "tile" (base64 of the raw pixels of the whole
// print, at most 512 wide), "error", "text" of the panel}. Chromium is driven over its DevTools pipe; only Node.js is needed.
import { spawn } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const [address, folder, size] = process.argv.slice(2);
const [width, height] = size.split("x").map(Number);
const steps = JSON.parse(readFileSync(0, "utf8"));
const chromium = spawn("chromium", [
  "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
  "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage", "--force-color-profile=srgb",
  `--user-data-dir=${join(folder, "chromium")}`, "--remote-debugging-pipe", "about:blank",
], { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
const done = new Promise((end) => chromium.on("exit", end));

// Commands and answers are JSON texts that end in a zero byte.
let count = 0, session, pending = "";
const answers = new Map(), complaints = [];
function send(method, params = {}) {
  const id = ++count;
  chromium.stdio[3].write(JSON.stringify({ id, method, params, ...(session ? { sessionId: session } : {}) }) + "\0");
  return new Promise((good, bad) => answers.set(id, { good, bad, method }));
}
chromium.stdio[4].on("data", (data) => {
  const texts = (pending + data).split("\0");
  pending = texts.pop();
  for (const text of texts) {
    const message = JSON.parse(text);
    if (message.method === "Runtime.exceptionThrown") complaints.push(message.params.exceptionDetails.exception?.description);
    if (message.method === "Log.entryAdded" && message.params.entry.source !== "network") complaints.push(message.params.entry.text);
    const waiting = answers.get(message.id);
    if (!waiting) continue;
    answers.delete(message.id);
    if (message.error) waiting.bad(new Error(`${waiting.method}: ${message.error.message}`));
    else waiting.good(message.result);
  }
});
async function evaluate(expression) {
  const { result, exceptionDetails } = await send("Runtime.evaluate", { expression, returnByValue: true, awaitPromise: true });
  if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
  return result.value;
}
const pause = (ms) => new Promise((later) => setTimeout(later, ms));
async function settled() {
  for (let still = 0; still < 3;) {
    await pause(60);
    still = (await evaluate("document.readyState === 'complete' && Boolean(document.body.dataset.settled)")) ? still + 1 : 0;
  }
}
async function click(x, y) {
  const place = { x, y, button: "left", clickCount: 1 };
  await send("Input.dispatchMouseEvent", { type: "mouseMoved", x, y });
  await send("Input.dispatchMouseEvent", { type: "mousePressed", ...place });
  await send("Input.dispatchMouseEvent", { type: "mouseReleased", ...place });
}
const selector = (name) => (/^[\w-]+$/.test(name) ? "#" + name : name);
async function take(step) {
  if (step.set) {
    for (const [id, value] of Object.entries(step.set)) {
      await evaluate(`{ const c = document.querySelector(${JSON.stringify(selector(id))}); const v = ${JSON.stringify(value)};
        if (c.type === "checkbox") c.click();
        else { c.value = v; c.dispatchEvent(new Event("input", { bubbles: true })); c.dispatchEvent(new Event("change", { bubbles: true })); } }`);
    }
  }
  if (step.click) {
    const [x, y] = await evaluate(`{ const e = document.querySelector(${JSON.stringify(selector(step.click))});
      e.scrollIntoView({ block: "center" }); const r = e.getBoundingClientRect(); [r.x + r.width / 2, r.y + r.height / 2] }`);
    await click(x, y);
  }
  if (step.key) {
    await send("Input.dispatchKeyEvent", { type: "keyDown", key: step.key, text: step.key });
    await send("Input.dispatchKeyEvent", { type: "keyUp", key: step.key });
  }
  if (step.at) await click(...step.at);
  await pause(500); // glides and answers that change no view
  await settled();
  if (step.shot) {
    const { data } = await send("Page.captureScreenshot", { format: "png" });
    writeFileSync(join(folder, step.shot), Buffer.from(data, "base64"));
  }
}

const limit = setTimeout(() => { console.error("drive.mjs: not done within 250 s"); chromium.kill("SIGKILL"); process.exit(1); }, 250000);
try {
  const { targetId } = await send("Target.createTarget", { url: "about:blank" });
  session = (await send("Target.attachToTarget", { targetId, flatten: true })).sessionId;
  await send("Runtime.enable");
  await send("Log.enable");
  await send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: false });
  await send("Page.navigate", { url: address });
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
      return { view, width: w, tile: btoa(text), error: document.getElementById("error").textContent,
               probed: document.getElementById("probed").textContent, jobs: document.getElementById("jobs").textContent,
               clipping: document.getElementById("clipping").textContent };
    })()`));
  }
  console.log(JSON.stringify({ seen, complaints }));
  session = undefined;
  await send("Browser.close");
} catch (error) {
  console.error(`drive.mjs: ${error.message} ${complaints.join("; ")}`);
  chromium.kill("SIGKILL");
  process.exitCode = 1;
}
clearTimeout(limit);
await done;
