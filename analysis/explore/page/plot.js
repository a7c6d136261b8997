// Pictures with axes on a canvas: sharp on every screen, in the colours of the page, and in words.
//
// A picture is a figure of its own: title, canvas, legend, and a button that saves it as a PNG.
//
//   const picture = new Picture(parent, { name: "nyquist", title: "Nyquist plot", height: 300 });
//   picture.draw({
//     x: { name: "angle", unit: "rad", range: [0, 1] },
//     panels: [{ y: { name: "torque", unit: "N m", range: [-1, 1] }, paint: (pen) => { .. } }],
//     legend: [{ ink: "--plot-1", dash: [], words: "torque" }],
//     words: () => "the picture in words, with numbers, for people who cannot see it",
//   });
//
// Panels are above each other and share the horizontal axis. `paint` draws in the units of the axes:
//
//   pen.line(xs, ys, { ink, width, dash })   a line; ends where a value is not a number, and goes on after it
//   pen.upright(x, stroke), pen.level(y, stroke)   from side to side
//   pen.band(from, to, ink)                  between two values of x, filled
//   pen.ring(x, y, stroke), pen.dot(x, y, stroke), pen.cross(x, y, stroke)
//   pen.words(x, y, text, { ink, align, below })
//   pen.x(value), pen.y(value), pen.context, pen.area   to draw in pixels
//
// If a picture is slow to compute, `picture.update(() => { .. picture.draw(..) })` computes it only when it
// is visible.
//
// An entry of the legend has the stroke of its line, `mark: "cross"`, `fill` with a region of a map, or
// `blank` where it goes on from the one above it.
//
// Inks are names of custom properties of style.css: --plot-ink, --plot-faint, --plot-grid, --plot-1 to
// --plot-4. A picture is kept, and drawn again when the size or the theme changes.
//
// Over time there is a strip, of which lines of one unit share a panel:
//
//   const strip = new Strip(parent, { name: "motion", title: "Motion", seconds: 2,
//     lines: [{ name: "torque", unit: "N m" }, { name: "angle", unit: "rad" }] });
//   strip.push(time, [torque, angle]);   a sample, in s and the lines' units; as many a frame as there are
//   strip.draw();                        once a frame: the last `seconds`
//   strip.clear();                       nothing is left of it
//   strip.show(times, [torques, angles], more);   all samples at once, in place of what was pushed
//
// `levels: [{ line: 0, value: 1, words: "limit" }]` in the options, or in `strip.levels`, are level lines.

/** Pixels around a panel, and the height of the font. */
const PLOT = { left: 68, right: 24, top: 8, below: 38, between: 14, font: 12, pause: 600 };

/** A number with few digits, as a label has it. */
function plotNumber(value, digits = 4) {
  if (!Number.isFinite(value)) return value > 0 ? "∞" : value < 0 ? "-∞" : "-";
  if (value !== 0 && (Math.abs(value) < 1e-3 || Math.abs(value) >= 1e5)) {
    return Number(value.toPrecision(digits)).toExponential();
  }
  return String(Number(value.toPrecision(digits)));
}

/** The colours of the page by the names of their custom properties, as they are in the present theme. */
class Inks {
  static #probe;
  static #known = new Map();
  static #listeners = new Set();

  /** A colour that a canvas takes. */
  static of(name) {
    if (!name.startsWith("--")) return name;
    let colour = Inks.#known.get(name);
    if (colour === undefined) {
      Inks.#watch();
      Inks.#probe.style.color = `var(${name})`;
      colour = getComputedStyle(Inks.#probe).color;
      Inks.#known.set(name, colour);
    }
    return colour;
  }

  /** Has a function called when the theme has changed. */
  static listen(listener) {
    Inks.#listeners.add(listener);
  }

  static #watch() {
    if (Inks.#probe) return;
    Inks.#probe = document.createElement("span");
    Inks.#probe.hidden = true;
    document.body.append(Inks.#probe);
    const changed = () => {
      Inks.#known.clear();
      for (const listener of Inks.#listeners) listener();
    };
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
    const themes = { attributeFilter: ["data-theme", "class", "style"] };
    new MutationObserver(changed).observe(document.documentElement, themes);
  }
}

/** Round numbers of a range, at most so many. */
function roundNumbers([from, to], most) {
  const width = to - from;
  if (!(width > 0) || !Number.isFinite(width)) return [];
  const decade = 10 ** Math.floor(Math.log10(width / most));
  const step = decade * [1, 2, 5, 10].find((factor) => width / (factor * decade) <= most);
  const numbers = [];
  for (let k = Math.ceil(from / step - 1e-9); k * step <= to + 1e-9 * step; k += 1) {
    numbers.push(Number((k * step).toPrecision(12)));
  }
  return numbers;
}

/** A range around values, wider by a part on both sides; never empty. */
function rangeAround(values, part = 0.08, least = 0) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (!(low <= high)) [low, high] = [-1, 1];
  const missing = Math.max(least, 1e-9 * Math.max(Math.abs(low), Math.abs(high)), 1e-12) - (high - low);
  if (missing > 0) [low, high] = [low - missing / 2, high + missing / 2];
  const room = part * (high - low);
  return [low - room, high + room];
}

/** Draws in the units of a panel's axes. */
class Pen {
  /** The context that it draws with, to draw in pixels. */
  context;
  /** The panel: left, top, right and bottom in pixels. */
  area;
  #x;
  #y;

  constructor(context, area, x, y) {
    [this.context, this.area] = [context, area];
    const along = ([from, to], start, length) => {
      const scale = length / (to - from);
      return (value) => start + (value - from) * scale;
    };
    this.#x = along(x, area.left, area.right - area.left);
    this.#y = along(y, area.bottom, area.top - area.bottom);
  }

  /** Where a value of the horizontal axis is, in pixels. */
  x(value) {
    return this.#x(value);
  }

  /** Where a value of the vertical axis is, in pixels. */
  y(value) {
    return this.#y(value);
  }

  /** A line through points. Of many in one column of pixels, as a run over time has them, the first, the
   * lowest, the highest and the last are drawn. */
  line(xs, ys, stroke = {}) {
    const { context } = this;
    const count = Math.min(xs.length, ys.length);
    const dense = count > 3 * (this.area.right - this.area.left);
    context.beginPath();
    let drawing = false;
    for (let i = 0; i < count; i += 1) {
      const [x, y] = [this.#far(this.#x(xs[i])), this.#far(this.#y(ys[i]))];
      if (Number.isNaN(x) || Number.isNaN(y)) {
        drawing = false;
        continue;
      }
      if (drawing) context.lineTo(x, y);
      else context.moveTo(x, y);
      drawing = true;
      if (dense) i = this.#skip(xs, ys, i, count, x);
    }
    this.#stroke(stroke);
  }

  /** Draws all that is in the same column of pixels as a point; the last of it. */
  #skip(xs, ys, first, count, x) {
    let [low, high, last] = [ys[first], ys[first], first];
    for (let i = first + 1; i < count && Math.abs(this.#x(xs[i]) - x) < 0.7; i += 1) {
      if (Number.isNaN(ys[i])) break;
      low = Math.min(low, ys[i]);
      high = Math.max(high, ys[i]);
      last = i;
    }
    if (last > first) for (const y of [low, high, ys[last]]) this.context.lineTo(x, this.#far(this.#y(y)));
    return last;
  }

  /** A place not so far away that a canvas loses its way. */
  #far(pixels) {
    return Math.max(-1e5, Math.min(1e5, pixels));
  }

  /** An upright line from side to side. */
  upright(x, stroke = {}) {
    const { context, area } = this;
    context.beginPath();
    context.moveTo(this.x(x), area.top);
    context.lineTo(this.x(x), area.bottom);
    this.#stroke(stroke);
  }

  /** A level line from side to side. */
  level(y, stroke = {}) {
    const { context, area } = this;
    context.beginPath();
    context.moveTo(area.left, this.y(y));
    context.lineTo(area.right, this.y(y));
    this.#stroke(stroke);
  }

  /** Fills between two values of the horizontal axis. */
  band(from, to, ink) {
    const { context, area } = this;
    const [a, b] = [from, to].map((x) => Math.max(area.left, Math.min(area.right, this.x(x))));
    context.fillStyle = Inks.of(ink);
    context.fillRect(a, area.top, b - a, area.bottom - area.top);
  }

  /** A circle that is open. */
  ring(x, y, { ink = "--plot-ink", radius = 5 } = {}) {
    this.#circle(x, y, radius);
    this.context.fillStyle = Inks.of("--plot-back");
    this.context.fill();
    this.#stroke({ ink, width: 2 });
  }

  /** A circle that is full. */
  dot(x, y, { ink = "--plot-ink", radius = 3 } = {}) {
    this.#circle(x, y, radius);
    this.context.fillStyle = Inks.of(ink);
    this.context.fill();
  }

  /** A cross that is seen on every ground. */
  cross(x, y, { ink = "--plot-ink", radius = 8 } = {}) {
    const { context } = this;
    const [left, top] = [this.x(x), this.y(y)];
    for (const [colour, width] of [["--plot-back", 6], [ink, 2.5]]) {
      context.beginPath();
      context.moveTo(left - radius, top);
      context.lineTo(left + radius, top);
      context.moveTo(left, top - radius);
      context.lineTo(left, top + radius);
      this.#stroke({ ink: colour, width });
    }
  }

  /** Words beside a place, on a ground that lets them be read over lines. */
  words(x, y, text, { ink = "--plot-ink", align = "left", below = false } = {}) {
    const { context, area } = this;
    context.font = `${PLOT.font}px system-ui, sans-serif`;
    context.textBaseline = "middle";
    context.textAlign = "left";
    const width = context.measureText(text).width;
    const part = { left: 0, center: 0.5, right: 1 }[align];
    const gap = { left: 7, center: 0, right: -7 }[align];
    const least = area.left + 2;
    const left = Math.max(least, Math.min(area.right - width - 2, this.x(x) + gap - part * width));
    const shift = (below ? 1 : -1) * PLOT.font * 0.8;
    const middle = Math.max(area.top + 8, Math.min(area.bottom - 8, this.y(y) + shift));
    context.globalAlpha = 0.8;
    context.fillStyle = Inks.of("--plot-back");
    context.fillRect(left - 2, middle - PLOT.font * 0.6, width + 4, PLOT.font * 1.2);
    context.globalAlpha = 1;
    context.fillStyle = Inks.of(ink);
    context.fillText(text, left, middle);
  }

  #circle(x, y, radius) {
    this.context.beginPath();
    this.context.arc(this.#far(this.x(x)), this.#far(this.y(y)), radius, 0, 2 * Math.PI);
  }

  #stroke({ ink = "--plot-ink", width = 1.5, dash = [] }) {
    const { context } = this;
    context.strokeStyle = Inks.of(ink);
    context.lineWidth = width;
    context.lineJoin = "round";
    context.setLineDash(dash);
    context.stroke();
    context.setLineDash([]);
  }
}

/** A figure with a canvas that has axes. */
class Picture {
  /** What the scene is called that the pictures are of. */
  static scene = () => "scene";
  /** The figure, in which more may stand, and its canvas. */
  figure;
  canvas;
  /** The elements at its top besides the title. */
  tools;
  #name;
  #title;
  #legend;
  #content;
  #words;
  #visible = false;
  #areas = [];
  #due;
  #later;

  constructor(parent, { name, title, height = 280 }) {
    [this.#name, this.#title] = [name, title];
    const make = (tag, into, attributes = {}) => {
      const element = document.createElement(tag);
      for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
      into.append(element);
      return element;
    };
    this.figure = make("figure", parent, { class: "picture", id: `picture-${name}` });
    const head = make("figcaption", this.figure);
    make("h3", head).textContent = title;
    this.tools = make("div", head, { class: "picture-tools" });
    const save = make("button", this.tools, { type: "button", "aria-label": `Save as PNG: ${title}` });
    save.textContent = "PNG";
    save.addEventListener("click", () => savePng(this));
    this.canvas = make("canvas", this.figure, { role: "img", "aria-label": title });
    this.canvas.style.height = `${height}px`;
    this.#legend = make("ul", this.figure, { class: "picture-legend" });
    new ResizeObserver(() => this.again()).observe(this.canvas);
    new IntersectionObserver((entries) => {
      this.#visible = entries.at(-1).isIntersecting;
      if (this.#visible && this.#due) this.#compute();
      else if (this.#visible) this.again();
    }, { rootMargin: "200px" }).observe(this.canvas);
    Inks.listen(() => {
      this.again();
      if (this.#content) this.#writeLegend(this.#content.legend ?? []);
    });
  }

  /** What the picture is called in names of files, and as a title. */
  get name() {
    return this.#name;
  }

  get title() {
    return this.#title;
  }

  /** The present picture. */
  get content() {
    return this.#content;
  }

  /** The panels in pixels of the canvas: left, top, right, bottom. */
  get areas() {
    return this.#areas;
  }

  /** Shows other content. */
  draw(content) {
    const legend = JSON.stringify(content.legend ?? []);
    const changed = legend !== JSON.stringify(this.#content?.legend ?? []);
    this.#content = content;
    this.again();
    if (changed) this.#writeLegend(content.legend ?? []);
    clearTimeout(this.#words);
    this.#words = setTimeout(() => {
      const label = `${this.#title}. ${content.words?.() ?? ""}`;
      if (label !== this.canvas.getAttribute("aria-label")) this.canvas.setAttribute("aria-label", label);
    }, PLOT.pause);
  }

  /** Computes the picture by a function: at once if it is visible, else when it becomes visible or after a
   * pause, since its words are read also if it is not visible. */
  update(compute) {
    this.#due = compute;
    clearTimeout(this.#later);
    if (this.#visible) this.#compute();
    else this.#later = setTimeout(() => this.#compute(), PLOT.pause);
  }

  #compute() {
    clearTimeout(this.#later);
    const compute = this.#due;
    this.#due = undefined;
    compute?.();
  }

  /** Draws the picture once more. */
  again() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!this.#content || width === 0 || height === 0) return;
    const scale = devicePixelRatio || 1;
    const [columns, rows] = [Math.round(width * scale), Math.round(height * scale)];
    if (this.canvas.width !== columns || this.canvas.height !== rows) {
      [this.canvas.width, this.canvas.height] = [columns, rows];
    }
    const context = this.canvas.getContext("2d");
    context.setTransform(columns / width, 0, 0, rows / height, 0, 0);
    this.#areas = this.paint(context, width, height);
  }

  /** Draws the picture with a context, this many units wide and high; returns the places of its panels. */
  paint(context, width, height) {
    context.fillStyle = Inks.of("--plot-back");
    context.fillRect(0, 0, width, height);
    const { x, panels, sentence } = this.#content;
    if (sentence) {
      paragraph(context, sentence, { left: 8, top: 8, width: width - 16 });
      return [];
    }
    const room = height - PLOT.top - PLOT.below - PLOT.between * (panels.length - 1);
    return panels.map((panel, index) => {
      const top = PLOT.top + index * (room / panels.length + PLOT.between);
      const area = { left: PLOT.left, right: width - PLOT.right, top, bottom: top + room / panels.length };
      if (area.right - area.left < 20 || area.bottom - area.top < 20) return area;
      const isLast = index === panels.length - 1;
      paintPanel(context, area, x, panel, isLast);
      return area;
    });
  }

  #writeLegend(entries) {
    this.#legend.replaceChildren(...entries.map((entry) => {
      const item = document.createElement("li");
      const swatch = document.createElement("canvas");
      const scale = devicePixelRatio || 1;
      [swatch.width, swatch.height] = [Math.round(36 * scale), Math.round(14 * scale)];
      swatch.setAttribute("aria-hidden", "true");
      const context = swatch.getContext("2d");
      context.scale(scale, scale);
      paintSwatch(context, entry, 0, 0);
      const words = document.createElement("span");
      words.textContent = entry.words;
      item.append(swatch, words);
      return item;
    }));
  }
}

/** A panel: its grid and numbers, its content, and its frame. */
function paintPanel(context, area, x, { y, paint }, isLast) {
  const pen = new Pen(context, area, x.range, y.range);
  const across = roundNumbers(x.range, Math.max(2, Math.floor((area.right - area.left) / 52)));
  const up = roundNumbers(y.range, Math.max(2, Math.floor((area.bottom - area.top) / 30)));
  context.save();
  context.beginPath();
  context.rect(area.left, area.top, area.right - area.left, area.bottom - area.top);
  context.clip();
  for (const value of across) pen.upright(value, { ink: "--plot-grid", width: 1 });
  for (const value of up) pen.level(value, { ink: "--plot-grid", width: 1 });
  paint(pen);
  context.restore();
  context.lineWidth = 1;
  context.strokeStyle = Inks.of("--plot-faint");
  context.strokeRect(area.left, area.top, area.right - area.left, area.bottom - area.top);
  context.font = `${PLOT.font}px system-ui, sans-serif`;
  context.fillStyle = Inks.of("--plot-ink");
  context.textBaseline = "middle";
  context.textAlign = "right";
  for (const value of up) context.fillText(plotNumber(value), area.left - 6, pen.y(value));
  upwards(context, axisName(y), area);
  if (!isLast) return;
  context.textAlign = "center";
  context.textBaseline = "top";
  for (const value of across) context.fillText(plotNumber(value), pen.x(value), area.bottom + 5);
  context.fillText(axisName(x), (area.left + area.right) / 2, area.bottom + 21);
}

function axisName({ name, unit }) {
  return unit ? `${name} (${unit})` : name;
}

/** The name of a vertical axis, left of its numbers. */
function upwards(context, words, area) {
  context.save();
  context.translate(8, (area.top + area.bottom) / 2);
  context.rotate(-Math.PI / 2);
  context.textAlign = "center";
  context.fillText(words, 0, 0, area.bottom - area.top + PLOT.between);
  context.restore();
}

/** Words in lines of a width; how high they are. */
function paragraph(context, text, { left, top, width }) {
  context.font = `${PLOT.font + 1}px system-ui, sans-serif`;
  context.textAlign = "left";
  context.textBaseline = "top";
  context.fillStyle = Inks.of("--plot-ink");
  let [line, down] = ["", top];
  for (const word of text.split(" ")) {
    const longer = line ? `${line} ${word}` : word;
    if (line && context.measureText(longer).width > width) {
      context.fillText(line, left, down);
      [line, down] = [word, down + PLOT.font * 1.5];
    } else {
      line = longer;
    }
  }
  context.fillText(line, left, down);
  return down + PLOT.font * 1.5 - top;
}

/** The sample of a legend's entry, 36 by 14: a line, a mark, the fill of a region of a map, or, where the
 * entry goes on from the one above it, nothing. */
function paintSwatch(context, { ink = "--plot-ink", dash = [], width = 2, mark, fill, blank }, left, top) {
  if (blank) return;
  context.save();
  context.translate(left, top);
  const pen = new Pen(context, { left: 0, right: 36, top: 0, bottom: 14 }, [0, 36], [14, 0]);
  if (fill) fillRegion(context, fill, { left: 0, top: 1, right: 36, bottom: 13 });
  else if (mark) pen[mark](18, 7, { ink });
  else pen.line([0, 36], [7, 7], { ink, dash, width });
  context.restore();
}

/** A picture over time. */
class Strip {
  /** The figure. */
  picture;
  /** Level lines: the number of a line whose panel they are in, the value, and words. */
  levels;
  #seconds;
  #lines;
  #times = [];
  #columns;
  #shown;

  constructor(parent, { name, title, seconds = 2, height = 280, lines, levels = [] }) {
    this.picture = new Picture(parent, { name, title, height });
    [this.#seconds, this.#lines, this.levels] = [seconds, lines, levels];
    this.clear();
  }

  /** A sample: the time in s, which rises, and a value for each line. */
  push(time, values) {
    this.#times.push(time);
    this.#columns.forEach((column, index) => column.push(values[index] ?? NaN));
  }

  /** Forgets all samples. */
  clear() {
    this.#times = [];
    this.#columns = this.#lines.map(() => []);
  }

  /** Draws the last seconds of what was pushed. */
  draw() {
    const end = this.#times.at(-1) ?? this.#seconds;
    const old = this.#times.findIndex((time) => time >= end - this.#seconds);
    // Taking away from the front costs as much as all that is left: rarely, and much of it.
    if (old > Math.max(1000, this.#times.length / 2)) {
      this.#times.splice(0, old);
      for (const column of this.#columns) column.splice(0, old);
    }
    const first = Math.max(0, this.#times.findIndex((time) => time >= end - this.#seconds));
    const columns = this.#columns.map((column) => column.slice(first));
    this.#paint([end - this.#seconds, end], this.#times.slice(first), columns);
  }

  /** Draws samples that are given all at once; `more` has what a picture's content has besides. */
  show(times, columns, more = {}) {
    const end = times.length > 1 ? times[times.length - 1] : this.#seconds;
    this.#paint([times[0] ?? 0, end], times, columns, more);
  }

  #paint(range, times, columns, more = {}) {
    const units = [...new Set(this.#lines.map((line) => line.unit))];
    const ink = (index) => this.#lines[index].ink ?? `--plot-${1 + (index % 4)}`;
    const dash = (index) => this.#lines[index].dash ?? [];
    const panels = units.map((unit) => {
      const members = this.#lines.flatMap((line, index) => (line.unit === unit ? [index] : []));
      const values = function* () {
        for (const index of members) yield* columns[index];
      };
      const shown = rangeAround(values(), 0.08, this.#lines[members[0]].least ?? 0);
      const levels = this.levels.filter(({ line, value }) =>
        members.includes(line) && value >= shown[0] && value <= shown[1]);
      return {
        y: {
          name: members.map((index) => this.#lines[index].name).join(", "),
          unit,
          range: shown,
        },
        paint: (pen) => {
          pen.level(0, { ink: "--plot-faint", width: 1 });
          for (const { value, words } of levels) {
            pen.level(value, { ink: "--plot-faint", dash: [2, 4] });
            if (words) pen.words(range[0], value, words, { ink: "--plot-ink" });
          }
          for (const index of members) {
            pen.line(times, columns[index], { ink: ink(index), dash: dash(index) });
          }
        },
      };
    });
    const legend = units.length < this.#lines.length
      ? this.#lines.map(({ name }, index) => ({ ink: ink(index), dash: dash(index), words: name }))
      : [];
    const words = () => this.#lines.map(({ name, unit }, index) => {
      const [low, high] = rangeAround(columns[index], 0);
      const last = plotNumber(columns[index][columns[index].length - 1]);
      return `${name} from ${plotNumber(low)} to ${plotNumber(high)} ${unit}, ${last} ${unit} at the end`;
    }).join("; ");
    this.picture.draw({ x: { name: "time", unit: "s", range }, panels, legend, words, ...more });
  }
}
