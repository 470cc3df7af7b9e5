// Compare: the print that is held lies over the other, left of the divider, or beside it.
// @ts-check
/* global OpenSeadragon */
import { $ } from "./dom.js";
import { view } from "./picture.js";
import { add_image, kViewer, viewer } from "./viewer.js";

/** The print that is compared with, under the divider. @type {any} */
let held;
viewer.world.addHandler("add-item", () => { if (held) viewer.world.setItemIndex(held, viewer.world.getItemCount() - 1); });
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
export function compare() {
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
