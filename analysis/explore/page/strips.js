// Curves of the last seconds of a board, one under the other.

/** What a curve shows, in the order in which the program gives them. */
const STRIPS = ["position, rad", "coupling torque, N m", "margin, N m s/rad", "energy into the hand, J"];
/** Heights in pixels: of a curve, and of the words above it. */
const [STRIP_HEIGHT, STRIP_TITLE] = [72, 18];

/** The curves that numbers are: of each how many points, and the points. */
function curvesOf(numbers) {
  const curves = [];
  for (let at = 0; at < numbers.length; at += 1 + 2 * numbers[at]) {
    curves.push(numbers.subarray(at + 1, at + 1 + 2 * numbers[at]));
  }
  return curves;
}

/** A number with four digits, for a label. */
function shortNumber(value) {
  return Number.isFinite(value) ? String(Number(value.toPrecision(4))) : "none";
}

/** Draws the curves of so many seconds, at the width that the canvas has on the page. */
function drawStrips(canvas, curves, seconds) {
  const [ratio, width] = [window.devicePixelRatio || 1, canvas.clientWidth];
  const height = STRIPS.length * (STRIP_HEIGHT + STRIP_TITLE);
  if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
  if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
  const pen = canvas.getContext("2d");
  // Of the canvas the colour of curves, around it that of words: both are colours in either theme.
  const style = getComputedStyle(canvas);
  const colours = { curve: style.color, words: getComputedStyle(canvas.parentElement).color };
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  pen.font = `12px ${style.fontFamily}`;
  STRIPS.forEach((title, i) => {
    const top = i * (STRIP_HEIGHT + STRIP_TITLE);
    drawStrip(pen, colours, { title, curve: curves[i] ?? [], top, width, seconds });
  });
}

/** Draws one curve between its least and its largest value, with both beside it. */
function drawStrip(pen, colours, { title, curve, top, width, seconds }) {
  const values = curve.filter((_, i) => i % 2 === 1);
  const [low, high] = values.reduce(([l, h], v) => [Math.min(l, v), Math.max(h, v)], [Infinity, -Infinity]);
  const [first, last] = [top + STRIP_TITLE, top + STRIP_TITLE + STRIP_HEIGHT - 6];
  [pen.fillStyle, pen.strokeStyle] = [colours.words, colours.words];
  const words = `${title}: ${shortNumber(values.at(-1) ?? NaN)}`;
  pen.fillText(words, 0, top + 13);
  pen.lineWidth = 1;
  pen.globalAlpha = 0.3;
  pen.strokeRect(0.5, first + 0.5, width - 1, last - first);
  pen.globalAlpha = 1;
  if (values.length === 0) return;
  const left = width - pen.measureText(words).width - 12;
  const bounds = `${shortNumber(low)} to ${shortNumber(high)}`;
  const range = [`${bounds} in ${seconds} s`, bounds].find((text) => pen.measureText(text).width < left);
  if (range !== undefined) pen.fillText(range, width - pen.measureText(range).width, top + 13);
  const height = Math.max(high - low, 1e-6 * Math.max(Math.abs(low), Math.abs(high), 1));
  const middle = 0.5 * (low + high);
  pen.strokeStyle = colours.curve;
  pen.lineWidth = 1.5;
  pen.beginPath();
  for (let i = 0; i < curve.length; i += 2) {
    const x = width * (1 + curve[i] / seconds);
    const y = 0.5 * (first + last) - (curve[i + 1] - middle) / height * (last - first - 8);
    pen.lineTo(x, y);
  }
  pen.stroke();
}
