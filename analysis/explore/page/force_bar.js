// The torque of the motor as a bar, which is as long as the largest torque that there was.

/** The reasons of a limit, by number, as a board names them. */
const LIMITS = [
  "", "torque limit", "converter's full scale", "angle out of range", "not a number", "ramp", "heat", "energy of the host",
];

class ForceBar {
  /** The least part of the torque limit that the bar shows. */
  static #LEAST = 0.01;
  /** What the page shows. */
  element;
  /** The torque in N m at its end. */
  scale = 0;
  #limit = 1;
  #bar;
  #range = make("div", { className: "range" });
  #mean = make("div", { className: "mean" });
  #words = make("output", { id: "handle-force" });

  constructor() {
    this.#bar = make("div", { id: "handle-bar", role: "meter", "aria-label": "Torque of the motor in N m" },
      this.#range, this.#mean);
    this.element = make("div", { id: "handle-torque" },
      make("span", {}, "Motor torque"), this.#bar, this.#words);
  }

  /** Begins anew, for a torque limit in N m. */
  begin(limit) {
    [this.#limit, this.scale] = [limit, 0];
  }

  /** Makes room for torques in N m: up to a round one. */
  widen(torques) {
    const least = ForceBar.#LEAST * this.#limit;
    const most = torques.reduce((peak, torque) => Math.max(peak, Math.abs(torque)), least);
    if (most <= this.scale) return;
    const decade = 10 ** Math.floor(Math.log10(most));
    const round = decade * [1, 2, 5, 10].find((factor) => factor * decade >= most);
    this.scale = Math.min(this.#limit, round);
  }

  /** Shows the mean of torques in N m, their range, and by what they were limited. */
  show({ least, most, mean, limit }) {
    const side = (torque) => 50 + 50 * Math.min(Math.max(torque / this.scale, -1), 1);
    const place = (element, from, to) => {
      [element.style.left, element.style.width] = [`${from}%`, `${Math.max(to - from, 0.5)}%`];
    };
    place(this.#range, side(least), side(most));
    place(this.#mean, side(Math.min(mean, 0)), side(Math.max(mean, 0)));
    this.#bar.classList.toggle("limited", limit !== 0);
    const ends = `bar to ${plotNumber(this.scale)} N m, limit ${plotNumber(this.#limit)} N m`;
    say(this.#words, `${mean.toFixed(3)} N m${limit ? `, limited: ${LIMITS[limit]}` : ""} (${ends})`);
    for (const [name, value] of [["min", -this.scale], ["max", this.scale], ["now", mean]]) {
      this.#bar.setAttribute(`aria-value${name}`, value.toFixed(3));
    }
  }
}
