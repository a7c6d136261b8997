// One key of the scene as a field: a label, an input, the unit, and the fault of its value.

/** The value that a text stands for: nothing, a number or, where `isList`, a list. Other input stays a
 * text, which the program refuses with the words of a scene file, so that it is kept in links and files. */
function valueOf(text, isList = false) {
  const trimmed = text.trim();
  if (trimmed === "") return undefined;
  if (isList && /^[[{]/.test(trimmed)) {
    try {
      return JSON.parse(trimmed);
    } catch {
      return trimmed;
    }
  }
  const number = Number(trimmed);
  return Number.isFinite(number) ? number : trimmed;
}

/** A value as a text that `valueOf` reads. */
function textOf(value) {
  if (value === undefined) return "";
  return typeof value === "object" ? JSON.stringify(value) : String(value);
}

/** What all fields have in common. */
class Field {
  /** The row on the page. */
  row;
  /** Full path of the key, with the numbers of lists. */
  path;
  key;
  store;
  #error;
  #inputs = [];
  #set;

  /** `isOptional`: a box before the name sets the key, with its example, or leaves it out. */
  constructor(store, key, path, isOptional) {
    [this.store, this.key, this.path] = [store, key, path];
    const id = Field.idOf(path);
    const label = make("label", { htmlFor: id, textContent: Field.nameOf(key) });
    const name = make("span", { className: "name" });
    if (isOptional) {
      this.#set = make("input", { type: "checkbox", id: `${id}-set`, ariaLabel: `set ${Field.nameOf(key)}` });
      this.#set.addEventListener("change", () => {
        store.set(path, this.#set.checked ? structuredClone(this.usual()) : undefined);
        this.show();
      });
      name.append(this.#set);
    }
    name.append(label);
    const words = make("span", { id: `${id}-doc`, className: "hidden", textContent: Field.wordsOf(key) });
    this.#error = make("p", { id: `${id}-error`, className: "error" });
    this.row = make("div", { className: "field" }, name, words, this.#error);
    this.row.dataset.key = path;
    this.row.dataset.words = Field.wordsOf(key);
  }

  /** What identifies a key's field on the page. */
  static idOf(path) {
    return `field-${path.replaceAll(/[.[\]]+/g, "-")}`;
  }

  /** A key's name for people. */
  static nameOf(key) {
    // The keys of this table stand among those of the device.
    return key.path.replace(/^device\.cogging\./, "cogging ").split(".").pop().replaceAll("_", " ");
  }

  /** What the reference of scene files says of a key. */
  static wordsOf(key) {
    const bare = key.default !== null ? `${key.default}` : key.without;
    return `${key.doc} It must be ${key.requirement}.${bare === null ? "" : ` Left out: ${bare}.`}`;
  }

  /** The value that the field starts with where it is set. */
  usual() {
    return this.key.example;
  }

  /** The value of the scene, or its default. */
  value() {
    return this.store.get(this.path) ?? this.key.default ?? undefined;
  }

  /** Puts the inputs of the value into the row. The label names the last of them. */
  take(...inputs) {
    const id = Field.idOf(this.path);
    for (const input of inputs) input.setAttribute("aria-describedby", `${id}-doc ${id}-error`);
    inputs.at(-1).id = id;
    this.#inputs = inputs;
    this.#error.before(...inputs);
  }

  /** Shows the scene's value. */
  show() {
    const isSet = this.#set === undefined || this.store.get(this.path) !== undefined;
    if (this.#set) this.#set.checked = isSet;
    for (const input of this.#inputs) input.disabled = !isSet;
    this.row.classList.toggle("unset", !isSet);
    this.draw(this.value());
  }

  /** Shows the fault of the value as a sentence; none: no fault. */
  complain(sentence = "") {
    if (this.#error.textContent !== sentence) this.#error.textContent = sentence;
    for (const input of this.#inputs) input.ariaInvalid = sentence === "" ? null : "true";
  }
}

/** A number, or a time that may be a range: a slider and a text. */
class NumberField extends Field {
  #text;
  #slider;
  #scale;

  constructor(store, key, path, isOptional) {
    super(store, key, path, isOptional);
    const name = Field.nameOf(key);
    this.#slider = make("input", { type: "range", min: 0, ariaLabel: `${name}, slider` });
    this.#text = make("input", { type: "text", inputMode: "decimal", spellcheck: false });
    this.#slider.addEventListener("input", () => {
      if (this.#scale === undefined) return;
      this.change(this.#scale.value(this.#slider.valueAsNumber));
      this.#text.value = textOf(this.value());
      this.#speak();
    });
    // The slider goes as far from the new value as it did from the old one.
    this.#slider.addEventListener("change", () => this.#rescale());
    this.#text.addEventListener("input", () => this.change(valueOf(this.#text.value, key.form === "time")));
    this.#text.addEventListener("change", () => this.#rescale());
    this.take(this.#slider, this.#text);
    this.row.append(this.#slider);
    this.#text.after(make("span", { className: "unit", textContent: key.unit }));
    this.show();
  }

  /** Changes the scene. */
  change(value) {
    this.store.set(this.path, value);
  }

  /** Around where the slider goes, if the value is 0. */
  usual() {
    const { example } = this.key;
    return Array.isArray(example) ? example.at(-1) : example;
  }

  draw(value) {
    if (document.activeElement !== this.#text) this.#text.value = textOf(value);
    const number = typeof value === "number" ? value : undefined;
    if (number === undefined) this.#slider.disabled = true;
    if (number !== undefined && !this.#scale?.holds(number)) this.#rescale();
    if (document.activeElement !== this.#slider && number !== undefined) {
      this.#slider.value = this.#scale.step(number);
    }
    this.#speak();
  }

  #rescale() {
    const value = this.value();
    if (typeof value !== "number") return;
    this.#scale = SliderScale.around(this.key, value, this.usual());
    this.#slider.max = this.#scale.steps;
    this.#slider.value = this.#scale.step(value);
  }

  #speak() {
    this.#slider.ariaValueText = `${this.#text.value} ${this.key.unit}`;
  }
}

/** The rate of the servo, which is its period said otherwise. */
class RateField extends NumberField {
  constructor(store) {
    const key = {
      path: "servo.rate", unit: "Hz", form: { number: "positive" }, default: null, without: null,
      example: 1000, requirement: "a finite number greater than 0 Hz",
      doc: "How often the torque is updated: one over the period, which is what a scene has.",
    };
    super(store, key, "servo.rate", false);
  }

  value() {
    const period = this.store.get("servo.period");
    // 12 digits: the period of 1 kHz is not a thousandth to the last bit.
    return typeof period === "number" && period > 0 ? Number((1 / period).toPrecision(12)) : undefined;
  }

  change(value) {
    this.store.set("servo.period", typeof value === "number" && value > 0 ? 1 / value : value);
  }
}

/** One of some words. */
class ChoiceField extends Field {
  #select;
  #now;

  /** `words`: pairs of a value and its name; `change` takes the choice, `now` returns it. */
  constructor(store, key, path, isOptional, words, change = (word) => store.set(path, word), now = undefined) {
    super(store, key, path, isOptional);
    this.#now = now;
    this.#select = make("select", {}, ...words.map(([value, text]) => new Option(text, value)));
    this.#select.addEventListener("change", () => change(this.#select.value));
    this.take(this.#select);
    this.show();
  }

  value() {
    return this.#now ? this.#now() : super.value();
  }

  draw(value) {
    // A table is not a word.
    if (value === undefined || typeof value === "object") {
      this.#select.selectedIndex = -1;
      return;
    }
    const text = String(value);
    const isThere = [...this.#select.options].some((option) => option.value === text);
    if (!isThere) this.#select.add(new Option(text, text));
    this.#select.value = text;
  }
}

/** Yes or no. */
class TruthField extends Field {
  #box;

  constructor(store, key, path, isOptional) {
    super(store, key, path, isOptional);
    this.#box = make("input", { type: "checkbox" });
    this.#box.addEventListener("change", () => store.set(path, this.#box.checked || undefined));
    this.take(this.#box);
    this.show();
  }

  draw(value) {
    this.#box.checked = value === true;
    this.#box.indeterminate = value !== undefined && typeof value !== "boolean";
  }
}

/** A text, or lists and tables as JSON has them. */
class TextField extends Field {
  #text;

  constructor(store, key, path, isOptional) {
    super(store, key, path, isOptional);
    const isPlain = key.form === "text";
    this.#text = isPlain
      ? make("input", { type: "text", className: "wide" })
      : make("textarea", { rows: 3, spellcheck: false });
    const read = (text) => (isPlain ? text : valueOf(text, true));
    this.#text.addEventListener("input", () => store.set(path, read(this.#text.value)));
    this.take(this.#text);
    this.show();
  }

  draw(value) {
    if (document.activeElement !== this.#text) this.#text.value = textOf(value);
  }
}

/** The field of a key by what its value is. */
function fieldOf(store, key, path = key.path, isOptional = !key.needed && key.default === null) {
  const isNumber = key.form === "time" || key.form.number || key.form.whole;
  if (isNumber) return new NumberField(store, key, path, isOptional);
  // A missing value is false.
  if (key.form === "boolean") return new TruthField(store, key, path, false);
  if (key.form.one_of) {
    return new ChoiceField(store, key, path, isOptional, key.form.one_of.map((word) => [word, word]));
  }
  return new TextField(store, key, path, isOptional);
}
