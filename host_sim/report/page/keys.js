/* keys.js - what the live page and that of recorded logs share: elements, light and dark, keys and their list. */
"use strict";

const find = (id) => document.getElementById(id);
const plain = (name) => name.replace(/_/g, " ");
const nan = (v) => v ?? NaN;
const clamp = (x, low, high) => max(low, min(high, x));
const make = (tag, more) => Object.assign(document.createElement(tag), more);
const after = (list, x) => list[(list.indexOf(x) + 1) % list.length];

function put(id, text) {
  if (find(id).textContent !== text)
    find(id).textContent = text;
}

function alarm(text) {
  find("alarm").textContent = text;
  find("alarm").hidden = !text;
}

const system = matchMedia("(prefers-color-scheme: dark)");
let theme = "", themed = () => {};
function showTheme() {
  document.documentElement.dataset.theme = theme || (system.matches ? "dark" : "light");
  readColours();
  themed();
}

function nextTheme() {
  theme = after(["", "light", "dark"], theme);
  showTheme();
}

function showKeys() {
  const keys = find("keys");
  keys.hidden = !keys.hidden;
  find("help").ariaExpanded = !keys.hidden;
}

const COMMON = [["t", "light, dark, as the system", {t: nextTheme}], ["?", "this list; esc closes it", {"?": showKeys}]];

function listKeys(list) {
  for (const [names, words] of list) {
    const dt = make("dt");
    for (const name of names.split(" "))
      dt.append(make("kbd", {textContent: name}), " ");
    find("key-list").append(dt, make("dd", {textContent: words}));
  }
}

/* Whether a key that was pressed here is for the element that has the focus. */
function isForElement(e) {
  const on = e.target.tagName;
  return on === "INPUT" || on === "SELECT" && e.key !== "Escape" || on === "BUTTON" && [" ", "Enter"].includes(e.key) ||
    e.ctrlKey || e.altKey || e.metaKey;
}

/* A list of [names, words, {key: what it does}]; ready() says whether there is something to act on. */
function useKeys(list, ready) {
  const all = [...list, ...COMMON], keys = Object.assign({}, ...all.map((k) => k[2])), always = COMMON.map((k) => k[0]);
  listKeys(all);
  document.addEventListener("keydown", (e) => {
    if (e.target.tagName === "INPUT" && e.key === "Escape")
      e.target.blur();
    const closes = e.key === "Escape" && !find("keys").hidden, act = closes ? showKeys : keys[e.key];
    if (!act || isForElement(e) || !closes && !ready() && !always.includes(e.key))
      return;
    e.preventDefault();
    act();
  });
  find("theme").onclick = nextTheme;
  find("help").onclick = showKeys;
  system.addEventListener("change", showTheme);
  showTheme();
  return keys;
}
