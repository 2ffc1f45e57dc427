/* scope.js - the live page: listens to /events, keeps the last minutes of each plant, and draws them.
 *
 * A band is the least and the greatest value of the rows in a pixel, and of the displacement's turning points, which
 * follow from displacement and velocity. For a motion faster than a tenth of the rows it reaches over so many rows
 * that they see all phases, and no line joins them. */
"use strict";

const CONTRACT = 1, KEEP_ROWS = 600000, KEEP_EVENTS = 300000, KEEP_BURSTS = 8, SLOW = 0.1;
const WINDOWS = [0.02, 0.1, 0.5, 2, 10, 60], WINDOW_MIN = 0.002, WINDOW_MAX = 60;
const MASK_LAG_S = 0.2, PHASE_GAP = 1 / 40, BAND_ROWS_MAX = 240;
const COLOURS = ["blue", "green", "purple", "orange"];

/* ---- what is kept ---- */

/* Columns of numbers, the first ascending; of twice what is kept the older half goes. */
class Series {
  constructor(width, keep) {
    this.n = 0, this.keep = keep;
    this.column = Array.from({length: width}, () => new Float64Array(1024));
  }
  makeRoom() {
    const most = 2 * this.keep, from = this.n < most ? 0 : this.keep;
    this.column = this.column.map((c) => {
      const more = new Float64Array(min(2 * c.length, most));
      more.set(c.subarray(from));
      return more;
    });
    this.n -= from;
  }
  push(...values) {
    if (this.n === this.t.length)
      this.makeRoom();
    for (let i = 0; i < this.column.length; i++)
      this.column[i][this.n] = values[i];
    this.n++;
  }
  get t() { return this.column[0]; }
  last(i) { return this.n ? this.column[i][this.n - 1] : NaN; }
  /* The first entry at or after a time. */
  at(time) {
    let low = 0, high = this.n;
    while (low < high) {
      const mid = (low + high) >> 1;
      if (this.t[mid] < time)
        low = mid + 1;
      else
        high = mid;
    }
    return low;
  }
}

/* Columns of the rows' series. */
const T = 0, CLOSED = 1, OUT = 2, STREAM = 6, LOW = 10, HIGH = 11, ROW_WIDTH = 12;

class Plant {
  constructor(about) {
    this.about = about;
    this.tables = {health: {}, ledger: {}, info: {}, parameters: {}, drives: {}};
    this.moved = {}, this.status = null, this.link = null, this.timing = null, this.slots = [];
    this.range = {};
    this.begin();
  }
  /* Forgets all that has a place on the time axis. */
  begin() {
    this.rows = new Series(ROW_WIDTH, KEEP_ROWS);
    this.events = new Series(5, KEEP_EVENTS); /* t, contact, touch, speed, peak */
    this.masks = new Series(3, KEEP_EVENTS);  /* t, contacts closed, 1 when located */
    this.summary = new Series(4, 8192);
    this.lockin = [], this.drives = {}, this.said = [], this.bursts = [];
    this.received = 0, this.checked = 0, this.burst = null;
  }
  get now() { return max(this.rows.last(T), 0) || (this.status && this.status.t) || 0; }
}

const plants = new Map();
let shown = null, hello = null;

/* ---- turning points between two rows ---- */

/* Weights of (x, h v) of four rows at -1, 0, 1, 2 for the polynomial through all eight, at points between 0 and 1:
  * Hermite's form, whose parts are squares of Lagrange's. */
const TURNS = 16, NODES = [-1, 0, 1, 2];
const weights = Array.from({length: TURNS - 1}, (_, j) => NODES.flatMap((a) => {
  const s = (j + 1) / TURNS, others = NODES.filter((b) => b !== a);
  const l = others.reduce((product, b) => product * (s - b) / (a - b), 1);
  const slope = others.reduce((sum, b) => sum + 1 / (a - b), 0);
  return [(1 - 2 * (s - a) * slope) * l * l, (s - a) * l * l];
}));

/* Displacement and velocity are told as they are, in equal steps, so that the path between rows is known. */
function turns(p) {
  const o = p.about.outputs, f = fastest(p);
  return o[0]?.name === "displacement" && o[1]?.name === "velocity" && o[1].unit === "m/s" &&
    !p.tables.health.sensor_faults && max(f.drive, f.f0) * spacing(p) <= 0.4;
}

/* LOW and HIGH of the way from row n - 3 to n - 2, now that row n - 1 is here. */
function locateTurns(p) {
  const r = p.rows, i = r.n - 2, c = r.column, t = c[T], x = c[OUT], v = c[OUT + 1];
  if (i < 2 || !turns(p))
    return;
  const h = t[i] - t[i - 1];
  if (abs(t[i + 1] - t[i] - h) > 1e-3 * h || abs(t[i - 1] - t[i - 2] - h) > 1e-3 * h)
    return;
  let low = min(x[i - 1], x[i]), high = max(x[i - 1], x[i]);
  for (const w of weights) {
    let y = 0;
    for (let k = 0; k < 4; k++)
      y += w[2 * k] * x[i - 2 + k] + w[2 * k + 1] * h * v[i - 2 + k];
    low = min(low, y), high = max(high, y);
  }
  c[LOW][i] = low, c[HIGH][i] = high; /* NaN stays NaN: a row without its motion */
}

/* ---- what comes in ---- */

const hear = {
  hello(d) {
    hello = d;
    if (d.contract !== CONTRACT)
      return alarm("The program is another version than this page: reload this page.");
    for (const about of d.plants)
      if (plants.has(about.plant))
        plants.get(about.plant).about = about;
      else
        plants.set(about.plant, new Plant(about));
    listPlants();
  },
  rows(d, p) {
    const outputs = min(4, p.about.outputs.length), four = (list) => [0, 1, 2, 3].map((i) => nan(list[i]));
    for (const [, t, closed, ...more] of d.rows) {
      if (t <= p.rows.last(T))
        continue;
      p.rows.push(t, nan(closed), ...four(more.slice(0, outputs)), ...four(more.slice(outputs)), NaN, NaN);
      p.received++;
      locateTurns(p);
    }
  },
  contact(d, p) {
    for (const [t, contact, touch, speed, peak] of d.events) {
      p.events.push(t, contact, touch, nan(speed), nan(peak));
      checkMasks(p, t);
      const before = p.masks.last(1) || 0, bit = 1 << contact;
      p.masks.push(t, touch ? before | bit : before & ~bit, 1);
    }
  },
  summary(d, p) { d.summary.forEach((s) => p.summary.push(...s.map(nan))); },
  lockin(d, p) {
    p.slots = d.slots, p.window_s = d.window_s;
    for (const [t, slot, amplitude, phase] of d.lockin) {
      p.lockin[slot] ??= new Series(3, 16384);
      p.lockin[slot].push(t, nan(amplitude), nan(phase));
    }
  },
  values(d, p) {
    for (const group of ["health", "ledger", "info", "parameters", "drives"])
      for (const [name, value] of Object.entries(d[group] || {}))
        keepValue(p, group, name, value, d.t);
  },
  status(d, p) { p.status = d, p.until ??= d.t; },
  said(d, p) {
    for (const m of d.said)
      if (m[2] === "LATENCY")
        p.latency = m[3].APPLY;
      else if (m[2] !== "OVERRUN" || p.said.at(-1)?.[2] !== m[2])
        p.said.push(m);
      else
        m[3].MISSED += p.said.pop()[3].MISSED, p.said.push(m);
    p.said.splice(0, max(0, p.said.length - 200));
    p.saidNew = true;
  },
  burst(d, p) {
    let b = p.bursts.at(-1);
    if (b?.number !== d.burst) {
      b = {number: d.burst, signals: [], value: {}};
      p.bursts = [...p.bursts.slice(1 - KEEP_BURSTS), b];
    }
    Object.assign(b, {sample_s: d.sample_s, trigger_t: d.trigger_t, pretrigger: d.pretrigger,
        samples: d.samples, signals: d.signals});
    for (const [signal, sample, value] of d.data)
      (b.value[signal] ??= new Float64Array(d.samples).fill(NaN))[sample] = nan(value);
    if (!b.taken && (p.takes || TRIGGER[find("trigger").value](p, b)))
      p.burst = b, b.taken = true, p.takes = false;
  },
  timing(d, p) { p.timing = d; },
  restart(d, p) {
    p.begin();
    p.range = {}, p.until = 0;
    view.end = null;
  },
  link(d, p) { p.link = d; },
  bye(d) { alarm("Connection lost: " + d.why + ". This page tries again."); },
};

function keepValue(p, group, name, value, t) {
  const table = p.tables[group];
  if (group === "drives") {
    table[name] = Object.assign(table[name] || {}, value);
    const d = table[name];
    p.drives[name] ??= new Series(2, 4096);
    if (t < p.drives[name].last(0))
      p.drives[name].n = 0;
    if (p.drives[name].last(1) !== d.amplitude)
      p.drives[name].push(t, nan(d.amplitude));
    return;
  }
  if (group === "health" && table[name] !== undefined && table[name] !== value)
    p.moved[name] = performance.now();
  table[name] = value;
}

/* Rows before `until` against the contacts that the events left closed: where they differ, events were not sent. */
function checkMasks(p, until) {
  const r = p.rows, t = r.t;
  p.checked = min(p.checked, r.n);
  if (p.checked > 0 && !(t[p.checked - 1] <= until))
    p.checked = r.at(p.masks.last(0));
  for (; p.checked < r.n && t[p.checked] < until; p.checked++) {
    const closed = r.column[CLOSED][p.checked];
    if (finite(closed) && closed !== p.masks.last(1) && !(t[p.checked] < p.masks.last(0)))
      p.masks.push(t[p.checked], closed, 0);
  }
}

const counted = {pictures: 0, began: performance.now()};
let connected = false;

function connect() {
  const source = new EventSource(hello ? "events" : "events?past");
  for (const name of Object.keys(hear))
    source.addEventListener(name, (e) => {
      const d = JSON.parse(e.data), p = plants.get(d.plant);
      if (name === "hello" || name === "bye")
        hear[name](d);
      else if (p && hello && hello.contract === CONTRACT)
        hear[name](d, p);
    });
  source.onopen = () => {
    connected = true;
    alarm("");
  };
  source.onerror = () => {
    connected = false;
    if (find("alarm").hidden)
      alarm("Connection lost. This page tries again.");
    source.close();
    setTimeout(connect, 1000);
  };
}

function listPlants() {
  const select = find("plant");
  select.replaceChildren(...[...plants.values()].map((p) =>
    new Option(p.about.name + " (" + p.about.bus + ")", p.about.plant)));
  find("version").textContent = hello.version;
  if (hello.control && location.hash && !find("control"))
    document.body.append(make("script", {id: "control", src: "control.js"}));
  if (plants.size)
    choose(shown?.about.plant ?? plants.keys().next().value);
}

function choose(id) {
  if (shown !== plants.get(id))
    escape(), shown = plants.get(id), pause(false);
  find("plant").value = shown.about.plant;
  makePanels();
}

/* ---- what is seen of it ---- */

/* end: of the time axis, or null for now; cursor: plant time. burst: the keys act on the burst. */
const view = {span: 10, end: null, cursor: NaN, burst: false, slot: 0, from: NaN, to: NaN, at: NaN};
let panels = [];
const burstNow = () => shown.burst;
/* The right edge. A window that is not full yet fills from the left. */
const end = () => view.end === null ? max(shown.now, (shown.rows.n ? shown.rows.t[0] : 0) + view.span) : view.end;

/* The fastest drive that sounds, else the contact's eigenfrequency; Hz of the bus. */
function fastest(p) {
  const sounding = Object.values(p.tables.drives).filter((d) => d.amplitude).map((d) => nan(d.frequency));
  const f0 = p.tables.info.f0_bus_Hz || p.about.f0_Hz || 0;
  return {drive: max(0, ...sounding.filter(finite)), f0};
}

/* The fewest rows that see a motion of frequency f in enough phases, and the part of the amplitude that they miss. */
const bandCache = new Map();
function bandRows(f, rate) {
  const key = f + "/" + rate;
  let found = bandCache.get(key), least = 2;
  if (found)
    return found;
  found = {rows: 1, missed: 0, period_s: 0};
  for (let m = 4; f > SLOW * rate && m <= BAND_ROWS_MAX && least > PHASE_GAP + 1e-9; m++) {
    const phase = Array.from({length: m}, (_, k) => k * f / rate % 1).sort((a, b) => a - b);
    const gap = phase.reduce((g, x, k) => max(g, k ? x - phase[k - 1] : 0), 1 + phase[0] - phase[m - 1]);
    if (gap < least - 1e-9)
      least = gap, found = {rows: m, missed: 1 - Math.cos(Math.PI * gap), period_s: 1 / f};
  }
  bandCache.set(key, found);
  return found;
}

/* Least and greatest of output k in each pixel column, from so many rows as `reach` says. */
function envelope(chart, p, k, reach) {
  const r = p.rows, t = r.t, y = r.column[OUT + k], n = chart.columns(), now = r.last(T);
  const low = new Float64Array(n).fill(NaN), high = low.slice();
  const located = k === 0 && turns(p), every = spacing(p);
  const half = located ? reach.period_s / 2 : reach.rows / 2 * every, gap = 2.5 * every;
  const width = 2 * half + (located ? 3 * every : 0); /* the first and last rows have no turning points */
  let a = r.at(min(chart.x0 - half, now - width)), b = a;
  for (let i = 0; i < n; i++) {
    const left = chart.xAt(chart.left + i), right = chart.xAt(chart.left + i + 1);
    const from = min(left - half, now - width), to = max(right + half, t[0] + width);
    if (left > now || right < t[0])
      continue;
    while (a < r.n && t[a] < from)
      a++;
    b = max(a, b);
    while (b < r.n && t[b] < to)
      b++;
    let least = Infinity, most = -Infinity;
    /* one row more, for the way to it; where no row is in the pixel, the one before */
    const more = b < r.n && b > 0 && t[b] - t[b - 1] < gap ? b + 1 : b;
    const first = a === b && a > 0 && more > b && !located ? a - 1 : a;
    for (let j = first; j < more; j++) {
      const l = located && r.column[LOW][j] === r.column[LOW][j];
      if (l) {
        least = min(least, r.column[LOW][j]), most = max(most, r.column[HIGH][j]);
      } else if (j < b || first < a) {
        least = min(least, y[j]), most = max(most, y[j]);
      }
    }
    for (let e = k === 3 ? p.events.at(from) : p.events.n; e < p.events.n && p.events.t[e] < to; e++)
      most = max(most, p.events.column[4][e] || -Infinity);
    if (most >= least)
      low[i] = least, high[i] = most;
  }
  return {low, high};
}

/* Time between rows that carry their values. */
function spacing(p) {
  const every = p.tables.parameters.motion_every;
  return p.about.frame_s * (every > 1 ? every : 1);
}

/* The y axis: wide at once, narrow slowly. */
function panelRange(p, key, low, high, least = low) {
  const wanted = rangeOf(min(least, low), high), old = p.range[key];
  if (!(high >= low))
    return old || wanted;
  if (!old || view.end !== null)
    return p.range[key] = wanted;
  old.narrows = wanted[1] - wanted[0] < (old.narrows ? 0.97 : 0.75) * (old[1] - old[0]);
  const wider = [wanted[0] < old[0], wanted[1] > old[1]];
  for (const i of [0, 1])
    old[i] += (wider[i] ? 1 : old.narrows ? 0.15 : 0) * (wanted[i] - old[i]);
  return old;
}

/* The entries of a series that a time axis shows, and one more on each side. */
const inView = (s, x0, x1) => [max(0, s.at(x0) - 1), min(s.n, s.at(x1) + 1)];

/* The entry at the cursor, else the last. */
const entryAt = (s) => finite(view.cursor) ? min(s.n - 1, s.at(view.cursor)) : s.n - 1;

function makePanels() {
  const {outputs, inputs} = shown.about, some = (list) => list.slice(0, 4);
  panels = [
    ...some(outputs).map((o, k) => ({key: "output " + k, height: 92, draw: drawOutput, name: plain(o.name), unit: o.unit, k})),
    ...(shown.about.contacts ? [{key: "contact", height: 96, draw: drawContact, name: "impact speed"},
      {key: "loss", height: 52, draw: drawLoss, name: "share of time out of contact"}] : []),
    {key: "amplitude", height: 74, draw: drawLockin, name: "lock-in amplitude"},
    {key: "phase", height: 60, draw: drawLockin, phase: true, name: "lock-in phase"},
    ...some(inputs).map((o, k) => ({key: "drive " + k, height: 62, draw: drawDrive, name: "input " + plain(o.name), unit: o.unit, k})),
  ];
  for (const panel of panels) {
    const canvas = make("canvas", {role: "img", ariaLabel: panel.name});
    canvas.style.height = panel.height + "px";
    Object.assign(panel, {canvas, chart: new Chart(canvas)});
  }
  find("panels").replaceChildren(...panels.map((l) => l.canvas));
}

function beginPanel(panel, y, yUnit, bare) {
  const x1 = end(), last = panel === panels.filter((l) => !l.canvas.hidden).pop();
  const height = panel.height + (last ? 26 : 0) + "px";
  if (panel.canvas.style.height !== height)
    panel.canvas.style.height = height;
  panel.chart.begin({x: [x1 - view.span, x1], y, yUnit, xUnit: "s", title: panel.name, bare,
      xLabel: last ? "plant time" : ""});
  return panel.chart;
}

function finishPanel(panel, entries) {
  const chart = panel.chart;
  if (view.cursor >= chart.x0 && view.cursor <= chart.x1)
    chart.marker(view.cursor, "ink", "", []);
  const b = burstNow();
  if (b && b.trigger_t >= chart.x0 && b.trigger_t <= chart.x1)
    chart.marker(b.trigger_t, "purple", panel === panels[0] ? "burst" : "");
  if (entries)
    chart.legend(entries);
  chart.end();
}

/* ---- panels ---- */

function drawOutput(panel, p) {
  const chart = panel.chart, f = fastest(p), rate = 1 / spacing(p);
  const reach = bandRows(f.drive > SLOW * rate ? f.drive : f.f0, rate);
  /* the pixels of the axis first: the y axis follows from them */
  chart.axis({x: [end() - view.span, end()]}, panel.canvas.clientWidth);
  const used = chart.columns(), perRow = used / (view.span / spacing(p));
  const {low, high} = envelope(chart, p, panel.k, perRow >= 4 ? {rows: reach.rows, period_s: 0} : reach);
  Object.assign(panel, {low, high});
  const [least] = extremes(low), [, most] = extremes(high);
  beginPanel(panel, panelRange(p, panel.key, least, most), panel.unit);
  if (!(most >= least))
    chart.say(p.about.identity === "same" ? "nothing in this window" : "waiting for the plant's identity");
  chart.band(low, high, COLOURS[panel.k]);
  const from = p.rows.at(chart.x0), to = p.rows.at(chart.x1);
  if (max(f.drive, f.f0) <= SLOW * rate && perRow > 1) /* nothing is faster than a tenth of the rows: a line may join them */
    chart.line(p.rows.t, p.rows.column[OUT + panel.k], COLOURS[panel.k], {from, to});
  if (perRow >= 4)
    chart.points(p.rows.t, p.rows.column[OUT + panel.k], "ink", {from, to, size: 3});
  finishPanel(panel, [[bandNote(panel, p, reach)], [readBand(panel, chart, used)]]);
}

function bandNote(panel, p, reach) {
  if (panel.k === 0 && turns(p))
    return "rows and turning points";
  if (reach.rows <= 1)
    return "rows";
  const missed = reach.missed > 0.01 ? ", up to " + ceil(100 * reach.missed) + " % missed" : "";
  return "rows over " + round(1000 * reach.rows * spacing(p)) + " ms" + missed;
}

/* Least to greatest at the cursor or at the end. */
function readBand(panel, chart, used) {
  const at = finite(view.cursor) ? view.cursor : min(chart.x1, shown.rows.last(T)) - view.span / used;
  const i = clamp(floor(chart.px(at) - chart.left), 0, used - 1);
  const u = unitFor(max(abs(panel.low[i]), abs(panel.high[i])), panel.unit);
  panel.values = !(panel.high[i] >= panel.low[i]) ? "no value" : number(panel.low[i] * u.factor, 4) + " … " +
    number(panel.high[i] * u.factor, 4) + " " + u.unit;
  return panel.values;
}

/* For each pixel the share of its time in which a contact is closed; drawn from below, with the open share above. */
function drawStrip(chart, p, top, height) {
  const m = p.masks, contacts = p.about.contacts, n = chart.columns(), c = chart.c;
  const known = max(p.rows.last(T) || 0, m.last(0) || 0);
  for (let k = 0; k < contacts; k++) {
    const h = height / contacts, y = top + k * h;
    let j = max(0, m.at(chart.x0) - 1);
    for (let i = 0; i < n; i++) {
      const from = chart.xAt(chart.left + i), to = min(chart.xAt(chart.left + i + 1), known);
      let closed = 0, seen = 0;
      while (j + 1 < m.n && m.t[j + 1] <= from)
        j++;
      for (let e = j; e < m.n && m.t[e] < to; e++) {
        const part = min(to, e + 1 < m.n ? m.t[e + 1] : known) - max(from, m.t[e]);
        if (part > 0)
          seen += part, closed += m.column[1][e] >> k & 1 ? part : 0;
      }
      if (!(seen > 0))
        continue;
      const split = h * (1 - closed / seen);
      c.fillStyle = colour("orange");
      c.fillRect(chart.left + i, y, 1, split);
      c.fillStyle = colour("blue");
      c.fillRect(chart.left + i, y + split, 1, h - split - (contacts > 1 ? 1 : 0));
    }
  }
}

/* The fastest touchdown and lift-off of each pixel. */
function stemsOf(chart, p, touch) {
  const e = p.events, x = [], y = [];
  for (let i = e.at(chart.x0), column = -1; i < e.n && e.t[i] <= chart.x1; i++) {
    const speed = abs(e.column[3][i]), at = floor(chart.px(e.t[i]));
    if (e.column[2][i] !== touch || !finite(speed))
      continue;
    if (at === column && speed <= y[y.length - 1])
      continue;
    if (at === column)
      x.pop(), y.pop();
    x.push(e.t[i]), y.push(speed), column = at;
  }
  return {x, y};
}

function drawContact(panel, p) {
  const chart = panel.chart, x1 = end();
  checkMasks(p, p.now - MASK_LAG_S);
  const e = p.events, from = e.at(x1 - view.span), to = e.at(x1);
  let most = 0;
  for (let i = from; i < to; i++)
    most = max(most, abs(e.column[3][i]) || 0);
  beginPanel(panel, [0, panelRange(p, panel.key, 0, most || 1, 0)[1] * 1.3], "m/s");
  for (const [touch, name] of [[0, "green"], [1, "red"]]) {
    const s = stemsOf(chart, p, touch);
    chart.stems(s.x, s.y, name);
  }
  drawStrip(chart, p, chart.top, 16);
  let held = 0;
  for (let i = p.summary.at(x1 - view.span); i < p.summary.n && p.summary.t[i] <= x1; i++)
    held += p.summary.column[3][i] || 0;
  panel.values = `${to - from} switches, up to ${quantity(most, "m/s", 3)}` +
    (held ? `; ${held} more were not sent` : "");
  finishPanel(panel, [[held ? `${held} events not sent` : `${to - from} switches`], ["closed", "blue"],
      ["open", "orange"], ["touchdown", "red"], ["lift-off", "green"]]
    .slice(innerWidth < 600 ? 1 : 0));
}

function drawLoss(panel, p) {
  const chart = beginPanel(panel, [0, 100], "%"), s = p.summary, [from, to] = inView(s, chart.x0, chart.x1);
  const share = s.column[2].subarray(0, s.n).map((v) => 100 * v);
  chart.line(s.t, share, "orange", {from, to, steps: true, width: 2});
  const at = entryAt(s);
  panel.values = s.n ? number(share[at], 3) + " %" : "not told yet";
  finishPanel(panel, [[panel.values]]);
}

/* The slots that are shown: those of the chosen one's unit. */
function slotsShown(p) {
  const told = p.slots.filter((s) => p.lockin[s.slot]);
  const first = told.find((s) => s.slot === view.slot) || told[0];
  return first ? told.filter((s) => s.unit === first.unit) : [];
}

function drawLockin(panel, p) {
  const slots = slotsShown(p), column = panel.phase ? 2 : 1, unit = panel.phase ? "rad" : slots.length ? slots[0].unit : "";
  const seen = slots.flatMap((s) => {
    const l = p.lockin[s.slot];
    return extremes(l.column[column].subarray(...inView(l, end() - view.span, end())));
  });
  const chart = beginPanel(panel, panel.phase ? [-Math.PI, Math.PI] : panelRange(p, "lock-in " + unit, ...extremes(seen), 0), unit);
  if (!slots.length)
    chart.say("no lock-in window has ended");
  const entries = slots.map((s) => drawSlot(chart, panel, p, s, column));
  panel.values = entries.map((e) => e[0]).join(", ");
  finishPanel(panel, entries);
}

const NO_LOCKIN = "not available: less than a period a window, or another drive is too near";

function drawSlot(chart, panel, p, s, column) {
  const l = p.lockin[s.slot], [from, to] = inView(l, chart.x0, chart.x1), name = COLOURS[s.slot % 4];
  const y = l.column[column].subarray(0, l.n);
  chart.line(l.t, panel.phase ? unwrapped(y) : y, name, {from, to, width: 2});
  chart.points(l.t, y, name, {from, to, size: 4});
  const at = entryAt(l);
  return [panel.phase ? number(y[at], 3) + " rad"
    : `${plain(s.output)}, harmonic ${s.harmonic} of ${plain(s.input)}: ${isNaN(y[at]) ? NO_LOCKIN : quantity(y[at], s.unit)}`, name];
}

/* A phase that jumps by more than half a turn has gone round: no line across the panel. */
function unwrapped(y) {
  return y.map((v, i) => i && abs(v - y[i - 1]) > Math.PI ? NaN : v);
}

function drawDrive(panel, p) {
  const name = p.about.inputs[panel.k].name, d = p.tables.drives[name] || {}, s = p.drives[name];
  const stream = p.rows.column[STREAM + panel.k], from = p.rows.at(end() - view.span), to = p.rows.at(end());
  const streamed = extremes(stream.subarray(from, to));
  const ever = s && s.column[1].subarray(0, s.n).some((v) => v) || d.noise || streamed[1] >= streamed[0];
  panel.canvas.hidden = !ever && panels.some((l) => l.draw === drawDrive && l !== panel && (l.k < panel.k || !l.canvas.hidden));
  if (panel.canvas.hidden)
    return;
  const told = s ? inView(s, end() - view.span, end()) : [0, 0];
  const set = s ? extremes(s.column[1].subarray(...told)) : [Infinity, -Infinity];
  const chart = beginPanel(panel, panelRange(p, panel.key, min(set[0], streamed[0]), max(set[1], streamed[1]), 0),
      panel.unit);
  if (s) /* held until now */
    chart.line([...s.t.subarray(...told), min(chart.x1, p.now)], [...s.column[1].subarray(...told), s.last(1)], "purple",
         {steps: true, width: 2});
  chart.line(p.rows.t, stream, "green", {steps: true, from, to});
  markCommands(chart, p, panel.k);
  const words = `${quantity(nan(d.amplitude), panel.unit)} at ${quantity(nan(d.frequency), "Hz", 6)}, ` +
    `phase ${number(nan(d.phase), 3)} rad` + (d.noise ? `, noise ${quantity(d.noise, panel.unit)}` : "");
  panel.values = d.amplitude === undefined ? "not told yet" : words;
  finishPanel(panel, [[ever ? panel.values : "no drive sounds"], ["amplitude", "purple"], ["samples", "green"]]);
}

/* Commands that were heard, where they were. */
function markCommands(chart, p, input) {
  for (const [t, , message, fields] of p.said)
    if (t >= chart.x0 && t <= chart.x1 && (message === "CONTROL" || message === "FIRE" && fields.CHANNELS >> input & 1))
      chart.marker(t, "dim", view.span < 3 ? (fields.OPERATION || "fire") : "");
}

/* ---- the burst ---- */

const burstChart = new Chart(find("burst")), forceChart = new Chart(find("burst-force"));
const orbitChart = new Chart(find("orbit")), timingChart = new Chart(find("timing"));

function signalOf(b, name) {
  const s = b.signals.find((q) => q.name === name);
  return s && b.value[s.signal] ? {name, unit: s.unit, y: b.value[s.signal]} : null;
}

/* The sample at the cursor, else at the trigger. */
const sampleAt = (b) => round((view.at || 0) / b.sample_s) + (b.pretrigger || 0);

/* Time of a sample from the trigger, s. */
const sampleTime = (b, k) => (k - (b.pretrigger || 0)) * b.sample_s;

function burstTimes(b) {
  if (!b.times || b.times.length !== b.samples || b.timesOf !== b.pretrigger)
    b.times = Float64Array.from({length: b.samples}, (_, k) => sampleTime(b, k)), b.timesOf = b.pretrigger;
  return b.times;
}

const burstWindow = (b) => finite(view.from) ? [view.from, view.to] : [sampleTime(b, 0), sampleTime(b, b.samples - 1)];

const TRIGGERS = ["by a command", "at a touchdown", "at a lift-off", "at a FIRE", "at a fault"];
function burstWords(p, b) {
  if (!b && p.bursts.length)
    return `${p.bursts.length} kept, none by this trigger; [ and ] show them.`;
  if (!b)
    return "None yet: set capture_trigger (now " + (TRIGGERS[p.tables.parameters.capture_trigger] || TRIGGERS[0]) +
      "), then contactplant send capture arm and capture read.";
  const have = max(0, ...Object.values(b.value).map((y) => y.filter(finite).length));
  return `Number ${b.number}, triggered at ${number(nan(b.trigger_t), 7)} s; ${have} of ${b.samples} samples, ` +
    `${quantity(b.sample_s, "s")} apart.`;
}

/* ---- its trigger ---- */

const level = () => Number(find("level").value);

/* A contact opens or closes within a sample of the trigger. */
function switches(p, b, touch) {
  const e = p.events, t = nan(b.trigger_t), near = 1.5 * b.sample_s;
  return e.column[2].subarray(e.at(t - near), e.at(t + near)).includes(touch);
}

/* Whether a burst comes into the panel. */
const TRIGGER = {
  "each": () => true,
  "hand": () => false,
  "level": (p, b) => extremes(signalOf(b, "contact_force")?.y || [])[1] >= level(),
  "lift-off": (p, b) => switches(p, b, 0),
  "touchdown": (p, b) => switches(p, b, 1),
};

function drawBurst() {
  const p = shown, b = burstNow();
  put("burst-text", burstWords(p, b) + (p.takes ? " Waits for the next one." : ""));
  find("level").hidden = find("trigger").value !== "level";
  for (const id of ["burst", "burst-force", "orbit"])
    find(id).hidden = !b;
  if (!b)
    return;
  const t = burstTimes(b), x = burstWindow(b);
  const force = signalOf(b, "contact_force"), first = b.signals.map((s) => signalOf(b, s.name))
    .find((s) => s && s.name !== "contact_force");
  drawWave(burstChart, t, x, first, "blue", b, force, false);
  drawWave(forceChart, t, x, force || signalOf(b, (b.signals[1] || b.signals[0]).name), "red", b, force, true);
  drawOrbit(b, signalOf(b, "displacement"), signalOf(b, "velocity"), t, x);
}

function drawWave(chart, t, x, s, name, b, force, axis) {
  chart.begin({x, y: rangeOf(...extremes(s?.y || [])), yUnit: s?.unit, xUnit: "s", title: s ? plain(s.name) : "not in the burst",
    xLabel: axis && "time from the trigger"});
  if (force) /* where the force is zero the contact is open */
    for (let i = 0, from = -1; i <= b.samples; i++) {
      const open = i < b.samples && force.y[i] === 0;
      if (open && from < 0)
        from = i;
      if (!open && from >= 0)
        chart.span(t[from], t[min(i, b.samples - 1)], "orange", 0.25), from = -1;
    }
  if (s)
    chart.line(t, s.y, name, {width: 1.5});
  if (s === force && find("trigger").value === "level")
    chart.line(x, [level(), level()], "ink", {width: 1});
  chart.marker(0, "purple", axis ? "" : "trigger");
  if (finite(view.at))
    chart.marker(view.at, "ink", "", []);
  const value = s && finite(view.at) ? quantity(s.y[sampleAt(b)], s.unit) : "";
  chart.legend([[value], ...(force && !axis ? [["open", "orange"]] : [])]);
  chart.end();
  chart.canvas.ariaLabel = (s ? `Burst ${b.number}: ${s.name} from ` +
    extremes(s.y).map((v) => quantity(v, s.unit, 3)).join(" to ") + (value ? `; at the cursor ${value}` : "")
    : "Burst: no such signal");
}

function drawOrbit(b, x, v, t, [from, to]) {
  const chart = orbitChart, ok = x && v;
  chart.begin({x: rangeOf(...extremes(x?.y || [])), y: rangeOf(...extremes(v?.y || [])), xUnit: x?.unit, yUnit: v?.unit,
    title: "phase plane: velocity", xLabel: "displacement"});
  if (ok) {
    chart.line(x.y, v.y, "blue", {from: t.findIndex((s) => s >= from), to: t.findLastIndex((s) => s <= to) + 1, width: 1});
    chart.points([x.y[sampleAt(b)]], [v.y[sampleAt(b)]], "red", {size: 7});
  } else
    chart.say("needs displacement and velocity");
  chart.end();
  chart.canvas.ariaLabel = "Phase plane of the burst: velocity over displacement" + (ok ? "" : ", which it has not");
}

/* ---- tables ---- */

function fill(id, rows) {
  const key = JSON.stringify(rows), table = find(id);
  if (fill[id] === key)
    return;
  fill[id] = key;
  table.replaceChildren();
  for (const [name, value, mark] of rows) {
    const tr = table.insertRow();
    tr.className = mark || "";
    tr.append(make("th", {scope: "row", textContent: name}));
    tr.insertCell().textContent = value;
  }
}

function showStatus() {
  const badge = find("state");
  badge.textContent = badge.dataset.state = shown.status?.state || "no state yet";
}

function showState(p) {
  const s = p.status || {}, h = p.tables.health, i = p.tables.info;
  const faults = (s.fault_names || []).join(", ");
  const identity = {same: "as the scene says", other: "another plant: " + p.about.why}[p.about.identity] ||
    "not told yet: numbers are withheld";
  fill("table-state", [
    ["faults", faults || "none", faults ? "bad" : ""],
    ["session", (s.session || "none") + (s.reaction && s.reaction !== "none" ? ", reaction " + s.reaction : "")],
    ["watch", s.watch ? "left its range, " + (h.watch_trips || 1) + " times" : "in its range", s.watch ? "bad" : ""],
    ["age of the last heartbeat", (h.command_age_frames ?? "–") + " frames"],
    ["last command acted after", p.latency < 65535 ? p.latency + " ticks" : "–"],
    ["plant time", number(p.now, 8) + " s, frame " + (s.frame ?? "–")],
    ["model", p.about.model + (i.promoted ? ", climbed to the full one" : "")],
    ["identity", identity, p.about.identity === "other" ? "bad" : ""],
  ]);
}

const LEDGER = [["stored", "stored in the plant"], ["damping", "lost in dampers"], ["change", "by parameter changes"], ...[0, 1, 2, 3].map((i) => ["work_" + i]), ["residual", "does not balance"]];
function showEnergy(p) {
  const l = p.tables.ledger, flow = Object.values(l).reduce((m, v) => max(m, abs(v) || 0), 0);
  const rows = LEDGER.filter(([k]) => l[k] !== undefined).map(([k, words]) => {
    const input = p.about.inputs[k.slice(5)];
    return [words || "work of " + (input ? input.name : k), quantity(l[k], "J")];
  });
  if (flow > 0 && l.residual !== undefined)
    rows.push(["residual over the largest term", number(abs(l.residual) / flow, 3)]);
  fill("table-energy", rows.length ? rows : [["not told yet", ""]]);
}

const NO_COUNTER = /_tick$|_frame$|_us$|^capture_|^command_age|^frames_received|^last_run|^sensor_|^pieces_/;
function showCounters(p) {
  const now = performance.now(), units = Object.fromEntries(p.about.counters.map((c) => [c.name, c.unit]));
  const rows = Object.entries(p.tables.health).filter(([n, v]) => v && !NO_COUNTER.test(n))
    .map(([n, v]) => [n, v + (units[n] ? " " + units[n] : ""), now - (p.moved[n] || -1e9) < 3000 ? "moved" : ""]);
  fill("table-counters", rows.length ? rows : [["none has moved", ""]]);
}

function showSaid(p) {
  if (!p.saidNew && showSaid.plant === p)
    return;
  p.saidNew = false, showSaid.plant = p;
  const lines = p.said.slice(-40).reverse().map(([t, , message, f]) => {
    const li = make("li");
    li.textContent = `${t.toFixed(3)} s ${message} ` + Object.entries(f).filter(([k, v]) => k + v !== "TICKS_LATE65535" && !/SESSION|ECHO|COMPL/.test(k))
      .map(([k, v]) => k.toLowerCase() + " " + (typeof v === "number" ? number(v, 6) : v)).join(", ");
    li.className = f.CAUSE && f.CAUSE !== "ok" || message === "OVERRUN" || message === "WATCH" ? "bad" : "";
    return li;
  });
  find("said").replaceChildren(...lines);
}

function drawTiming(p) {
  const h = p.tables.health, told = p.timing, k = timingChart, c = k.c;
  find("timing-text").textContent = `Worst: ${h.lateness_max_us ?? "–"} µs late, ${h.compute_max_us ?? "–"} µs of computing` +
    (told ? "." : "; histograms come with run --scope.");
  find("timing").hidden = !told;
  if (!told)
    return;
  const top = log10(max(1, ...told.lateness_us, ...told.compute_us)) + 0.3;
  k.begin({x: [0.5, 2 ** told.lateness_us.length], y: [-0.3, top], xUnit: "µs", log: true, bare: true, xLabel: "time",
    title: "frames, logarithmic"});
  for (let d = 0; d < top; d++)
    k.rule(k.left, k.py(d), k.width - k.right, k.py(d));
  const words = [["lateness", told.lateness_us, "blue"], ["computing", told.compute_us, "orange"]].map(([name, counts, ink], right) => {
    c.fillStyle = colour(ink);
    counts.forEach((n, i) => {
      const a = k.px(2 ** (i - 1)), half = (k.px(2 ** i) - a) / 2, y = k.py(log10(n));
      if (n)
        c.fillRect(a + right * half + 1, y, half - 1, k.bottom - y);
    });
    return `${name} mostly below ${2 ** counts.indexOf(max(...counts))} µs`;
  });
  k.legend([["lateness", "blue"], ["computing", "orange"]]);
  k.end();
  find("timing").ariaLabel = "Histograms: " + words.join(", ");
}

function showLink() {
  const l = shown?.link || {heard: true}, el = find("link");
  let text = !connected ? "connection lost" : l.heard ? "connected" : `plant silent for ${number(l.silent_s, 3)} s`;
  if (l.lost || l.bad)
    text += `; ${l.lost} frames lost, ${l.bad} not decoded`;
  if (l.others?.length)
    text += `; ${l.others.length} more on the bus without a scene`;
  el.toggleAttribute("data-lost", !connected || !l.heard);
  put("link", text);
}

function showTables() {
  showLink();
  if (!shown)
    return;
  showStatus();
  for (const show of [showState, showEnergy, showCounters, showSaid, drawTiming])
    show(shown);
  const words = finite(view.cursor) ? `at ${number(view.cursor, 7)} s` : "now";
  for (const l of panels)
    l.canvas.ariaLabel = `${l.name}, ${words}: ${l.values || "no value"}`;
  const s = (performance.now() - counted.began) / 1000;
  find("rate").textContent = `${number(counted.pictures / s, 3)} pictures a second, ${shown.received} rows`;
}

/* ---- hands ---- */

function showPause() {
  find("pause").ariaPressed = view.end !== null;
  find("pause").textContent = view.end === null ? "Pause" : "Go on";
}

function pause(on) {
  view.end = on ? (view.end === null ? shown.now : view.end) : null;
  showPause();
}

function setSpan(span) {
  view.span = clamp(span, WINDOW_MIN, WINDOW_MAX);
  const select = find("window"), own = find("own");
  own.hidden = WINDOWS.includes(view.span);
  own.value = own.hidden ? "" : view.span;
  own.textContent = quantity(view.span, "s", 3);
  select.value = view.span;
}

/* Around the cursor when paused, so that what it points at stays. */
function zoom(factor) {
  if (view.burst)
    return zoomBurst(factor);
  const old = view.span, x1 = end();
  setSpan(view.span * factor);
  if (view.end !== null) {
    const at = view.cursor >= x1 - old && view.cursor <= x1 ? view.cursor : x1 - old / 2;
    view.end = at + (x1 - at) * view.span / old;
  }
}

function zoomBurst(factor) {
  const b = burstNow();
  if (!b)
    return;
  const first = sampleTime(b, 0), last = sampleTime(b, b.samples - 1), [from, to] = burstWindow(b);
  const at = finite(view.at) ? view.at : clamp(0, from, to);
  const span = clamp((to - from) * factor, 8 * b.sample_s, last - first);
  const low = clamp(at - (at - from) * span / (to - from), first, last - span);
  view.from = low, view.to = low + span;
}

function pan(part) {
  if (view.burst && finite(view.from))
    return view.from += part *= view.to - view.from, view.to += part;
  pause(true);
  view.end = min(shown.now, view.end + part * view.span);
}

function moveCursor(pixels) {
  if (view.burst) {
    const b = burstNow();
    if (b)
      view.at = (view.at || 0) + Math.sign(pixels) * b.sample_s * (abs(pixels) > 1 ? 10 : 1);
    return;
  }
  const chart = panels[0].chart, x1 = end();
  pause(true);
  const at = finite(view.cursor) ? view.cursor : x1 - view.span / 2;
  view.cursor = clamp(at + pixels * view.span / chart.columns(), x1 - view.span, x1);
}

function toBurst() {
  view.burst = !view.burst;
  find("burst-card").scrollIntoView({block: "nearest"});
  find("burst")[view.burst ? "focus" : "blur"]();
}

function stepBurst(by) {
  const p = shown;
  p.burst = p.bursts[clamp(p.bursts.indexOf(p.burst) + by, 0, p.bursts.length - 1)];
  view.from = view.to = view.at = NaN;
}

function toTrigger() {
  const b = burstNow();
  if (!b || !finite(nan(b.trigger_t)))
    return;
  pause(true);
  setSpan(b.samples * b.sample_s * 1.5);
  view.cursor = b.trigger_t;
  view.end = b.trigger_t + sampleTime(b, b.samples) * 1.2;
}

function nextPlant() {
  choose(after([...plants.keys()], shown.about.plant));
}

function nextSlot() {
  view.slot = Number(after(Object.keys(shown.lockin), String(view.slot)) || 0);
}

function escape() {
  view.cursor = view.at = view.from = view.to = NaN;
  view.burst = false;
}

/* What is to be read in the list, and what the keys do. */
const KEYS = [
  ["space", "pause, and go on", {" ": () => pause(view.end === null)}],
  ["+ −", "zoom in and out", {"+": () => zoom(0.5), "=": () => zoom(0.5), "-": () => zoom(2)}],
  ["1 … 6", "windows from 20 ms to 60 s", Object.fromEntries(WINDOWS.map((s, i) => [i + 1, () => setSpan(s)]))],
  ["← →", "back and forth in time (pauses)", {ArrowLeft: () => pan(-0.1), ArrowRight: () => pan(0.1)}],
  ["end", "back to now", {End: () => pause(false)}],
  [", .", "cursor left and right; with shift in long steps",
    {",": () => moveCursor(-1), ".": () => moveCursor(1), "<": () => moveCursor(-20), ">": () => moveCursor(20)}],
  ["esc", "no cursor", {Escape: escape}],
  ["b", "to the burst: zoom and cursor act there; again: back", {b: toBurst}],
  ["[ ]", "older and newer burst", {"[": () => stepBurst(-1), "]": () => stepBurst(1)}],
  ["c", "take the next burst (trigger by hand)", {c: () => shown.takes = true}],
  ["g", "time axis to the trigger of the burst", {g: toTrigger}],
  ["n", "next plant", {n: nextPlant}],
  ["l", "next lock-in slot", {l: nextSlot}],
];
let keys = {}; /* these, and those of keys.js */

function onPointer(e) {
  const panel = panels.find((l) => l.canvas === e.target);
  if (!panel || panel.chart.x1 === undefined)
    return;
  const at = e.clientX - e.target.getBoundingClientRect().left;
  view.cursor = at >= panel.chart.left ? panel.chart.xAt(at) : NaN;
}

function listen() {
  keys = useKeys(KEYS, () => shown);
  for (const card of document.querySelectorAll(".card"))
    card.ariaLabel = card.querySelector("h2").textContent;
  for (const s of WINDOWS)
    find("window").add(new Option(quantity(s, "s"), s), find("own"));
  setSpan(view.span);
  find("pause").onclick = () => shown && pause(view.end === null);
  find("take").onclick = () => keys.c();
  find("plant").onchange = (e) => choose(Number(e.target.value));
  find("window").onchange = (e) => setSpan(Number(e.target.value));
  const box = find("panels");
  box.onpointermove = onPointer;
  box.onpointerdown = onPointer;
  box.onpointerleave = () => view.cursor = view.end === null ? NaN : view.cursor;
  box.addEventListener("wheel", (e) => {
    if (e.ctrlKey && shown)
      e.preventDefault(), zoom(e.deltaY > 0 ? 1.25 : 0.8);
  }, {passive: false});
  find("burst").onfocus = () => view.burst = true;
  find("burst").onblur = () => view.burst = false;
}

let tablesAt = 0;
function picture(now) {
  requestAnimationFrame(picture);
  const past = shown?.until - shown?.now > 1;
  if (shown && !(past && now < counted.at + 500) && hello.contract === CONTRACT) {
    counted.at = now;
    for (const panel of panels)
      panel.draw(panel, shown);
    drawBurst();
    counted.pictures++;
  }
  if (now - tablesAt > 250) {
    tablesAt = now;
    showTables();
  }
}

/* For tests. */
window.scope = Object.freeze({
  pixelOf: (t, panel = 0) => panels[panel].chart.px(t),
  look: () => ({view, panels, shown, counted, plants}),
});

listen();
connect();
requestAnimationFrame(picture);
