// What the page asks of the server.
// @ts-check

/** @param {string} path @param {RequestInit} [how] */
export async function ask(path, how) {
  const response = await fetch("api/" + path, how);
  const json = await response.json();
  if (!response.ok) throw Object.assign(new Error(json.error ?? response.statusText), { superseded: response.status === 410 });
  return json;
}

export const state = await ask("state");

// What was asked for in an earlier turn, the server gives up: each wish begins a turn.
const tab = Math.random().toString(36).slice(2);
export let turn = 0;
/** @type {() => void} */
let supersede = () => {};
export let superseded = new Promise((done) => { supersede = () => done(undefined); });
export function begin_turn() {
  ++turn;
  supersede();
  superseded = new Promise((done) => { supersede = () => done(undefined); });
}
/** @param {boolean} mixed */
export const in_turn = (mixed) => `tab=${tab}&turn=${turn}${mixed ? "&mixed=1" : ""}`;
