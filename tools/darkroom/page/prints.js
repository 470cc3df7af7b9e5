// Prints that are made in the folder of the server, and the commands that make them.
// @ts-check
import { $, carefully } from "./dom.js";
import { commands } from "./picture.js";
import { recipe } from "./recipe.js";
import { ask, state } from "./server.js";

$("name").value = String(state.inputs[0]).replace(/\.latent$/, "");
$("folder").textContent = `Recipes and prints are in ${state.folder}`;
$("to-print").addEventListener("click", () => {
  $("prints").open = true;
  $("prints").scrollIntoView({ behavior: "smooth" });
  $("name").focus({ preventScroll: true });
});

$("print").addEventListener("click", carefully(async () => {
  const name = `${$("name").value}.${$("format").value}`;
  await ask("prints", { method: "POST", body: JSON.stringify({ name, recipe, replace: $("replace").checked }) });
  await show_prints();
  $("jobs").scrollIntoView({ block: "nearest" });
}));
$("copy").addEventListener("click", carefully(async () => {
  await navigator.clipboard.writeText(commands);
  $("status").textContent = "copied";
  setTimeout(() => { $("status").textContent = ""; }, 3000);
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
