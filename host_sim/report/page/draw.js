/* draw.js - axes, bands, steps, stems and points on a canvas: what the live page and the reports share.
 *
 * A chart is drawn anew as a whole: begin(), then its layers, then end(). Numbers are in SI; axes pick a prefix.
 * Colours come from scope.css, so that light, dark and paper need no second palette. */
"use strict";

const {abs, ceil, floor, log10, max, min, round} = Math, finite = Number.isFinite;
const PREFIXES = ["z", "a", "f", "p", "n", "µ", "m", "", "k", "M", "G"];
const SCALED = ["m", "m/s", "N", "J", "Hz", "s"];

/* The factor and the name of the unit that suit numbers up to `largest`. */
function unitFor(largest, unit) {
  if (!SCALED.includes(unit) || !(largest > 0))
    return {factor: 1, unit: unit === "1" ? "" : unit || ""};
  const power = max(-7, min(unit === "s" ? 0 : 3, floor(log10(largest) / 3 + 1e-9)));
  return {factor: 10 ** (-3 * power), unit: PREFIXES[power + 7] + unit};
}

/* A number in `digits` significant digits. */
function number(value, digits = 4) {
  if (!finite(value))
    return "–";
  const size = abs(value);
  if (size !== 0 && (size < 1e-4 || size >= 1e7))
    return value.toExponential(digits - 1).replace(/\.?0+e/, "e").replace(/-/g, "−");
  return String(Number(value.toPrecision(digits))).replace("-", "−");
}

function quantity(value, unit, digits = 4) {
  const u = unitFor(abs(value), unit);
  return (number(value * u.factor, digits) + " " + u.unit).trim();
}

/* The multiples of 1, 2 or 5 times a power of ten inside [low, high], as many as possible but at most `most`. */
function ticksOf(low, high, most) {
  const power = 10 ** floor(log10((high - low) / most));
  const inside = (step) => floor(high / step + 1e-9) - ceil(low / step - 1e-9) + 1;
  const step = power * ([1, 2, 5, 10, 20].find((f) => inside(f * power) <= most) || 50);
  const decimals = max(0, -floor(log10(step) + 1e-9)), first = ceil(low / step - 1e-9);
  return Array.from({length: max(0, inside(step)) || 0}, (_, i) => ({at: (first + i) * step,
    text: ((first + i) * step).toFixed(min(decimals, 12)).replace("-", "−")}));
}

/* The least and the greatest finite number. */
function extremes(list) {
  let low = Infinity, high = -Infinity;
  for (const v of list)
    if (finite(v))
      low = min(low, v), high = max(high, v);
  return [low, high];
}

/* [low, high] with air; something around the value when all are equal; 0..1 without any. */
function rangeOf(low, high) {
  if (!(high >= low))
    return [0, 1];
  const air = high > low ? 0.08 * (high - low) : abs(high) * 0.1 || 1;
  return [low - air, high + air];
}

let colours = {};
/* Reads the colours of scope.css; after a change of light and dark, too. */
function readColours() {
  const style = getComputedStyle(document.documentElement);
  colours = {};
  for (const name of ["ink", "dim", "grid", "paper", "blue", "red", "green", "orange", "purple", "sky", "grey", "ground", "accent"])
    colours[name] = style.getPropertyValue("--" + name).trim();
}
const colour = (name) => colours[name] || name;

class Chart {
  constructor(canvas) {
    this.canvas = canvas;
    this.c = canvas.getContext("2d");
    this.left = 58, this.right = 10;
  }

  /* x, y: [from, to]; xUnit, yUnit; title; xLabel (none: no room for an axis); log: of x; bare: no values on y. */
  begin(view) {
    const canvas = this.canvas, c = this.c, ratio = window.devicePixelRatio || 1;
    const width = canvas.clientWidth || 600, height = canvas.clientHeight || 100;
    if (canvas.width !== round(width * ratio) || canvas.height !== round(height * ratio)) {
      canvas.width = round(width * ratio);
      canvas.height = round(height * ratio);
    }
    this.axis(view, width);
    this.top = 18;
    this.bottom = height - (view.xLabel ? 32 : 6);
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.clearRect(0, 0, width, height);
    c.font = "12px system-ui, sans-serif";
    this.grid();
    c.save();
    c.beginPath();
    c.rect(this.left, this.top, width - this.left - this.right, this.bottom - this.top);
    c.clip();
  }

  /* The x axis alone, so that bands can be made before the y axis is known. */
  axis(view, width) {
    this.view = view, this.width = width;
    [this.x0, this.x1] = view.x;
    [this.y0, this.y1] = view.y || [0, 1];
    this.a = this.place(this.x0), this.b = this.place(this.x1);
  }

  place(x) { return this.view.log ? log10(x) : x; }
  px(x) {
    return this.left + (this.place(x) - this.a) / (this.b - this.a) * (this.width - this.left - this.right);
  }
  xAt(px) {
    const x = this.a + (px - this.left) / (this.width - this.left - this.right) * (this.b - this.a);
    return this.view.log ? 10 ** x : x;
  }
  py(y) { return this.bottom - (y - this.y0) / (this.y1 - this.y0) * (this.bottom - this.top); }
  /* Pixel columns of the plot. */
  columns() { return max(1, floor(this.width - this.left - this.right)); }

  grid() {
    const c = this.c, v = this.view, u = unitFor(max(abs(this.y0), abs(this.y1)), v.yUnit);
    const most = max(2, floor((this.bottom - this.top) / 16));
    c.lineWidth = 1;
    c.fillStyle = colour("dim");
    c.textBaseline = "middle";
    c.textAlign = "right";
    for (const t of v.bare ? [] : ticksOf(this.y0 * u.factor, this.y1 * u.factor, most)) {
      const y = round(this.py(t.at / u.factor)) + 0.5;
      this.rule(this.left, y, this.width - this.right, y);
      c.fillText(t.text, this.left - 5, y);
    }
    this.gridAcross();
    c.fillStyle = colour("ink");
    c.textAlign = "left";
    c.textBaseline = "alphabetic";
    const title = (v.title || "") + (u.unit && !v.bare ? " (" + u.unit + ")" : "");
    c.fillText(title, this.left, 13);
    this.titleEnd = this.left + c.measureText(title).width + 8;
  }

  gridAcross() {
    const c = this.c, v = this.view, a = this.a, b = this.b;
    const u = v.log ? {factor: 1, unit: v.xUnit} : unitFor(max(abs(a), abs(b)), v.xUnit);
    c.textAlign = "center";
    for (const t of ticksOf(a * u.factor, b * u.factor, max(2, floor((this.width - this.left) / 75)))) {
      const at = v.log ? 10 ** t.at : t.at / u.factor, x = round(this.px(at)) + 0.5;
      this.rule(x, this.top, x, this.bottom);
      if (v.xLabel)
        c.fillText(v.log ? number(at, 3) : t.text, min(x, this.width - 22), this.bottom + 10);
    }
    if (v.xLabel)
      c.fillText(v.xLabel + (u.unit ? " (" + u.unit + ")" : ""), (this.left + this.width) / 2, this.bottom + 24);
  }

  rule(x0, y0, x1, y1) {
    this.c.strokeStyle = colour("grid");
    this.c.beginPath();
    this.c.moveTo(x0, y0);
    this.c.lineTo(x1, y1);
    this.c.stroke();
  }

  /* Filled from low[i] to high[i] in pixel column i, with edges; NaN leaves a gap. */
  band(low, high, name) {
    const c = this.c, n = min(low.length, this.columns());
    c.fillStyle = colour(name);
    for (const edges of [false, true]) {
      c.beginPath();
      for (let i = 0; i < n; i++) {
        if (!(high[i] >= low[i]))
          continue;
        const a = round(this.py(high[i])), b = round(this.py(low[i]));
        c.rect(this.left + i, a, 1, edges ? 1 : b - a + 1);
        if (edges)
          c.rect(this.left + i, b, 1, 1);
      }
      c.globalAlpha = edges ? 1 : 0.4;
      c.fill();
    }
    c.globalAlpha = 1;
  }

  /* A line through points, or steps that hold each value until the next; NaN leaves a gap. */
  line(x, y, name, {steps = false, width = 1.5, from = 0, to = x.length} = {}) {
    const c = this.c;
    let on = false, last = 0;
    c.beginPath();
    for (let i = from; i < to; i++) {
      if (!finite(y[i])) {
        on = false;
        continue;
      }
      const a = this.px(x[i]), b = this.py(y[i]);
      if (on && steps)
        c.lineTo(a, last);
      if (on)
        c.lineTo(a, b);
      else
        c.moveTo(a, b);
      on = true, last = b;
    }
    c.lineWidth = width;
    c.strokeStyle = colour(name);
    c.stroke();
  }

  /* A line from zero to each value with a dot on it. */
  stems(x, y, name) {
    const c = this.c, zero = this.py(0);
    c.beginPath();
    for (let i = 0; i < x.length; i++) {
      const a = floor(this.px(x[i])) + 0.5;
      c.moveTo(a, zero);
      c.lineTo(a, this.py(y[i]));
    }
    c.lineWidth = 1;
    c.strokeStyle = colour(name);
    c.stroke();
    this.points(x, y, name);
  }

  points(x, y, name, {from = 0, to = x.length, size = 3} = {}) {
    const c = this.c;
    c.fillStyle = colour(name);
    for (let i = from; i < to; i++)
      if (finite(y[i]))
        c.fillRect(this.px(x[i]) - size / 2, this.py(y[i]) - size / 2, size, size);
  }

  /* Shaded over the whole height. */
  span(a, b, name, alpha = 0.15) {
    const c = this.c;
    c.globalAlpha = alpha;
    c.fillStyle = colour(name);
    c.fillRect(this.px(a), this.top, max(1, this.px(b) - this.px(a)), this.bottom - this.top);
    c.globalAlpha = 1;
  }

  marker(x, name, text, dash = [4, 3]) {
    const c = this.c, a = floor(this.px(x)) + 0.5, right = a < this.width - 90;
    c.setLineDash(dash);
    c.lineWidth = 1;
    c.strokeStyle = colour(name);
    c.beginPath();
    c.moveTo(a, this.top);
    c.lineTo(a, this.bottom);
    c.stroke();
    c.setLineDash([]);
    if (!text)
      return;
    c.fillStyle = colour("ink");
    c.textAlign = right ? "left" : "right";
    c.fillText(text, a + (right ? 4 : -4), this.top + 11);
    c.textAlign = "left";
  }

  /* A line of text in the middle of the plot: why there is nothing. */
  say(text) {
    const c = this.c;
    c.fillStyle = colour("dim");
    c.textAlign = "center";
    c.fillText(text, (this.left + this.width) / 2, (this.top + this.bottom) / 2 + 4);
    c.textAlign = "left";
  }

  /* Entries [text, colour] or [text], right in the title's line; the last ones are kept where there is little room. */
  legend(entries) {
    const c = this.c;
    let at = this.width - this.right;
    c.restore();
    c.save();
    c.textAlign = "right";
    for (const [text, name] of entries.slice().reverse()) {
      const width = c.measureText(text).width;
      if (!text)
        continue;
      if (at - width - 14 < this.titleEnd)
        break;
      c.fillStyle = colour(name ? "ink" : "dim");
      c.fillText(text, at, 13);
      at -= width;
      if (name) {
        c.fillStyle = colour(name);
        c.fillRect(at - 14, 5, 10, 8);
        at -= 14;
      }
      at -= 12;
    }
  }

  end() {
    this.c.restore();
    this.c.lineWidth = 1;
    this.c.strokeStyle = colour("grey");
    this.c.strokeRect(this.left - 0.5, round(this.top) - 0.5, this.width - this.left - this.right + 1,
                      round(this.bottom - this.top) + 1);
  }
}
