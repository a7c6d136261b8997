// The hand that holds the handle, and the handle's encoder, as fields with sliders.

class HandSettings {
  /** What each field is called, its unit, its slider's middle, and whether it may be left empty. */
  static #FIELDS = {
    stiffness: { words: "Hand stiffness", unit: "N m/rad", usual: 6 },
    damping: { words: "Hand damping", unit: "N m s/rad", usual: 0.02 },
    inertia: { words: "Hand inertia", unit: "kg m^2", usual: 1e-4 },
    counts: { words: "Encoder counts", unit: "a turn", usual: 65536, isOptional: true },
  };
  /** What the page shows. */
  element;
  #fields = {};

  /** Has a function called after each change. */
  constructor(changed) {
    const rows = Object.keys(HandSettings.#FIELDS).map((name) => this.#row(name, changed));
    const note = "Without encoder counts: the encoder of the scene, with its noise; with them, a quadrature encoder. "
      + "A changed scene goes on with the device as it "
      + "moves; its servo has settled at the device's angle when it takes over. The device is one rigid body, "
      + "with the scene's delay, lags, friction and cogging.";
    this.element = make("details", { id: "handle-settings" },
      make("summary", {}, "Hand and encoder"), ...rows, this.#encoders(changed), make("p", { className: "note" }, note));
  }

  /** Buttons for two encoders: that of the scene, and a finer one without noise. */
  #encoders(changed) {
    const choice = (id, words, counts) => {
      const button = make("button", { type: "button", id }, words);
      button.addEventListener("click", () => {
        this.#fields.counts.field.value = counts;
        changed();
      });
      return button;
    };
    return make("p", {}, choice("handle-own-encoder", "Encoder of the scene", ""), " ",
      choice("handle-fine-encoder", "10,000 counts", "10000"));
  }

  #row(name, changed) {
    const { words, unit, usual, isOptional } = HandSettings.#FIELDS[name];
    const error = make("p", { className: "error", id: `handle-${name}-error` });
    const field = make("input", {
      type: "text", id: `handle-${name}`, inputMode: "decimal", value: isOptional ? "" : String(usual),
      autocomplete: "off", "aria-describedby": error.id,
    });
    const form = { number: isOptional ? "positive" : "non-negative" };
    const scale = SliderScale.around({ form, unit }, usual);
    const slider = make("input", {
      type: "range", min: 0, max: scale.steps, value: scale.step(usual), "aria-label": `${words} (${unit})`,
    });
    slider.addEventListener("input", () => {
      const value = scale.value(slider.value);
      field.value = isOptional ? Math.round(value) : value;
      changed();
    });
    field.addEventListener("input", () => {
      slider.value = scale.step(Number(field.value) || usual);
      changed();
    });
    this.#fields[name] = { field, error };
    return make("div", { className: "field" },
      make("label", { className: "name", htmlFor: field.id }, words), field,
      make("span", { className: "unit" }, unit), slider, error);
  }

  /** The numbers of all fields, null where one is left empty; undefined where one is not a number. */
  read() {
    const values = {};
    for (const name of Object.keys(this.#fields)) values[name] = this.#number(name);
    return Object.values(values).some(Number.isNaN) ? undefined : values;
  }

  #number(name) {
    const { words, unit, isOptional } = HandSettings.#FIELDS[name];
    const { field, error } = this.#fields[name];
    const text = field.value.trim();
    const isEmpty = isOptional && text === "";
    const value = text === "" ? NaN : Number(text);
    const isGood = isEmpty || (Number.isFinite(value) && (isOptional ? value > 0 : value >= 0));
    field.setAttribute("aria-invalid", String(!isGood));
    const bound = isOptional ? "above 0" : "of 0 or more";
    say(error, isGood ? "" : `${words} of "${text}" ${unit} must be a number ${bound}.`);
    if (isEmpty) return null;
    return isGood ? value : NaN;
  }
}
