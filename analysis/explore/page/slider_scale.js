// How far a slider goes around the present value of its key, and in which steps.

/** The values along a slider. */
class SliderScale {
  /** Steps of a slider that is not one of whole numbers. */
  static #STEPS = 1000;
  /** How far a logarithmic slider goes to either side, as a factor: one and a half decades. */
  static #REACH = 10 ** 1.5;
  /** Half of the range in rad of a slider for small angles. */
  static #LEAST_ANGLE = 1;

  /** Last step; the first is 0. */
  steps = SliderScale.#STEPS;
  #valueAt;
  #stepAt;
  #bounds;

  constructor(bounds, valueAt, stepAt) {
    [this.#bounds, this.#valueAt, this.#stepAt] = [bounds, valueAt, stepAt];
  }

  /** The scale for a key around a value; where that is 0, around `usual`. */
  static around(key, value, usual) {
    const whole = key.form.whole;
    if (whole) return SliderScale.#whole(whole[0], Math.min(whole[1], Math.max(8, 2 * value)));
    if (key.form.number === "fraction") return SliderScale.#linear(0, 0.999);
    if (key.unit === "rad" && key.form.number === "finite") {
      const far = Math.max(2 * Math.abs(value), SliderScale.#LEAST_ANGLE);
      return SliderScale.#linear(-far, far);
    }
    if (value < 0) return SliderScale.#linear(2 * value, -2 * value);
    return SliderScale.#logarithmic(value || usual || 1, key.form.number !== "positive");
  }

  static #whole(least, most) {
    const scale = new SliderScale([least, most], (step) => least + step, (value) => value - least);
    scale.steps = most - least;
    return scale;
  }

  static #linear(least, most) {
    const width = most - least;
    const valueAt = (step) => least + (width * step) / SliderScale.#STEPS;
    return new SliderScale([least, most], valueAt, (value) => ((value - least) / width) * SliderScale.#STEPS);
  }

  /** Each step is the same factor; the first one is 0 where the key takes that. */
  static #logarithmic(middle, hasZero) {
    const [least, most] = [middle / SliderScale.#REACH, middle * SliderScale.#REACH];
    const factor = Math.log(most / least);
    const steps = SliderScale.#STEPS;
    const valueAt = (step) => (hasZero && step === 0 ? 0 : least * Math.exp((factor * step) / steps));
    const stepAt = (value) => (value <= least ? 0 : (Math.log(value / least) / factor) * steps);
    return new SliderScale([hasZero ? 0 : least, most], valueAt, stepAt);
  }

  /** Whether a value is on the slider. */
  holds(value) {
    return this.#bounds[0] <= value && value <= this.#bounds[1];
  }

  /** The value at a step, in three digits. */
  value(step) {
    return Number(this.#valueAt(step).toPrecision(3));
  }

  /** The step of a value. */
  step(value) {
    return Math.round(Math.min(Math.max(this.#stepAt(value), 0), this.steps));
  }
}
