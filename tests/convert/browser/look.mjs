// Looks at the page beside a Deep Zoom pyramid with Chromium, from the disk, as by double click.
// Usage: node look.mjs PAGE.html FOLDER X,Y,SCALE...
//   1. opens the page and waits until it shows the whole picture;
//   2. turns the wheel over the middle to zoom in;
//   3. goes to each #X,Y,SCALE and saves what is seen there as FOLDER/seen-0.png (800 x 600), seen-1.png, ...
//   4. (a page that compares) drags the divider from the middle to three quarters of the window, before 3.;
//   5. clicks into the middle of the navigator, which the views leave out.
// Prints one JSON object: the deepest level asked for before and after turning the wheel, tiles asked for, the address left by the
// wheel, the title, where the navigator is, and the pixel in the middle of the window after the click.
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { startChromium } from "../../support/chromium.mjs";

const [page, folder, ...views] = process.argv.slice(2);
const tiles = [];
const chromium = startChromium(folder, (method, params) => {
  if (method === "Network.requestWillBeSent") tiles.push(params.request.url);
}, ["--hide-scrollbars"]);
const { send, evaluate } = chromium;
// Until the picture stands still and all its tiles are there.
async function settled() {
  for (let still = 0; still < 3;) {
    await new Promise((later) => setTimeout(later, 100));
    const ready = await evaluate(`typeof viewer === "object" && viewer.world.getItemCount() === (picture.other ? 2 : 1)
      && [...Array(viewer.world.getItemCount()).keys()].every((i) => viewer.world.getItemAt(i).getFullyLoaded() || viewer.world.getItemAt(i).getOpacity() === 0)
      && Math.abs(viewer.viewport.getZoom(true) - viewer.viewport.getZoom(false)) < 1e-9`);
    still = ready ? still + 1 : 0;
  }
}
const levels = () => tiles.map((url) => /_files\/(\d+)\/\d+_\d+\./.exec(url)).filter(Boolean).map((match) => Number(match[1]));

const limit = setTimeout(() => { console.error("look.mjs: no picture within 250 s"); chromium.kill(); process.exit(1); }, 250000);
try {
  await chromium.open(pathToFileURL(resolve(page)).href, 800, 600, ["Network"]);
  await settled();
  const before = Math.max(...levels());
  for (let i = 0; i < 8; ++i) {
    await send("Input.dispatchMouseEvent", { type: "mouseWheel", x: 400, y: 300, deltaX: 0, deltaY: -120 });
    await new Promise((later) => setTimeout(later, 60));
  }
  await settled();
  const after = Math.max(...levels());
  const address = await evaluate("location.hash");
  await evaluate(`document.querySelector("nav").remove()`);
  const title = await evaluate("document.title");
  let split;
  if (await evaluate("Boolean(picture.other)")) {
    const drag = (type, x) => send("Input.dispatchMouseEvent", { type, x, y: 200, button: "left", buttons: 1, clickCount: 1 });
    await drag("mousePressed", 402);
    await drag("mouseMoved", 500);
    await drag("mouseMoved", 600);
    await drag("mouseReleased", 600);
    split = await evaluate("split");
    await evaluate(`divider.style.visibility = "hidden"`);
  }
  await evaluate(`viewer.navigator.element.style.visibility = "hidden"`);
  for (const [index, view] of views.entries()) {
    await evaluate(`location.hash = ${JSON.stringify("#" + view)}`);
    await settled();
    await chromium.screenshot(join(folder, `seen-${index}.png`));
  }
  await evaluate(`viewer.navigator.element.style.visibility = "visible"`);
  const map = await evaluate(`(({ x, y, width, height }) => ({ x, y, width, height }))(viewer.navigator.element.getBoundingClientRect())`);
  await chromium.click(map.x + map.width / 2, map.y + map.height / 2);
  await new Promise((later) => setTimeout(later, 2500));  // it glides there for 1.2 s
  const middle = await evaluate(`(({ x, y }) => [x * picture.width, y * picture.width])(viewer.viewport.getCenter(true))`);
  console.log(JSON.stringify({ before, after, tiles: levels().length, address, title, map, middle, split }));
  await chromium.close();
} catch (error) {
  console.error(`look.mjs: ${error.message}`);
  chromium.kill();
  process.exitCode = 1;
}
await chromium.done;
clearTimeout(limit);
