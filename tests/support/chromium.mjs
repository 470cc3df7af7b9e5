// Chromium, driven over its DevTools pipe. Only Node.js is needed.
import { spawn } from "node:child_process";
import { writeFileSync } from "node:fs";
import { join } from "node:path";

// Starts it with a profile in `folder`. `onEvent(method, params)` gets what it tells without being asked.
export function startChromium(folder, onEvent, options = []) {
  const chromium = spawn("chromium", [
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage", "--force-color-profile=srgb",
    ...options, `--user-data-dir=${join(folder, "chromium")}`, "--remote-debugging-pipe", "about:blank",
  ], { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
  const done = new Promise((end) => chromium.on("exit", end));

  // Commands and answers are JSON texts that end in a zero byte.
  let count = 0, session, pending = "";
  const answers = new Map();
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
      onEvent(message.method, message.params);
      const waiting = answers.get(message.id);
      if (!waiting) continue;
      answers.delete(message.id);
      if (message.error) waiting.bad(new Error(`${waiting.method}: ${message.error.message}`));
      else waiting.good(message.result);
    }
  });
  return {
    send, done,
    kill: () => chromium.kill("SIGKILL"),
    // A page of this size, which gets what is sent from now on. `domains`: those that shall tell of events.
    async open(address, width, height, domains) {
      const { targetId } = await send("Target.createTarget", { url: "about:blank" });
      session = (await send("Target.attachToTarget", { targetId, flatten: true })).sessionId;
      for (const domain of domains) await send(`${domain}.enable`);
      await send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: false });
      await send("Page.navigate", { url: address });
    },
    async close() {
      session = undefined;
      await send("Browser.close");
    },
    // The value of an expression in the page, awaited if it is a promise.
    async evaluate(expression) {
      const { result, exceptionDetails } = await send("Runtime.evaluate", { expression, returnByValue: true, awaitPromise: true });
      if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
      return result.value;
    },
    async click(x, y) {
      const place = { x, y, button: "left", clickCount: 1 };
      await send("Input.dispatchMouseEvent", { type: "mouseMoved", x, y });
      await send("Input.dispatchMouseEvent", { type: "mousePressed", ...place });
      await send("Input.dispatchMouseEvent", { type: "mouseReleased", ...place });
    },
    async drag(places) {
      for (const [i, [x, y]] of places.entries())
        await send("Input.dispatchMouseEvent", { type: i === 0 ? "mousePressed" : "mouseMoved", x, y, button: "left", buttons: 1, clickCount: 1 });
      const [x, y] = places[places.length - 1];
      await send("Input.dispatchMouseEvent", { type: "mouseReleased", x, y, button: "left", clickCount: 1 });
    },
    async screenshot(path) {
      const { data } = await send("Page.captureScreenshot", { format: "png" });
      writeFileSync(path, Buffer.from(data, "base64"));
    },
  };
}
