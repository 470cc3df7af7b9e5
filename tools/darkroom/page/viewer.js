// The picture: levels of a pyramid over the film, each developed at its own size.
// @ts-check
/* global OpenSeadragon */
import { $, show_error } from "./dom.js";
import { get } from "./recipe.js";
import { state, turn } from "./server.js";

const kTile = 512;
export const kViewer = {
  drawer: "canvas", showNavigationControl: false, immediateRender: true, imageLoaderLimit: 3, timeout: 600000,
  gestureSettingsMouse: { clickToZoom: false }, maxZoomPixelRatio: 16, minZoomImageRatio: 0.5, animationTime: 0.3, visibilityRatio: 0.2,
  imageSmoothingEnabled: false, subPixelRoundingForTransparency: OpenSeadragon.SUBPIXEL_ROUNDING_OCCURRENCES.ALWAYS,
};
export const viewer = OpenSeadragon({ ...kViewer, element: $("picture") });

// A picture that is in view as a whole stays so when the window, or the part of it for the picture, gets another size.
let fits = true;
viewer.addHandler("animation-finish", () => { fits = Math.abs(viewer.viewport.getZoom() / viewer.viewport.getHomeZoom() - 1) < 0.01; });
viewer.addHandler("resize", () => { if (fits) requestAnimationFrame(() => viewer.viewport.goHome(true)); });  // after the viewer's own zoom

/** @param {number} width */
export const height_of = (width) => Math.max(1, Math.round(width / (state.aspect[0] / state.aspect[1])));
export const print_width = () => parseInt(get("develop", "size") ?? state.width, 10) || state.width;

/** A pixel inside. @param {number} v @param {number} most */
export const inside = (v, most, scale = most) => Math.floor(Math.min(Math.max(v * scale, 0), most - 1));

/** How often a width is halved to the coarsest level. @param {number} width */
const halvings = (width) => Math.max(0, Math.ceil(Math.log2(width / 256)));
/** The width of the level in view: as the viewer chooses it. */
export function seen_width() {
  const width = print_width(), screen = viewer.viewport.deltaPixelsFromPointsNoRotate(new OpenSeadragon.Point(1, 0)).x * OpenSeadragon.pixelDensityRatio;
  let n = 0;
  while (n < halvings(width) && 2 * screen < width / 2 ** n) ++n;
  return Math.ceil(width / 2 ** n);
}

/** @param {string} id @param {number} width @param {() => string} how */
function source_of(id, width, how) {
  const height = height_of(width), levels = halvings(width);
  return {
    width, height, tileSize: kTile, tileOverlap: 1,  // without, tiles are drawn a pixel too large
    minLevel: 0, maxLevel: levels,
    getTileUrl: (/** @type {number} */ level, /** @type {number} */ x, /** @type {number} */ y) => {
      const w = Math.ceil(width / 2 ** (levels - level)), h = height_of(w);
      const x0 = Math.min(x * kTile, w - 1), y0 = Math.min(y * kTile, h - 1);
      const area = [Math.max(x0 - 1, 0), Math.max(y0 - 1, 0), Math.min(x0 + kTile + 1, w), Math.min(y0 + kTile + 1, h)];
      return new URL(`api/tile?view=${id}&width=${w}&area=${area}&${how()}`, location.href).href;
    },
  };
}

/** @param {any} item */
export function loaded(item) {
  return new Promise((done) => {
    const ready = () => item.getFullyLoaded() && (item.removeHandler("fully-loaded-change", ready), done(undefined));
    item.addHandler("fully-loaded-change", ready);
    ready();
  });
}

/** @param {string} id @param {() => string} how @returns {Promise<any>} */
export const add_image = (id, how, to = viewer) => new Promise((success, failure) =>
  to.addTiledImage({ tileSource: source_of(id, print_width(), how), x: 0, y: 0, width: 1, success: (/** @type {any} */ e) => success(e.item), error: failure }));

/** An element over a part of the picture, which hides what of it lies outside of the picture.
 * @param {string} id @param {string} tag @param {{[key: string]: any}} properties @param {number[]} part x0, y0, x1, y1 in widths of the picture
 * @returns {any} */
export function lay_over(id, tag, properties, [x0, y0, x1, y1]) {
  const cover = Object.assign(document.createElement("div"), { id, className: "cover" }), top = state.aspect[1] / state.aspect[0];
  const element = cover.appendChild(Object.assign(document.createElement(tag), properties));
  const percent = (/** @type {number} */ v) => `${100 * v}%`;
  Object.assign(element.style, { left: percent(x0), top: percent(y0 / top), width: percent(x1 - x0), height: percent((y1 - y0) / top) });
  viewer.addOverlay({ element: cover, location: new OpenSeadragon.Rect(0, 0, 1, top) });
  return element;
}
/** @param {string} id */
export function take_off(id) {
  const cover = document.getElementById(id);
  if (cover) viewer.removeOverlay(cover);
}

viewer.addHandler("tile-load-failed", async (/** @type {any} */ event) => {
  const url = new URL(event.tile.getUrl()), asked = url.searchParams.get("turn");
  if (asked && Number(asked) !== turn) return;
  const response = await fetch(url);
  if (!response.ok) show_error((await response.json()).error);
});
