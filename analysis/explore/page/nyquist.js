// The Nyquist plot: what of the scene is judged, and the line that it must keep to the right of.

/** Frequencies that are marked, in each decade, and how far marks are apart in pixels. */
const NYQUIST_MARKS = { steps: [1, 2, 5], decades: 6, apart: 52 };

/** Draws the scene's Nyquist plot whenever the scene changes. */
class NyquistPicture {
  #engine;
  #picture;

  constructor(engine, parent) {
    this.#engine = engine;
    this.#picture = new Picture(parent, { name: "nyquist", title: "Nyquist plot", height: 320 });
  }

  /** Shows a scene, given as text. */
  show(text) {
    this.#picture.update(() => this.#compute(text));
  }

  #compute(text) {
    let plot;
    try {
      plot = this.#engine.json("nyquist", text);
    } catch (refusal) {
      const sentence = refusalOf("Nyquist plot", refusal.message);
      this.#picture.draw({ sentence, words: () => sentence });
      return;
    }
    const points = this.#engine.numbers();
    let used = 0;
    for (const curve of plot.curves) {
      curve.parts = curve.branches.map((count) => {
        const part = points.subarray(3 * used, 3 * (used + count));
        used += count;
        return columnsOf(part, 3);
      });
    }
    this.#draw(plot);
  }

  #draw(plot) {
    const entries = (stroke, sentences) =>
      sentences.map((words, index) => (index === 0 ? { ...stroke, words } : { blank: true, words }));
    const legend = plot.curves.flatMap((curve, index) =>
      entries(nyquistStroke(curve), index === 0 ? [plot.halves, ...curve.words] : curve.words));
    if (plot.bound_words) legend.push(...entries({ ink: "--plot-2", width: 3 }, plot.bound_words));
    if (plot.limit !== null) {
      legend.push({ dash: [8, 5], width: 2, words: `critical line, ${nyquistLimit(plot)} N m s/rad` });
    }
    this.#picture.draw({
      x: { name: "real part", unit: "N m s/rad", range: plot.x },
      panels: [{
        y: { name: "imaginary part", unit: "N m s/rad", range: plot.y },
        paint: (pen) => paintNyquist(pen, plot),
      }],
      legend,
      words: () => legend.map((entry) => entry.words).join(". "),
    });
  }
}

function nyquistLimit(plot) {
  return `${plot.limit_name} = ${plotNumber(-plot.limit)}`;
}

function nyquistStroke(curve) {
  if (!curve.judged) return { ink: "--plot-faint", width: 2 };
  if (curve.role === "judged-latched") return { ink: "--plot-4", width: 2.5, dash: [6, 4] };
  return { ink: "--plot-1", width: 2.5 };
}

/** Numbers in rows, as so many columns. */
function columnsOf(numbers, width) {
  const rows = numbers.length / width;
  return Array.from({ length: width }, (_, column) => {
    const values = new Float64Array(rows);
    for (let row = 0; row < rows; row += 1) values[row] = numbers[row * width + column];
    return values;
  });
}

function paintNyquist(pen, plot) {
  const forbidden = plot.limit === null ? plot.x[1] : -plot.limit;
  pen.band(plot.x[0], forbidden, "--plot-forbidden");
  pen.level(0, { ink: "--plot-faint", width: 1 });
  pen.upright(0, { ink: "--plot-faint", width: 1 });
  if (plot.limit !== null) {
    pen.upright(-plot.limit, { dash: [8, 5], width: 2 });
    pen.words(-plot.limit, plot.y[1], nyquistLimit(plot), { align: "right", below: true });
  }
  for (const curve of plot.curves) {
    const stroke = nyquistStroke(curve);
    if (curve.asymptote !== null && curve.judged) {
      pen.upright(curve.asymptote, { ink: "--plot-faint", dash: [1, 5], width: 1 });
    }
    for (const [, re, im] of curve.parts) {
      const [xs, ys] = thinned(pen, re, im);
      pen.line(xs, ys.map((y) => -y), { ...stroke, width: 1 });
      pen.line(xs, ys, stroke);
    }
  }
  if (plot.bound !== null) {
    pen.upright(-plot.bound, { ink: "--plot-2", width: 3 });
    pen.words(-plot.bound, plot.y[0], `bound, ${plotNumber(-plot.bound)}`, { ink: "--plot-2" });
  }
  const judged = plot.curves.filter((curve) => curve.judged);
  for (const curve of judged) markFrequencies(pen, curve, plot.period);
  for (const { alpha, minimum, phase_margin: margin } of judged) {
    if (margin !== null) pen.ring(margin[0], margin[1], { ink: "--plot-3", radius: 4 });
    if (alpha === null) continue;
    const shown = minimum !== null && Math.abs(minimum[1]) <= plot.y[1] ? minimum : [-alpha, 0];
    pen.ring(shown[0], shown[1]);
  }
}

/** The points of a line without those that are less than half a pixel from the one before. */
function thinned(pen, re, im) {
  const [xs, ys] = [[], []];
  let [left, top] = [Infinity, Infinity];
  for (let i = 0; i < re.length; i += 1) {
    const [x, y] = [pen.x(re[i]), pen.y(im[i])];
    if (i < re.length - 1 && Math.abs(x - left) + Math.abs(y - top) < 0.5) continue;
    [left, top] = [x, y];
    xs.push(re[i]);
    ys.push(im[i]);
  }
  return [xs, ys];
}

/** Marks round frequencies in Hz along a curve, as far as there is room. */
function markFrequencies(pen, curve, period) {
  const highest = 0.5 / period;
  const decade = Math.floor(Math.log10(highest));
  const marked = [];
  for (let down = 0; down < NYQUIST_MARKS.decades; down += 1) {
    for (const step of [...NYQUIST_MARKS.steps].reverse()) {
      const hertz = step * 10 ** (decade - down);
      const place = hertz <= highest ? placeAt(curve, 2 * Math.PI * hertz * period) : undefined;
      if (!place) continue;
      const [x, y] = [pen.x(place[0]), pen.y(place[1])];
      const { left, right, top, bottom } = pen.area;
      const inside = x > left + 4 && x < right - 4 && y > top + 4 && y < bottom - 4;
      if (!inside || marked.some(([a, b]) => Math.hypot(a - x, b - y) < NYQUIST_MARKS.apart)) continue;
      marked.push([x, y]);
      pen.dot(place[0], place[1], { ink: nyquistStroke(curve).ink });
      pen.words(place[0], place[1], `${plotNumber(hertz, 3)} Hz`);
    }
  }
}

/** The value of a curve at an angle in rad, between two of its points. */
function placeAt(curve, theta) {
  for (const [angles, re, im] of curve.parts) {
    if (angles.length < 2 || theta < angles[0] || theta > angles[angles.length - 1]) continue;
    let [low, high] = [0, angles.length - 1];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (angles[middle] <= theta) low = middle;
      else high = middle;
    }
    const part = (theta - angles[low]) / (angles[high] - angles[low] || 1);
    return [re[low] + part * (re[high] - re[low]), im[low] + part * (im[high] - im[low])];
  }
  return undefined;
}
