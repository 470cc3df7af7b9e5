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

/** @param {number} width */
export const height_of = (width) => Math.max(1, Math.round(width / (state.aspect[0] / state.aspect[1])));
export const print_width = () => parseInt(get("develop", "size") ?? state.width, 10) || state.width;

export let seen_width = 0; // of the level that tiles were last asked of

/** A pixel inside. @param {number} v @param {number} most */
export const inside = (v, most, scale = most) => Math.floor(Math.min(Math.max(v * scale, 0), most - 1));

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

viewer.addHandler("tile-load-failed", async (/** @type {any} */ event) => {
  const url = new URL(event.tile.getUrl()), asked = url.searchParams.get("turn");
  if (asked && Number(asked) !== turn) return;
  const response = await fetch(url);
  if (!response.ok) show_error((await response.json()).error);
});
