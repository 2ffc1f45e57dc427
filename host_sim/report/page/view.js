/* view.js - the page of recorded logs: asks the program for the part of plant time that is in view, and draws it.
 *
 * A band is the least and the greatest value of the rows in a pixel. Where there are few, the rows are dots. No line
 * joins them. Where rows are missing, or a value is beyond the bus's range, nothing is drawn, and that is marked. */
"use strict";

const CONTRACT = 1, PIXELS_MAX = 1536, SHORTEST_ROWS = 8, LISTED = 200;
const KINDS = ["touchdown", "liftoff", "refusal", "fault", "overrun", "missing", "session", "state"];
const bits = (...kinds) => kinds.reduce((sum, k) => sum | 1 << KINDS.indexOf(k), 0);
const ANY = bits("touchdown", "liftoff", "refusal", "fault"), SELDOM = bits(...KINDS.slice(2));
const STATE_INKS = {ready: "blue", running: "green", paused: "grey", stopped: "orange", frozen: "red", fault: "red"};
const INKS = ["blue", "green", "purple", "orange"];
const LANES = ["state", "session", "contact", "fault", "refused", "overrun", "missing"], LANE = 15;
const COUNTED = {refused: "refusal", overrun: "overrun", missing: "missing"};

let about = null, panels = [], overview = null;
const view = {run: null, from: 0, to: 1, cursor: NaN, marks: [], before: []};
const FOLLOW_MS = 1000;
const shown = {range: null, second: null, whole: null, row: null, asks: 0, asked: ""};

/* ---- what is asked ---- */

async function ask(target, query) {
  const answer = await fetch(target + "?" + new URLSearchParams({run: view.run.run, ...query}));
  if (!answer.ok)
    throw new Error(await answer.text());
  return answer.json();
}

/* One question of a kind at a time; the newest one follows. */
function asker(question, take) {
  let busy = false, again = false;
  return async function go() {
    again = busy;
    if (busy)
      return;
    busy = true;
    try {
      take(await question());
      alarm("");
    } catch (e) {
      alarm(e instanceof TypeError ? "Connection lost: is the program still there?" : e.message);
    }
    busy = false;
    if (again)
      go();
    draw();
  };
}

const pixels = () => clamp(panels[0]?.chart.columns() || 600, 16, PIXELS_MAX);
const askRange = asker(async () => {
  const began = performance.now(), part = {from: view.from, to: view.to, pixels: pixels()};
  const both = await Promise.all(about.logs.map((l, log) => hasRun(l) ? ask("range", {log, ...part}) : null));
  const apart = both[1] && !(both[0].row && both[1].row) ? await ask("range", {log: 2, ...part}).catch(() => null) : null;
  shown.took = performance.now() - began;
  return [...both.slice(0, 1), both[1] || null, apart];
}, ([r, second, apart]) => {
  shown.range = r, shown.second = second, shown.apart = apart, shown.asks++;
  fitPanels();
});
const hasRun = (log) => log.runs.some((r) => r.run === view.run.run);
const askRow = asker(() => finite(view.cursor) ? ask("row", {log: 0, at: view.cursor}) : null, (row) => shown.row = row);

async function askWhole() {
  const {from, to} = view.run;
  shown.whole = await ask("range", {log: 0, from, to: longer(from, to), pixels: pixels()});
  draw();
}

/* ---- the view ---- */

const step = () => about.logs[0].step_s || about.frame_s;
const longer = (from, to) => to > from ? to : from + 1;

/* Shows a part of plant time, within the run. */
function look(from, to, keep = true) {
  const a = view.run.from, b = longer(a, view.run.to), span = clamp(to - from, SHORTEST_ROWS * step(), b - a);
  const middle = (from + to) / 2, begin = clamp(middle - span / 2, a, b - span);
  if (begin === view.from && begin + span === view.to)
    return;
  if (keep)
    view.before.push([view.from, view.to]), view.before.splice(0, view.before.length - 50);
  view.from = begin, view.to = begin + span;
  askRange();
  draw();
}

function zoom(factor, at = finite(view.cursor) ? view.cursor : (view.from + view.to) / 2) {
  const x = clamp(at, view.from, view.to);
  look(x - (x - view.from) * factor, x + (view.to - x) * factor, false);
}

const pan = (part) => look(view.from + part * (view.to - view.from), view.to + part * (view.to - view.from), false);
const whole = () => look(view.run.from, view.run.to);

function lastView() {
  if (view.before.length)
    look(...view.before.pop(), false);
}

function pointAt(t) {
  view.cursor = t;
  askRow();
  draw();
}

function moveCursor(pixelsOn) {
  const at = finite(view.cursor) ? view.cursor : (view.from + view.to) / 2;
  pointAt(clamp(at + pixelsOn * (view.to - view.from) / pixels(), view.from, view.to));
}

/* The next mark of one of these kinds, or the one before. */
async function toMark(kinds, back) {
  const at = finite(view.cursor) ? view.cursor : back ? view.to : view.from;
  const m = await ask("next", {log: 0, at, back: back ? 1 : 0, kinds});
  if (!m)
    return put("news", back ? "there is none before" : "there is none behind");
  put("news", wordsOf(m));
  if (m.t < view.from || m.t > view.to)
    look(m.t - (view.to - view.from) / 2, m.t + (view.to - view.from) / 2, false);
  pointAt(m.t);
}

function chooseRun(i) {
  view.run = about.logs[0].runs[i], view.before = [], view.cursor = NaN, shown.row = null;
  view.from = view.run.from, view.to = longer(view.run.from, view.run.to);
  askRange();
  askWhole();
}

/* Where the two logs part first. */
function toPart() {
  if (about.part === null)
    return put("news", about.compared || "there is one log");
  put("news", about.compared);
  look(about.part - 20 * step(), about.part + 20 * step());
  pointAt(about.part);
}

/* A log that grows: a view of its end goes with it. */
async function follow() {
  const before = view.run, atEnd = view.to >= before.to, now = await (await fetch("log")).json(), [log] = now.logs;
  const grown = now.logs.some((l, i) => l.rows !== about.logs[i].rows);
  about = now;
  listRuns(log);
  alarm(now.logs.map((l) => l.lost && `${l.name}: ${l.lost}`).filter(Boolean).join(" "));
  view.run = log.runs.find((r) => r.run === before.run) || log.runs[0];
  if (!grown)
    return;
  const span = view.from <= before.from ? Infinity : view.to - view.from, {to} = view.run;
  if (atEnd)
    look(max(view.run.from, to - span), to, false);
  askRange();
  askWhole();
}

function listRuns(log) {
  put("news", `${log.rows} rows` + (log.missing ? `, ${log.missing} frames missing` : "") + (about.compared ? `; ${about.compared}` : ""));
  find("run").replaceChildren(...log.runs.map((r, i) => new Option(`${i + 1} of ${log.runs.length}`, i)));
  find("run").value = max(0, log.runs.findIndex((r) => r.run === view.run?.run));
  find("run-label").hidden = log.runs.length < 2;
}

function setMark() {
  if (finite(view.cursor))
    view.marks.push(view.cursor), view.marks.sort((a, b) => a - b);
  draw();
}

function escape() {
  view.cursor = NaN, shown.row = null;
  draw();
}

/* ---- panels ---- */

const signalName = (k) => k === "speed" ? "touchdown speed" : plain(about.signals[k].name);
const unitOf = (k) => k === "speed" ? "m/s" : about.signals[k].unit;

/* A panel for each signal of which there is something in view, or was. */
function fitPanels() {
  const all = new Set([...panels.map((p) => p.key), ...Object.keys(shown.range.bands), ...Object.keys(shown.second?.bands || {})]);
  const apart = (k) => about.logs.length > 1 ? [k, "apart " + k] : [k];
  const keys = ["lanes", ...about.signals.map((_, k) => String(k)), "speed"].filter((k) => k === "lanes" || all.has(k))
    .flatMap((k) => k === "lanes" || k === "speed" ? k : apart(k));
  if (keys.join() === panels.map((p) => p.key).join())
    return;
  panels = keys.map((key) => {
    const canvas = make("canvas", {role: "img", ariaLabel: key});
    return {key, canvas, chart: new Chart(canvas), ink: INKS[key % 4] || "red", draw: key === "lanes" ? lanesPanel : /apart/.test(key) ? apartPanel : signalPanel};
  });
  find("panels").replaceChildren(overview.canvas, ...panels.map((p) => p.canvas));
}

function begin(panel, y, unit, title, height, bare) {
  const last = panel === panels.at(-1), text = height + (last ? 26 : 0) + "px";
  if (panel.canvas.style.height !== text)
    panel.canvas.style.height = text;
  panel.chart.begin({x: [view.from, view.to], y, yUnit: unit, xUnit: "s", title, bare, xLabel: last ? "plant time" : ""});
}

/* For each pixel of the chart the column of the range that holds its time; -1 for none. */
function columnsOf(chart, r) {
  const map = new Int32Array(chart.columns());
  for (let i = 0; i < map.length; i++) {
    const k = floor((chart.xAt(chart.left + i + 0.5) - r.from) / (r.to - r.from) * r.columns);
    map[i] = k >= 0 && k < r.columns ? k : -1;
  }
  return map;
}

const pick = (map, list) => Float64Array.from(map, (k) => k < 0 ? NaN : list[k] ?? NaN);

/* Stretches of pixels with one value, as [first, end, value]. */
function stretches(values) {
  const found = [];
  for (let i = 0, k; i < values.length; i = k) {
    for (k = i + 1; k < values.length && Object.is(values[k], values[i]); k++);
    found.push([i, k, values[i]]);
  }
  return found;
}

/* Times in which rows are missing, from the rows or from columns without any. */
function holes(r) {
  if (r.row)
    return r.row.slice(1).map((row, i) => [r.row[i][0], row[0]]).filter(([a, b]) => b - a > 1.5 * step());
  const at = (i) => r.from + i / r.columns * (r.to - r.from), first = r.rows.findIndex((n) => n), last = r.rows.findLastIndex((n) => n);
  return stretches(r.rows.map((n) => n > 0)).filter(([a, b, some]) => !some && a > first && b <= last && at(b) - at(a) > 1.5 * step())
    .map(([a, b]) => [at(a), at(b)]);
}

const column = (r, key) => about.signals.length && r.row && key !== "speed" ? r.row.map((row) => row[6 + Number(key)] ?? NaN) : null;

function drawSignal(panel, r) {
  const {chart, key} = panel, bands = r.bands[key] || [[], []], map = columnsOf(chart, r);
  const low = pick(map, bands[0]), high = pick(map, bands[1]), rows = column(r, key);
  if (key !== "speed")
    for (const [a, b] of holes(r))
      chart.span(a, b, "grey", 0.25);
  const bit = 1 << key, beyond = Number(key) < 4 ? pick(map, r.beyond) : [];
  for (let i = 0; i < beyond.length; i++)
    if (beyond[i] & bit)
      chart.span(chart.xAt(chart.left + i), chart.xAt(chart.left + i + 1), "red", 0.3);
  if (key === "speed" && r.marks)
    drawTouchdowns(chart, r.marks.filter((m) => m.kind === "touchdown"));
  else if (rows && Number(key) >= 4)
    chart.line(r.row.map((row) => row[0]), rows, panel.ink, {steps: true});
  else if (rows)
    chart.points(r.row.map((row) => row[0]), rows, panel.ink);
  else if (isSparse(r))
    edgesOf(r, bands, (t, edge) => chart.points(t, edge, panel.ink, {size: 2}));
  else
    chart.band(low, high, panel.ink);
}

/* Pixels that see few phases of a fast motion: bands of them would show beats that do not exist. */
const isSparse = (r) => r.size === 1 && r.rows.reduce((sum, n) => sum + n, 0) < 8 * r.rows.filter((n) => n).length;

function edgesOf(r, bands, put) {
  const t = Array.from({length: r.columns}, (_, i) => r.from + (i + 0.5) / r.columns * (r.to - r.from));
  for (const edge of bands || [])
    put(t, edge.map(nan));
}

const drawTouchdowns = (chart, marks) => chart.points(marks.map((m) => m.t), marks.map((m) => nan(m.speed)), "red", {size: 4});

/* The second log: dashed edges of its bands, or small dots. */
function drawSecond(chart, key, r) {
  const rows = column(r, key), bands = r.bands[key];
  if (rows)
    return chart.points(r.row.map((row) => row[0]), rows, "red", {size: 2});
  chart.c.setLineDash([5, 4]);
  edgesOf(r, bands, (t, edge) => isSparse(r) ? chart.points(t, edge, "red", {size: 2}) : chart.line(t, edge, "red", {width: 1}));
  chart.c.setLineDash([]);
}

/* [time, first minus second] of the rows of one tick. */
function differences(key) {
  const a = shown.range, b = shown.second, k = 6 + Number(key);
  if (!a?.row || !b?.row)
    return null;
  const other = new Map(b.row.map((row) => [row[2], row[k]]));
  return a.row.filter((row) => row[k] !== null && (other.get(row[2]) ?? null) !== null).map((row) => [row[0], row[k] - other.get(row[2])]);
}

function apartPanel(panel) {
  const key = panel.key.slice(6), d = differences(key), bands = shown.apart?.bands[key] || [[], []], title = signalName(key) + ", first minus second";
  const [low, high] = extremes(d ? d.map((p) => p[1]) : bands.flat()), allowed = about.allowed[key];
  begin(panel, rangeOf(...extremes([low, high, ...allowed ? [-allowed, allowed] : []])), unitOf(key), title, 64);
  for (const edge of allowed ? [-allowed, allowed] : [])
    panel.chart.line([view.from, view.to], [edge, edge], "orange", {width: 1});
  if (d)
    panel.chart.points(d.map((p) => p[0]), d.map((p) => p[1]), "purple");
  else if (shown.apart) {
    const map = columnsOf(panel.chart, shown.apart);
    panel.chart.band(pick(map, bands[0]), pick(map, bands[1]), "purple");
  }
  finish(panel);
  panel.chart.end();
  panel.canvas.ariaLabel = title + ": " + (low <= high ? `${quantity(low, unitOf(key))} to ${quantity(high, unitOf(key))}` : "no rows of one tick") +
    (allowed ? `; ${quantity(allowed, unitOf(key))} allowed` : "");
}

function signalPanel(panel, r) {
  const bands = r.bands[panel.key] || [[], []], unit = unitOf(panel.key), more = shown.second?.bands[panel.key] || [[], []];
  const [low, high] = extremes([...bands, ...more].flat());
  begin(panel, rangeOf(low, high), unit, signalName(panel.key), 96);
  drawSignal(panel, r);
  if (shown.second)
    drawSecond(panel.chart, panel.key, shown.second);
  finish(panel);
  const value = panel.key === "speed" ? NaN : nan(shown.row?.[6 + Number(panel.key)]), entries = [];
  if (finite(view.cursor) && finite(value))
    entries.push([quantity(value, unit, 9), panel.ink]);
  if (Number(panel.key) < 4 && r.beyond.some((b) => b & 1 << panel.key))
    entries.push(["beyond the bus's range", "red"]);
  panel.chart.legend(entries);
  panel.chart.end();
  panel.canvas.ariaLabel = `${signalName(panel.key)} from ${quantity(low, unit)} to ${quantity(high, unit)}, plant time ` +
    `${number(view.from, 7)} to ${number(view.to, 7)} s` + (finite(value) ? `; at the cursor ${quantity(value, unit, 9)}` : "");
}

/* Cursor and marks. */
function finish(panel) {
  const {chart} = panel, first = panel === panels[1];
  const near = (i) => chart.px(view.marks[i]) - chart.px(view.marks[i - 1]) < 14; /* no room for two numbers */
  view.marks.forEach((t, i) => t >= view.from && t <= view.to && chart.marker(t, "purple", first && !near(i) ? String(i + 1) : ""));
  if (view.cursor >= view.from && view.cursor <= view.to)
    chart.marker(view.cursor, "ink", "", []);
  if (view.drag)
    chart.span(...view.drag, "blue", 0.25);
}

/* ---- lanes ---- */

function block(chart, i, a, b, ink, alpha, text) {
  const c = chart.c, y = chart.top + i * LANE;
  c.globalAlpha = alpha;
  c.fillStyle = colour(ink);
  c.fillRect(chart.left + a, y + 1, max(1, b - a), LANE - 2);
  c.globalAlpha = 1;
  if (!text || c.measureText(text).width + 6 > b - a)
    return;
  c.fillStyle = colour("ink");
  c.textAlign = "left";
  c.fillText(text, chart.left + a + 3, y + LANE - 4);
}

/* Closed below, open above, as shares of each pixel. */
function contactLane(chart, i, values) {
  const c = chart.c, y = chart.top + i * LANE + 1, h = LANE - 2;
  values.forEach((share, k) => {
    if (!finite(share))
      return;
    c.fillStyle = colour("blue");
    c.fillRect(chart.left + k, y + h * (1 - share), 1, h * share);
    c.fillStyle = colour("orange");
    c.fillRect(chart.left + k, y, 1, h * (1 - share));
  });
}

/* [time, contacts closed] in order, as rows and located events tell it. */
function switchesOf(r) {
  const told = [...r.row.map((row) => [row[0], () => row[4]]), ...r.marks.filter((m) => m.kind === "touchdown" || m.kind === "liftoff")
    .map((m) => [m.t, (mask) => m.kind === "touchdown" ? mask | 1 << m.contact : mask & ~(1 << m.contact)])].sort((a, b) => a[0] - b[0]);
  let mask = null;
  return told.map(([t, next]) => [t, mask = next(mask)]);
}

/* Few rows: contact is known from each row and event to the next row. */
function contactOf(chart, r, map) {
  if (!r.row || !r.marks)
    return pick(map, r.closed);
  const told = switchesOf(r), out = new Float64Array(map.length).fill(NaN);
  for (let i = 0, k = 0; i < out.length; i++) {
    const at = chart.xAt(chart.left + i + 0.5);
    while (k + 1 < told.length && told[k + 1][0] <= at)
      k++;
    if (told.length && told[k][0] <= at && at < told[k][0] + 1.5 * step() && told[k][1] !== null)
      out[i] = told[k][1] > 0 ? 1 : 0;
  }
  return out;
}

const faultWords = (mask) => about.faults.filter((_, i) => mask >> i & 1).map(plain).join(", ");

function drawLanes(chart, r) {
  const map = columnsOf(chart, r), held = (list) => r.row ? hold(pick(map, list)) : pick(map, list);
  for (const [a, b, v] of stretches(held(r.state)))
    if (STATE_INKS[about.states[v]])
      block(chart, 0, a, b, STATE_INKS[about.states[v]], 0.5, plain(about.states[v]));
  for (const [a, b, v] of stretches(held(r.session)))
    if (v > 0)
      block(chart, 1, a, b, v % 2 ? "purple" : "grey", 0.35, "session " + v);
  contactLane(chart, 2, contactOf(chart, r, map));
  for (const [a, b, v] of stretches(held(r.faults)))
    if (v > 0)
      block(chart, 3, a, b, "red", 0.5, faultWords(v));
  for (const [lane, kind] of Object.entries(COUNTED))
    for (const [k] of r.counts[kind])
      block(chart, LANES.indexOf(lane), ...pixelOf(chart, r, k), lane === "missing" ? "grey" : "red", 1);
  for (const [a, b] of holes(r))
    block(chart, 6, chart.px(a) - chart.left, chart.px(b) - chart.left, "grey", 0.6);
}

/* Between the rows of a close view a state goes on. */
function hold(values) {
  for (let i = 1; i < values.length; i++)
    values[i] = finite(values[i]) ? values[i] : values[i - 1];
  return values;
}

function pixelOf(chart, r, k) {
  const a = chart.px(r.from + k / r.columns * (r.to - r.from)) - chart.left;
  return [a, a + 2];
}

function nameLanes(chart) {
  const c = chart.c;
  c.fillStyle = colour("dim");
  c.textAlign = "right";
  LANES.forEach((name, i) => c.fillText(name, chart.left - 4, chart.top + i * LANE + LANE - 4));
  c.textAlign = "left";
}

function countWords(r) {
  const n = (kind) => r.counts[kind].reduce((sum, [, m]) => sum + m, 0);
  const all = [["touchdown", "touchdowns"], ["liftoff", "lift-offs"], ["refusal", "refusals"], ["fault", "faults"], ["overrun", "periods missed"],
    ["missing", "frames missing"]];
  return all.map(([kind, words]) => [n(kind), words]).filter(([count]) => count).map(([count, words]) => count + " " + words).join(", ");
}

function lanesPanel(panel, r) {
  begin(panel, [0, 1], "", "plant", 18 + LANES.length * LANE + 4, true);
  drawLanes(panel.chart, r);
  finish(panel);
  const at = finite(view.cursor) ? number(view.cursor, 9) + " s" : "";
  panel.chart.legend([[at], ["closed", "blue"], ["open", "orange"]]);
  panel.chart.end();
  nameLanes(panel.chart);
  panel.canvas.ariaLabel = `Plant time ${number(view.from, 7)} to ${number(view.to, 7)} s: ${countWords(r) || "no events"}`;
}

/* The whole run, and where the view is in it. */
function drawOverview() {
  const {chart, canvas} = overview, r = shown.whole, {from, to} = view.run;
  if (canvas.style.height !== "62px")
    canvas.style.height = "62px";
  chart.begin({x: [from, longer(from, to)], y: [0, 1], xUnit: "s", title: "whole run", bare: true});
  if (r)
    overviewLanes(chart, r);
  chart.span(from, view.from, "ground", 0.75);
  chart.span(view.to, longer(from, to), "ground", 0.75);
  chart.marker(view.from, "accent", "", []);
  chart.marker(view.to, "accent", "", []);
  if (view.drag && view.dragOn === overview)
    chart.span(...view.drag, "blue", 0.25);
  chart.legend([[`${quantity(view.to - view.from, "s")} of ${quantity(to - from, "s")}`]]);
  chart.end();
  canvas.ariaLabel = `The whole run, ${number(from, 7)} to ${number(to, 7)} s; in view ${number(view.from, 7)} to ${number(view.to, 7)} s`;
}

function overviewLanes(chart, r) {
  const map = columnsOf(chart, r), key = Object.keys(r.bands)[0];
  if (key) {
    const [low, high] = rangeOf(...extremes([...r.bands[key][0], ...r.bands[key][1]]));
    const edges = r.bands[key].map((list) => list.map((v) => v === null ? null : (v - low) / (high - low)));
    if (isSparse(r))
      edgesOf(r, edges, (t, edge) => chart.points(t, edge, "blue", {size: 1}));
    else
      chart.band(pick(map, edges[0]), pick(map, edges[1]), "blue");
  }
  for (const [kind, ink] of [["missing", "grey"], ["overrun", "red"], ["refusal", "red"], ["fault", "red"]])
    for (const [k] of r.counts[kind])
      chart.span(r.from + k / r.columns * (r.to - r.from), r.from + (k + 2) / r.columns * (r.to - r.from), ink, 0.8);
}

/* ---- words ---- */

function wordsOf(m) {
  const at = `${number(m.t, 9)} s: `;
  switch (m.kind) {
  case "touchdown":
  case "liftoff":
    return at + (m.kind === "liftoff" ? "lift-off" : m.kind) + ` of contact ${m.contact}` + (m.speed === null ? "" : ", " + quantity(m.speed, "m/s")) +
      (m.kind === "liftoff" && m.peak !== null ? ", peak force " + quantity(m.peak, "N") : "");
  case "refusal": return at + `${m.message} refused: ${plain(m.cause)}`;
  case "fault": return at + "fault " + faultWords(m.what);
  case "overrun": return at + `${m.n} frame periods missed`;
  case "missing": return at + `${m.n} frames missing`;
  case "session": return at + `session ${m.what}`;
  default: return at + "state " + plain(m.state);
  }
}

function showEvents(r) {
  put("view-text", countWords(r) || "no events");
  const marks = r.marks?.slice(0, LISTED) || [], items = marks.map((m) => make("li", {textContent: wordsOf(m),
    className: ["refusal", "fault", "overrun", "missing"].includes(m.kind) ? "bad" : ""}));
  if (!r.marks || r.marks.length > LISTED)
    items.push(make("li", {textContent: "zoom in to see each of them"}));
  find("said").replaceChildren(...items);
}

function rowsOf(table, rows) {
  find(table).replaceChildren(...rows.map(([name, value]) => {
    const tr = make("tr");
    tr.append(make("th", {textContent: name, scope: "row"}), make("td", {textContent: value}));
    return tr;
  }));
}

function showRow() {
  const row = shown.row;
  if (!row || !finite(view.cursor))
    return rowsOf("table-row", [["point at a time, or press . or ,", ""]]);
  const [t, frame, tick, state, closed, beyond, ...values] = row;
  const value = (v, k) => v !== null ? quantity(v, about.signals[k].unit, 9) : beyond >> k & 1 ? "beyond the range" : "–";
  rowsOf("table-row", [["time", t.toFixed(9) + " s"], ["frame", frame], ["tick", tick], ["state", state ? plain(state) : "–"],
    ["contacts closed", closed ?? "–"], ...values.map((v, k) => [plain(about.signals[k].name), value(v, k)]).filter(([, v], k) => k < 4 || v !== "–")]);
}

function showMarks() {
  rowsOf("table-marks", view.marks.length ? view.marks.map((t, i) => [`${i + 1}`,
    `${number(t, 9)} s` + (i ? `, ${quantity(t - view.marks[i - 1], "s", 6)} later` : "")]) : [["m sets a mark at the cursor", ""]]);
}

/* ---- pictures ---- */

let waiting = false;
function draw() {
  if (!waiting)
    requestAnimationFrame(picture);
  waiting = true;
}

function picture() {
  waiting = false;
  const r = shown.range;
  if (!r)
    return;
  drawOverview();
  for (const panel of panels)
    panel.draw(panel, r);
  if (r !== shown.listed)
    showEvents(r), shown.listed = r;
  showRow();
  showMarks();
  put("rate", `${r.size === 1 ? "Every row was read" : `From bins of ${r.size} rows`}, in ${number(shown.took, 3)} ms.`);
}

/* ---- hands ---- */

function timeAt(e) {
  const panel = [overview, ...panels].find((p) => p.canvas === e.target);
  const x = e.clientX - e.target.getBoundingClientRect().left;
  return panel?.chart.x1 === undefined ? {} : {panel, t: clamp(panel.chart.xAt(x), view.run.from, longer(view.run.from, view.run.to)), x};
}

function onDown(e) {
  const {panel, t, x} = timeAt(e);
  if (!panel || e.button)
    return;
  view.press = {panel, t, x};
  e.target.setPointerCapture(e.pointerId);
}

function onMove(e) {
  const {panel, t, x} = timeAt(e), press = view.press;
  if (!panel)
    return;
  if (press && abs(x - press.x) > 4)
    view.drag = [min(t, press.t), max(t, press.t)], view.dragOn = press.panel;
  if (panel === overview)
    draw();
  else
    pointAt(t);
}

function onUp(e) {
  const {t} = timeAt(e), press = view.press, drag = view.drag;
  view.press = view.drag = null;
  if (drag)
    look(...drag);
  else if (press?.panel === overview && finite(t))
    look(t - (view.to - view.from) / 2, t + (view.to - view.from) / 2);
  else if (press && finite(t))
    pointAt(t);
}

function onWheel(e) {
  const {panel, t} = timeAt(e);
  if (!panel || !e.ctrlKey)
    return;
  e.preventDefault();
  zoom(e.deltaY > 0 ? 1.25 : 0.8, t);
}

const VIEW_KEYS = [
  ["n p", "next contact change, fault or refusal; the one before", {n: () => toMark(ANY, false), p: () => toMark(ANY, true)}],
  ["N P", "the same without contact changes, with overruns, missing frames and sessions",
    {N: () => toMark(SELDOM, false), P: () => toMark(SELDOM, true)}],
  ["← →", "earlier and later", {ArrowLeft: () => pan(-0.2), ArrowRight: () => pan(0.2)}],
  ["+ −", "zoom in and out", {"+": () => zoom(0.5), "=": () => zoom(0.5), "-": () => zoom(2)}],
  ["0", "the whole run", {0: whole}],
  ["backspace", "the view before", {Backspace: lastView}],
  [", .", "cursor left and right; with shift in long steps",
    {",": () => moveCursor(-1), ".": () => moveCursor(1), "<": () => moveCursor(-20), ">": () => moveCursor(20)}],
  ["d", "where two logs part first", {d: toPart}],
  ["m M", "a mark at the cursor; no marks", {m: setMark, M: () => (view.marks = [], draw())}],
  ["esc", "no cursor", {Escape: escape}],
]; /* and those of keys.js */

function listen() {
  useKeys(VIEW_KEYS, () => view.run);
  themed = draw;
  for (const card of document.querySelectorAll(".card"))
    card.ariaLabel = card.querySelector("h2").textContent;
  const buttons = {whole, back: lastView, out: () => zoom(2), in: () => zoom(0.5), earlier: () => pan(-0.2), later: () => pan(0.2),
    previous: () => toMark(ANY, true), next: () => toMark(ANY, false)};
  for (const [id, act] of Object.entries(buttons))
    find(id).onclick = () => view.run && act();
  find("run").onchange = (e) => chooseRun(Number(e.target.value));
  const box = find("panels");
  box.addEventListener("pointerdown", onDown);
  box.addEventListener("pointermove", onMove);
  box.addEventListener("pointerup", onUp);
  box.addEventListener("pointercancel", onUp);
  box.addEventListener("wheel", onWheel, {passive: false});
  addEventListener("resize", () => (draw(), view.run && askRange()));
}

async function start() {
  listen();
  overview = {canvas: make("canvas", {role: "img", ariaLabel: "whole run"}), key: "overview"};
  overview.chart = new Chart(overview.canvas);
  about = await (await fetch("log")).json();
  if (about.contract !== CONTRACT)
    return alarm("The program is another version than this page: reload this page.");
  const [log] = about.logs;
  put("version", about.version);
  put("log-name", about.logs.map((l) => l.name).join(" and, dashed, "));
  listRuns(log);
  shown.range = {bands: {}, counts: Object.fromEntries(KINDS.map((k) => [k, []])), rows: [], state: [], session: [], faults: [], closed: [],
    beyond: [], from: 0, to: 1, columns: 1, size: 1};
  fitPanels();
  chooseRun(0);
  if (about.follows)
    setInterval(() => follow().catch(() => alarm("Connection lost: is the program still there?")), FOLLOW_MS);
}

/* For tests. */
window.scope = Object.freeze({look: () => ({view, shown, panels, about, overview})});

start();
