/* report.js - a report: paragraphs, tables and charts of the data that the file holds. */
"use strict";

const report = JSON.parse(document.getElementById("data").textContent), charts = [];
const INKS = ["blue", "red", "green", "purple", "orange", "grey"];

/* With layers that no live page has. */
class ReportChart extends Chart {
  /* Filled from low[i] to high[i] at x[i], with straight lines between; NaN leaves a gap. */
  area(x, low, high, name) {
    const c = this.c;
    c.beginPath();
    for (let i = 0, k; i < x.length; i = k + 1) {
      for (k = i; k < x.length && finite(low[k]) && finite(high[k]); k++)
        c[k > i ? "lineTo" : "moveTo"](this.px(x[k]), this.py(high[k]));
      for (let j = k - 1; j >= i; j--)
        c.lineTo(this.px(x[j]), this.py(low[j]));
    }
    this.fill(name, 0.4);
  }

  /* Rectangles from from[i] to to[i] across, and `half` below and above y[i]. */
  cells(from, to, y, half, name) {
    this.c.beginPath();
    for (let i = 0; i < y.length; i++) {
      const a = round(this.px(from[i])), b = round(this.py(y[i] + half));
      this.c.rect(a, b, round(this.px(to[i])) - a, round(this.py(y[i] - half)) - b);
    }
    this.fill(name, 0.7);
  }

  fill(name, alpha) {
    this.c.fillStyle = colour(name);
    this.c.globalAlpha = alpha;
    this.c.fill();
    this.c.globalAlpha = 1;
  }
}

function add(parent, tag, text, name) {
  const e = document.createElement(tag);
  e.textContent = text || "";
  e.className = name || "";
  parent.append(e);
  return e;
}

function addTable(section, s) {
  add(section, "h2", s.title);
  const table = add(section, "table"), head = add(table, "tr");
  for (const name of s.columns.split(","))
    add(head, "th", name).scope = "col";
  for (const row of s.rows) {
    const tr = add(table, "tr", "", row.bad ? "bad" : "");
    for (const cell of row.cells)
      add(tr, "td", cell);
  }
}

function addChart(section, s) {
  for (const l of s.log === "both" ? s.layers : []) /* the y axis is one of powers of ten */
    l.y &&= l.y.map(Math.log10);
  const canvas = add(section, "canvas");
  canvas.role = "img";
  charts.push({s, canvas, chart: new ReportChart(canvas), cursor: NaN, bounds: bounds(s), group: section});
  s.exact = s.layers.some((l) => l.kind === "bounds");
  s.layers = s.layers.filter((l) => l.kind !== "bounds");
  addKey(section, s.layers.filter((l) => l.kind === "cells"));
  const chart = charts[charts.length - 1];
  canvas.addEventListener("pointermove", (e) => point(chart.s.x_name, chart.chart.xAt(e.offsetX)));
  canvas.addEventListener("pointerleave", () => point(s.x_name, NaN));
}

/* Below the chart, where it has room on any screen. */
function addKey(section, layers) {
  const key = layers.length ? add(section, "p", "", "key") : null;
  for (const l of layers) {
    const box = add(key, "span", "■ ");
    box.style.color = `var(--${l.ink})`, box.ariaHidden = true;
    add(key, "span", l.name + "   ");
  }
}

const KINDS = {
  words: (section, s) => add(section, "p", s.text),
  text: (section, s) => (add(section, "h2", s.title), add(section, "pre", s.text).tabIndex = 0),
  table: addTable,
  chart: addChart,
};

/* The cursor of all charts over the same x. */
function point(name, x) {
  for (const c of charts)
    if (c.s.x_name === name)
      c.cursor = x;
  drawAll();
}

/* Least and greatest of a band's bins in each pixel column; each bin reaches over a period. */
function columnsOf(chart, l) {
  const n = chart.columns(), low = new Float64Array(n).fill(NaN), high = low.slice();
  l.x.forEach((x, i) => {
    const next = i + 1 < l.x.length ? l.x[i + 1] : l.end[0], more = max(0, l.period[0] - (next - x)) / 2;
    const from = floor(chart.px(x - more) - chart.left), to = ceil(chart.px(next + more) - chart.left);
    if (l.low[i] === null)
      return;
    for (let k = max(0, min(from, n - 1)); k < max(from + 1, to) && k < n; k++) {
      low[k] = low[k] <= l.low[i] ? low[k] : l.low[i];
      high[k] = high[k] >= l.high[i] ? high[k] : l.high[i];
    }
  });
  return {low, high};
}

const ys = (l) => l.y || [...l.low, ...l.high];

function bounds(s) {
  const given = s.layers.find((l) => l.kind === "bounds");
  if (given)
    return {x: given.x, y: given.y};
  const own = s.layers.filter((l) => l.kind !== "marker" && l.kind !== "span");
  const x = extremes(own.flatMap((l) => l.ends || [...l.x, ...(l.end || []), ...(l.to || [])]));
  const y = extremes(own.flatMap((l) => l.kind === "open" ? [0, 1] : l.half ? l.y.flatMap((v) => [v - l.half[0], v + l.half[0]]) : ys(l)));
  return {x, y: own.every((l) => l.kind === "open") ? y : rangeOf(...y)};
}

/* The share of open contact in each pixel column: the mean of the parts in it. Nothing is drawn where it is not known. */
function drawShares(chart, l) {
  const n = chart.columns(), parts = l.share.length, c = chart.c;
  const at = (px) => (chart.xAt(px) - l.ends[0]) / (l.ends[1] - l.ends[0]) * parts;
  for (let k = 0; k < n; k++) {
    const a = at(chart.left + k), b = at(chart.left + k + 1);
    if (b <= 0 || a >= parts)
      continue;
    const own = l.share.slice(max(0, floor(a)), max(floor(a) + 1, min(parts, ceil(b)))).filter(finite);
    if (!own.length)
      continue;
    const y = round(chart.py(1 - own.reduce((sum, v) => sum + v, 0) / own.length));
    c.fillStyle = colour("blue");
    c.fillRect(chart.left + k, y, 1, chart.bottom - y);
    c.fillStyle = colour("orange");
    c.fillRect(chart.left + k, chart.top, 1, y - chart.top);
  }
}

function drawLayer(chart, l, ink) {
  if (l.kind === "band") {
    const {low, high} = columnsOf(chart, l);
    chart.band(low, high, ink);
  } else if (l.kind === "open")
    drawShares(chart, l);
  else if (l.kind === "span")
    chart.span(l.ends[0], l.ends[1], "red", 0.2);
  else if (l.kind === "marker")
    chart.marker(l.x[0], "red", l.name);
  else if (l.kind === "area")
    chart.area(l.x, l.low, l.high, ink);
  else if (l.kind === "cells")
    chart.cells(l.x, l.to, l.y, l.half[0], ink);
  else if (l.kind === "points")
    chart.points(l.x, l.y.map((v) => v ?? NaN), ink, {size: 4});
  else
    chart.line(l.x, l.y.map((v) => v ?? NaN), ink, {steps: l.kind === "steps"});
}

/* What a layer says at the cursor. */
function valueAt(l, x, unit) {
  const xs = l.x || [];
  if (!finite(x) || ["marker", "span", "open", "cells"].includes(l.kind) || !xs.length)
    return "";
  let i = 0;
  for (let k = 0; k < xs.length; k++)
    if (l.kind === "band" ? xs[k] <= x : abs(xs[k] - x) < abs(xs[i] - x))
      i = k;
  if (unit === "log")
    return number(10 ** l.y[i], 3);
  return !l.low ? quantity(l.y[i] ?? NaN, unit, 6)
    : l.low[i] === l.high[i] ? quantity(l.low[i] ?? NaN, unit, 6) : quantity(l.low[i], unit) + " … " + quantity(l.high[i], unit);
}

function drawChart(c) {
  const {s, chart, canvas} = c, range = Object.assign({}, c.bounds), all = charts.filter((o) => /time$/.test(s.x_name) ? o.group === c.group : o === c);
  const x = extremes(all.flatMap((o) => o.bounds.x)), strip = s.layers.some((l) => l.kind === "open");
  const plane = s.layers.every((l) => l.kind === "points" || l.kind === "cells") && !/time$/.test(s.x_name);
  canvas.style.height = strip ? "72px" : plane ? "340px" : "190px";
  range.x = s.log === "both" ? [x[0] / 1.3, x[1] * 1.3] : x[1] > x[0] && (!plane || s.exact) ? x : rangeOf(...x);
  chart.begin({x: range.x, y: range.y, xUnit: s.x_unit, yUnit: s.unit, title: s.title + (s.log === "both" ? ", power of ten" : ""), xLabel: s.x_name,
    bare: strip, log: s.log});
  const named = s.layers.filter((l) => !["marker", "open", "span"].includes(l.kind)), span = s.layers.find((l) => l.kind === "span");
  const ink = (l) => l.ink || INKS[[...new Set(named.map((k) => k.name))].indexOf(l.name) % INKS.length];
  for (const l of s.layers)
    drawLayer(chart, l, ink(l));
  if (c.cursor >= range.x[0] && c.cursor <= range.x[1])
    chart.marker(c.cursor, "ink", quantity(c.cursor, s.x_unit, 6), []);
  const seen = new Set(), entries = strip ? [["closed", "blue"], ["open", "orange"]] : [];
  for (const l of named.filter((l) => l.name && l.kind !== "cells"))
    if (!seen.has(l.name) || finite(c.cursor))
      seen.add(l.name), entries.push([(l.name + " " + valueAt(l, c.cursor, s.log === "both" ? "log" : s.unit)).trim(), ink(l)]);
  if (span)
    entries.push([span.name, "red"]);
  chart.legend(entries);
  chart.end();
  canvas.ariaLabel = s.title + " over " + s.x_name + (strip ? "" : ", from " +
    extremes(named.flatMap(ys)).map((v) => quantity(v, s.unit)).join(" to "));
}

function drawAll() {
  readColours();
  charts.forEach(drawChart);
}

function show() {
  const main = document.querySelector("main"), top = document.createElement("header");
  document.title = report.title + " – contactplant";
  document.body.prepend(top);
  add(top, "h1", report.title);
  add(top, "p", "contactplant " + report.version, "right");
  main.replaceChildren();
  const command = add(main, "pre", report.command, "command");
  command.tabIndex = 0;
  let section = null, kind = "";
  for (const s of report.sections) {
    if (!section || s.kind !== kind || s.kind === "table" || s.kind === "text")
      section = add(main, "section", "", "card"), section.ariaLabel = s.title || "Summary";
    kind = s.kind;
    KINDS[s.kind](section, s);
  }
  drawAll();
}

const dark = matchMedia("(prefers-color-scheme: dark)");
function setTheme(name) {
  document.documentElement.dataset.theme = name;
  drawAll();
}
addEventListener("resize", drawAll);
addEventListener("beforeprint", () => setTheme("light"));
addEventListener("afterprint", () => setTheme(dark.matches ? "dark" : "light"));
dark.addEventListener("change", () => setTheme(dark.matches ? "dark" : "light"));
document.documentElement.dataset.theme = dark.matches ? "dark" : "light";
show();
