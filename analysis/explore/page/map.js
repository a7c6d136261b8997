// The stability map: what becomes of the scene with other numbers. A click, a tap or the arrow keys go there.

/** Cells of a map along each axis: 40 000 in all. */
const MAP_CELLS = [200, 200];
/** Part of an axis that an arrow key goes, and with the shift key. */
const MAP_STEP = { plain: 0.01, shift: 0.1 };
/** The lines over a region: how they run, and how far they are apart in pixels; a region that has none is
 * plain. */
const MAP_HATCH = {
  "certified-exact": { lines: ["level"], apart: 10 },
  undecided: { lines: ["rising"], apart: 7 },
  rejected: { lines: ["falling"], apart: 9 },
  unstable: { lines: ["rising", "falling"], apart: 7 },
  wrong: { lines: ["upright", "level"], apart: 5 },
};
/** The custom properties of the regions' colours. */
const MAP_INK = {
  "certified-paper": "--map-paper",
  "certified-exact": "--map-exact",
  undecided: "--map-undecided",
  rejected: "--map-rejected",
  unstable: "--map-unstable",
  wrong: "--map-wrong",
};

/** A tile of a region's lines, as a pattern to fill with. */
function hatchOf(context, region) {
  const hatch = MAP_HATCH[region];
  if (!hatch) return null;
  const { lines, apart } = hatch;
  const scale = devicePixelRatio || 1;
  const tile = document.createElement("canvas");
  tile.width = tile.height = Math.round(apart * scale);
  const side = tile.width;
  const pen = tile.getContext("2d");
  pen.strokeStyle = Inks.of("--map-line");
  pen.globalAlpha = 0.45;
  pen.lineWidth = scale;
  const ends = {
    rising: [[0, 1, 1, 0], [-0.5, 0.5, 0.5, -0.5], [0.5, 1.5, 1.5, 0.5]],
    falling: [[0, 0, 1, 1], [-0.5, 0.5, 0.5, 1.5], [0.5, -0.5, 1.5, 0.5]],
    level: [[0, 0.5, 1, 0.5]],
    upright: [[0.5, 0, 0.5, 1]],
  };
  for (const [x0, y0, x1, y1] of lines.flatMap((line) => ends[line])) {
    pen.beginPath();
    pen.moveTo(x0 * side, y0 * side);
    pen.lineTo(x1 * side, y1 * side);
    pen.stroke();
  }
  const pattern = context.createPattern(tile, "repeat");
  pattern.setTransform(new DOMMatrix().scale(1 / scale));
  return pattern;
}

/** Fills a rectangle with a region's colour and lines. */
function fillRegion(context, region, { left, top, right, bottom }) {
  context.fillStyle = Inks.of(MAP_INK[region]);
  context.fillRect(left, top, right - left, bottom - top);
  const hatch = hatchOf(context, region);
  if (hatch) {
    context.fillStyle = hatch;
    context.fillRect(left, top, right - left, bottom - top);
  }
  context.lineWidth = 1;
  context.strokeStyle = Inks.of("--plot-faint");
  context.strokeRect(left + 0.5, top + 0.5, right - left - 1, bottom - top - 1);
}

/** Regions of cells as an image that is drawn at any size: once, as long as nothing changes. */
class RegionLayer {
  #kept;
  #key;

  /** Draws the regions in an area. `names` are those of the numbers. */
  draw(context, area, { regions, cells, names, version }) {
    const scale = context.getTransform().a;
    const [width, height] = [area.right - area.left, area.bottom - area.top]
      .map((side) => Math.max(1, Math.round(side * scale)));
    const key = [version, width, height, Inks.of("--map-rejected")].join(" ");
    if (key !== this.#key) {
      this.#kept = this.#compose({ regions, cells, names }, width, height, scale);
      this.#key = key;
    }
    context.drawImage(this.#kept, area.left, area.top, area.right - area.left, area.bottom - area.top);
  }

  #compose({ regions, cells, names }, width, height, scale) {
    const [layer, context] = this.#canvas(width, height);
    const coloured = this.#cells(regions, cells, names.map((name) => colourBytes(MAP_INK[name])));
    context.drawImage(coloured, 0, 0, width, height);
    const present = new Set(regions);
    names.forEach((name, number) => {
      if (!present.has(number) || !MAP_HATCH[name]) return;
      const [mask, pen] = this.#canvas(width, height);
      const only = names.map((_, other) => (other === number ? [0, 0, 0, 255] : [0, 0, 0, 0]));
      pen.drawImage(this.#cells(regions, cells, only), 0, 0, width, height);
      pen.globalCompositeOperation = "source-in";
      pen.scale(scale, scale);
      pen.fillStyle = hatchOf(pen, name);
      pen.fillRect(0, 0, width / scale, height / scale);
      context.drawImage(mask, 0, 0);
    });
    return layer;
  }

  #canvas(width, height) {
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [width, height];
    const context = canvas.getContext("2d");
    context.imageSmoothingEnabled = false;
    return [canvas, context];
  }

  /** A pixel for each cell; the lowest row of cells is the last one of pixels. */
  #cells(regions, [columns, rows], colours) {
    const [canvas, context] = this.#canvas(columns, rows);
    const image = context.createImageData(columns, rows);
    for (let row = 0; row < rows; row += 1) {
      for (let column = 0; column < columns; column += 1) {
        const colour = colours[regions[row * columns + column]];
        image.data.set(colour, 4 * ((rows - 1 - row) * columns + column));
      }
    }
    context.putImageData(image, 0, 0);
    return canvas;
  }
}

/** Red, green, blue and opacity of an ink, from 0 to 255. */
function colourBytes(ink) {
  const [red, green, blue] = Inks.of(ink).match(/[\d.]+/g).map(Number);
  return [red, green, blue, 255];
}

/** The map around the scene that is shown. */
class MapPicture {
  #store;
  #ask;
  #picture;
  #place;
  #selects;
  #layer = new RegionLayer();
  #axes = null;
  #family;
  #map;
  #cells;
  #version = 0;
  #asked = 0;
  #askedOf;
  #isAwaited = false;
  #isDue = false;
  #pointer = null;

  constructor(store, parent, ask) {
    [this.#store, this.#ask] = [store, ask];
    this.#picture = new Picture(parent, { name: "map", title: "Stability map", height: 360 });
    const { canvas, figure } = this.#picture;
    this.#selects = ["across", "up"].map((words, axis) => this.#select(words, axis));
    this.#place = document.createElement("p");
    this.#place.className = "picture-place";
    this.#place.id = "map-place";
    canvas.after(this.#place);
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "application");
    canvas.setAttribute("aria-describedby", "map-place");
    canvas.style.cursor = "crosshair";
    canvas.addEventListener("click", (event) => this.#go(this.#at(event)));
    canvas.addEventListener("pointermove", (event) => this.#point(this.#at(event)));
    canvas.addEventListener("pointerleave", () => this.#point(null));
    canvas.addEventListener("keydown", (event) => this.#key(event));
    figure.dataset.progress = "0";
  }

  /** Shows the scene of the store: another map, or another place in the same one. */
  show() {
    this.#picture.update(() => this.#compute());
  }

  #compute() {
    const family = this.#familyOf(this.#store.scene);
    const isInside = () => this.#own().every((value, axis) => {
      const [from, to] = this.#map.axes[axis].range;
      return value >= from && value <= to;
    });
    if (this.#map && family === this.#family && isInside()) {
      this.#draw();
      return;
    }
    this.#question();
  }

  /** All that the map depends on of a scene: without the two numbers of its axes. */
  #familyOf(shown) {
    const scene = structuredClone(shown);
    for (const name of ["name", "simulation", "human"]) delete scene[name];
    for (const { key } of this.#map?.axes ?? []) {
      const names = key.split(".");
      const last = names.pop();
      const table = names.reduce((inner, name) => inner?.[name], scene);
      if (table) delete table[last];
    }
    return JSON.stringify([scene, this.#axes]);
  }

  /** Asks for a map. While the first picture of one is awaited no other is asked for: as one drags, there is
   * always something to see. */
  #question() {
    if (this.#isAwaited) {
      this.#isDue = true;
      return;
    }
    [this.#isAwaited, this.#isDue] = [true, false];
    this.#askedOf = structuredClone(this.#store.scene);
    this.#asked = this.#ask({ kind: "map", scene: this.#store.text(), axes: this.#axes, cells: MAP_CELLS });
  }

  /** Takes an answer of the worker. */
  take({ id, refusal, map, cells, regions, done, time }) {
    if (id !== this.#asked) return;
    if (refusal !== undefined) {
      this.#isAwaited = false;
      if (this.#axes !== null) {
        // Axes that another scene has not.
        this.#axes = null;
        this.#question();
        return;
      }
      this.#map = undefined;
      const sentence = refusalOf("map", refusal);
      this.#picture.draw({ sentence, words: () => sentence });
    } else {
      if (map) {
        this.#map = map;
        this.#isAwaited = false;
        this.#offer();
        // By now the scene may be another one.
        this.#family = this.#familyOf(this.#askedOf);
      }
      this.#version += 1;
      const names = this.#map.regions.map((region) => region.name);
      this.#cells = { regions, cells, names, version: this.#version };
      // For programs: the map's state, and its time in ms after the worker began.
      const { dataset } = this.#picture.figure;
      if (done) dataset.progress = done;
      const mark = { "1/256": "firstMs", "1/1": "drawnMs", all: "allMs" }[done];
      if (mark) dataset[mark] = time.toFixed(1);
      this.#draw();
    }
    if (this.#isDue) this.#compute();
  }

  /** Offers the keys that axes may go along. */
  #offer() {
    this.#selects.forEach((select, axis) => {
      const keys = this.#map.choice.map((number) => number.key);
      if (select.dataset.keys !== keys.join()) {
        select.dataset.keys = keys.join();
        select.replaceChildren(...this.#map.choice.map(({ key, name }) => new Option(name, key)));
      }
      select.value = this.#map.axes[axis].key;
    });
  }

  #select(words, axis) {
    const label = document.createElement("label");
    const select = document.createElement("select");
    label.append(words, select);
    select.addEventListener("change", () => {
      const keys = this.#selects.map((other) => other.value);
      // The same on both axes: they change places.
      if (keys[0] === keys[1]) keys[1 - axis] = this.#map.axes[axis].key;
      this.#axes = keys;
      this.#question();
    });
    this.#picture.tools.lastChild.before(label);
    return select;
  }

  /** The scene's two numbers at present. */
  #own() {
    return this.#map.axes.map(({ key, value }) => {
      const own = this.#store.get(key);
      const longest = Array.isArray(own) ? own.at(-1) : own;
      return typeof longest === "number" ? longest : value;
    });
  }

  #draw() {
    if (!this.#map || !this.#cells) return;
    const [x, y] = this.#map.axes;
    const own = this.#own();
    const shares = this.#shares();
    const legend = this.#map.regions
      .map((region, number) => ({ fill: region.name, words: region.words, share: shares[number] ?? 0 }))
      .filter(({ share }) => share > 0)
      .reverse()
      .map(({ fill, words, share }) => ({ fill, words: `${words} (${plotNumber(100 * share, 3)} %)` }));
    legend.push({ mark: "cross", words: "the scene" });
    this.#picture.draw({
      x,
      panels: [{
        y,
        paint: (pen) => {
          this.#layer.draw(pen.context, pen.area, this.#cells);
          pen.level(0, { ink: "--map-line", width: 1 });
          pen.upright(0, { ink: "--map-line", width: 1 });
          pen.cross(...own);
        },
      }],
      legend,
      words: () => {
        const words = legend.slice(0, -1).map((entry) => entry.words).join("; ");
        const range = ({ name, unit, range: [from, to] }) =>
          `${name} from ${plotNumber(from)} to ${plotNumber(to)} ${unit}`;
        return `${range(x)} across, ${range(y)} up. ${words}. ${this.#sentence(own, "The scene")}. ` +
          "Arrow keys move it";
      },
    });
    this.#say();
  }

  #shares() {
    const counts = [];
    for (const region of this.#cells.regions) counts[region] = (counts[region] ?? 0) + 1;
    return counts.map((count) => (count ?? 0) / this.#cells.regions.length);
  }

  /** Where something is, and what becomes of a scene there. */
  #sentence(values, what) {
    const { axes, regions } = this.#map;
    const places = axes.map(({ name, unit }, axis) => `${name} ${plotNumber(values[axis])} ${unit}`.trim());
    const [column, row] = values.map((value, axis) => {
      const [from, to] = axes[axis].range;
      const cell = Math.floor((value - from) / (to - from) * this.#cells.cells[axis]);
      return Math.max(0, Math.min(this.#cells.cells[axis] - 1, cell));
    });
    const region = regions[this.#cells.regions[row * this.#cells.cells[0] + column]];
    return `${what} at ${places.join(", ")}: ${region.words}`;
  }

  #say() {
    if (!this.#map || !this.#cells) return;
    const words = this.#pointer
      ? this.#sentence(this.#pointer, "Pointer")
      : this.#sentence(this.#own(), "The scene");
    if (this.#place.textContent !== words) this.#place.textContent = words;
  }

  /** The values of both axes under the pointer; null outside of the map. */
  #at(event) {
    const [area] = this.#picture.areas;
    if (!area || !this.#map) return null;
    const [x, y] = [event.offsetX, event.offsetY];
    const parts = [
      (x - area.left) / (area.right - area.left),
      (area.bottom - y) / (area.bottom - area.top),
    ];
    if (parts.some((part) => part < 0 || part > 1)) return null;
    return parts.map((part, axis) => {
      const [from, to] = this.#map.axes[axis].range;
      return from + part * (to - from);
    });
  }

  #point(values) {
    this.#pointer = values;
    this.#say();
  }

  /** Moves the scene to a place. */
  #go(values) {
    if (!values) return;
    const { axes, also } = this.#map;
    for (const [key, value] of also) this.#store.set(key, value);
    axes.forEach(({ key, whole, range: [from, to] }, axis) => {
      // As many digits as a pixel of the map is worth.
      const step = 10 ** (Math.floor(Math.log10(to - from)) - 3);
      const rounded = Number((Math.round(values[axis] / step) * step).toPrecision(12));
      this.#store.set(key, whole ? Math.max(1, Math.round(values[axis])) : rounded);
    });
  }

  #key(event) {
    const [across, up] = {
      ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1],
    }[event.key] ?? [];
    if (across === undefined || !this.#map) return;
    event.preventDefault();
    const part = event.shiftKey ? MAP_STEP.shift : MAP_STEP.plain;
    this.#go(this.#own().map((value, axis) => {
      const { range: [from, to], whole } = this.#map.axes[axis];
      const step = [across, up][axis] * part * (to - from);
      const moved = value + (whole ? Math.sign(step) * Math.max(1, Math.round(Math.abs(step))) : step);
      return Math.max(from, Math.min(to, moved));
    }));
  }
}
