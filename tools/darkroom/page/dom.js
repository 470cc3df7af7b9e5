// Elements of the page, and what it says.
// @ts-check

/** @param {string} id @returns {any} */
export const $ = (id) => document.getElementById(id);

/** What was given up for something newer is no error. @param {any} error */
export function show_error(error) {
  if (error?.superseded) return;
  $("error").textContent = error ? String(error.message ?? error) : "";
  $("error").hidden = !error;
}

/** @param {() => Promise<void>} work */
export const carefully = (work) => async () => { try { show_error(""); await work(); } catch (error) { show_error(error); } };

/** @param {string} text */
export function badge(text) {
  $("badge").textContent = text;
  $("badge").hidden = !text;
}

export const signed = (/** @type {number} */ v) => (v > 0 ? "+" : "") + v.toFixed(2);
