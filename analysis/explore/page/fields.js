// The parameters of a scene as fields, made of the program's table of keys: a key that the program learns is
// on the page.

/** Keys that stand in "More" where the scene leaves them out. */
const RARE = new Set([
  "device.passivity", "device.friction", "device.sensor_lag", "device.actuator_response",
  "device.actuator_updates", "servo.worst_period", "servo.output_jitter", "servo.count_jitter",
  "environment.filter", "environment.wall.filter", "encoder.counts_per_turn", "encoder.age",
  "encoder.window", "encoder.lag", "encoder.prediction", "encoder.linearity", "encoder.noise",
  "encoder.hysteresis", "encoder.dropped",
]);

/** Most tables of a list that have fields: more shapes than that are refused. */
const MOST_TABLES = 16;

/** The place for the fault of a list as a whole. */
class GroupError {
  row = make("p", { className: "error" });

  constructor(path) {
    this.path = path;
    this.row.id = `${Field.idOf(path)}-error`;
  }

  show() {}

  complain(sentence = "") {
    say(this.row, sentence);
  }
}

/** All fields of the scene. */
class Fields {
  #store;
  #keys;
  #kinds;
  #shapes;
  #form = document.getElementById("fields");
  #problems = document.getElementById("problems");
  #fields = new Map();
  #shape = "";
  /** What choices have taken out of the scene, to be there again with the next choice. */
  #kept = new Map();

  constructor(store, { keys, kinds, shapes }) {
    this.#store = store;
    this.#keys = new Map(keys.map((key) => [key.path, key]));
    this.#kinds = kinds;
    this.#shapes = shapes;
    store.listen(() => this.show());
    // Enter in a field is not an answer to anything.
    this.#form.addEventListener("submit", (event) => event.preventDefault());
    this.#hint();
  }

  /** Shows the scene and its faults. */
  show() {
    const shape = this.#shapeOfForm();
    if (shape !== this.#shape) this.#build(shape);
    else for (const field of this.#fields.values()) field.show();
    this.#complain(this.#store.judged?.errors ?? []);
  }

  /** What decides which fields there are. */
  #shapeOfForm() {
    const { scene } = this.#store;
    const shapes = this.#list("environment.shape").map((shape) => shape?.type);
    const isThere = (path) => this.#store.get(path) !== undefined;
    const tables = ["device.mass", "device.cogging", "environment.wall", "anticogging", "human"].map(isThere);
    return JSON.stringify([scene.environment?.type, this.#coupling(), shapes, tables]);
  }

  /** The tables of a list, as many as have fields. */
  #list(path) {
    const list = this.#store.get(path);
    return Array.isArray(list) ? list.slice(0, MOST_TABLES) : [];
  }

  #build(shape) {
    this.#shape = shape;
    const focused = document.activeElement?.id;
    const open = new Set([...this.#form.querySelectorAll("details[open]")].map((more) => more.id));
    this.#fields.clear();
    this.#form.replaceChildren(
      this.#add(this.#keys.get("name")), this.#device(), this.#servo(), this.#couplingGroup(),
      this.#environment(), ...this.#anticogging(), this.#limits(), this.#human());
    for (const more of this.#form.querySelectorAll("details")) more.open = open.has(more.id);
    if (focused) document.getElementById(focused)?.focus();
  }

  /** Makes the field of a key. */
  #add(key, path = key.path, isOptional = undefined) {
    return this.#enter(fieldOf(this.#store, key, path, isOptional));
  }

  #enter(field) {
    this.#fields.set(field.path, field);
    return field.row;
  }

  /** A choice between words, for a key that decides which other keys there are. */
  #choice(path, words, change, now = undefined) {
    const field = new ChoiceField(this.#store, this.#keys.get(path), path, false, words, change, now);
    this.#fields.set(path, field);
    return field;
  }

  /** A group of fields under a heading. */
  #group(title, ...rows) {
    return make("fieldset", {}, make("legend", {}, make("h3", { textContent: title })), ...rows);
  }

  /** The fields of keys; those that are rare, and not in the scene, behind a word. */
  #rows(title, paths, isOptional = () => undefined, areRare = (path) => RARE.has(path)) {
    const isRare = (path) => areRare(path) && this.#store.get(path) === undefined;
    const row = (path) => this.#add(this.#keys.get(path), path, isOptional(path));
    const rare = paths.filter(isRare).map(row);
    const rows = paths.filter((path) => !isRare(path)).map(row);
    if (rare.length > 0) {
      const more = make("details", { className: "more", id: `more-${title.toLowerCase()}` });
      more.append(make("summary", { textContent: `More of ${title.toLowerCase()}` }), ...rare);
      rows.push(more);
    }
    return rows;
  }

  /** Puts some keys of a table in the place of others, and keeps those for another time. */
  #exchange(table, word, before, paths, usual) {
    const values = (all) => Object.fromEntries(
      all.map((path) => [path, this.#store.get(path)]).filter(([, value]) => value !== undefined));
    this.#kept.set(`${table} ${before}`, values(paths));
    const next = { ...usual, ...this.#kept.get(`${table} ${word}`) };
    for (const path of paths) this.#store.set(path, undefined);
    for (const [path, value] of Object.entries(next)) this.#store.set(path, structuredClone(value));
  }

  #device() {
    const isChain = this.#store.get("device.mass") !== undefined;
    const rigid = ["device.inertia", "device.damping"];
    const chain = ["device.mass", "device.link", "device.encoder"];
    const examples = (paths) => Object.fromEntries(paths.map((path) => [path, this.#keys.get(path).example]));
    const words = [["rigid", "one rigid body"], ["chain", "a chain of masses"]];
    const body = this.#choice("device", words, (word) => {
      const usual = examples(word === "chain" ? chain : rigid);
      this.#exchange("device", word, isChain ? "chain" : "rigid", [...rigid, ...chain], usual);
    }, () => (isChain ? "chain" : "rigid"));
    const others = [...this.#keys.values()].filter(({ path, form }) =>
      /^device\.\w+$/.test(path) && !form.startsWith?.("table") && ![...rigid, ...chain].includes(path));
    const cogs = this.#store.get("device.cogging");
    const cogging = cogs === undefined || Array.isArray(cogs) ? [] : this.#keysOf("device.cogging");
    const paths = [...(isChain ? chain : rigid), ...others.map(({ path }) => path), ...cogging];
    return this.#group("Device", body.row, ...this.#rows("Device", paths));
  }

  #servo() {
    const rate = this.#enter(new RateField(this.#store));
    return this.#group("Servo", rate, ...this.#rows("Servo", this.#keysOf("servo")));
  }

  /** The paths of a table's own keys which are no tables. */
  #keysOf(table) {
    const isOwn = ({ path }) => path === `${table}.${path.split(".").pop()}`;
    const keys = [...this.#keys.values()].filter((key) => isOwn(key) && key.form !== "table");
    return keys.map((key) => key.path);
  }

  /** Which coupling the scene has. */
  #coupling() {
    const coupling = this.#store.get("coupling");
    return coupling === undefined ? "rigid" : coupling?.type ?? "spring";
  }

  #couplingGroup() {
    const words = [["rigid", "rigid"], ["spring", "spring"], ["matched", "matched"]];
    const now = this.#coupling();
    const type = this.#choice("coupling.type", words, (word) => {
      this.#kept.set(`coupling ${now}`, this.#store.get("coupling"));
      const next = this.#kept.get(`coupling ${word}`) ?? this.#usualCoupling(word);
      this.#store.set("coupling", structuredClone(next));
    }, () => this.#coupling());
    const stiffness = this.#keys.get("coupling.stiffness");
    const rows = now === "spring" ? [this.#add(stiffness, stiffness.path, false)] : [];
    return this.#group("Coupling", type.row, ...rows);
  }

  /** A coupling to start with: the standard spring has twice the passivity over the period. */
  #usualCoupling(word) {
    if (word === "rigid") return undefined;
    if (word === "matched") return { type: "matched" };
    const passivity = this.#store.get("device.passivity") ?? this.#store.get("device.damping");
    const stiffness = Number(((2 * passivity) / this.#store.get("servo.period")).toPrecision(3));
    const isOne = stiffness > 0 && stiffness < Infinity;
    return { stiffness: isOne ? stiffness : this.#keys.get("coupling.stiffness").example };
  }

  #environment() {
    const now = this.#store.get("environment.type");
    const words = this.#kinds.map(({ name }) => [name, name.replaceAll("-", " ")]);
    const type = this.#choice("environment.type", words, (word) => this.#changeKind(now, word));
    const kind = this.#kinds.find(({ name }) => name === now);
    if (!kind) return this.#group("Environment", type.row);
    const isTable = (path) => path === "environment.wall" || path === "environment.shape";
    const isNeeded = (path) => kind.needed.includes(path);
    const hasShapes = kind.keys.includes("environment.shape");
    const rows = this.#rows(
      "Environment",
      kind.keys.filter((path) => !isTable(path)),
      (path) => (isNeeded(path) ? false : this.#keys.get(path).needed || undefined),
      // What a profile is beside its shapes.
      (path) => RARE.has(path) || (hasShapes && !isNeeded(path)));
    if (hasShapes) rows.splice(1, 0, this.#shapesGroup());
    if (kind.keys.includes("environment.wall")) {
      rows.push(this.#table("environment.wall", "Wall beside the profile"));
    }
    return this.#group("Environment", type.row, ...rows);
  }

  /** Another type of environment: with the numbers that it must have, from the scene if that has them. */
  #changeKind(before, word) {
    const kind = this.#kinds.find(({ name }) => name === word);
    const { environment } = this.#store.scene;
    this.#kept.set(`environment ${before}`, environment);
    const next = { ...kind?.values, ...this.#kept.get(`environment ${word}`) };
    for (const path of kind?.needed ?? []) {
      const name = path.split(".").pop();
      if (environment?.[name] !== undefined) next[name] = environment[name];
    }
    this.#store.set("environment", structuredClone({ ...next, type: word }));
  }

  /** A table that may be there or not, with its fields. */
  #table(path, title) {
    const isThere = this.#store.get(path) !== undefined;
    const id = `${Field.idOf(path)}-set`;
    const box = make("input", { type: "checkbox", id, checked: isThere });
    box.addEventListener("change", () => {
      if (!box.checked) this.#kept.set(path, this.#store.get(path));
      const value = this.#kept.get(path) ?? this.#example(path);
      this.#store.set(path, box.checked ? structuredClone(value) : undefined);
    });
    const label = make("label", { htmlFor: id }, box, ` ${this.#keys.get(path).doc.replace(/[.,].*/s, "")}`);
    return this.#group(title, label, ...(isThere ? this.#rows(title, this.#keysOf(path)) : []));
  }

  /** A table with the examples of its keys that are numbers and not rare. */
  #example(table) {
    const paths = this.#keysOf(table).filter((path) => !RARE.has(path));
    return Object.fromEntries(paths.map((path) => [path.split(".").pop(), this.#keys.get(path).example]));
  }

  #shapesGroup() {
    const shapes = this.#list("environment.shape");
    const words = this.#shapes.map(({ name }) => [name, name.replaceAll("_", " ")]);
    const another = make("select", { id: "shape-type", ariaLabel: "type of the shape to add" },
      ...words.map(([value, text]) => new Option(text, value)));
    const add = make("button", { type: "button", id: "add-shape", textContent: "Add shape" });
    add.addEventListener("click", () => {
      const all = this.#store.get("environment.shape");
      const before = Array.isArray(all) ? all : [];
      this.#store.set("environment.shape", [...before, this.#usualShape(another.value)]);
    });
    return this.#group("Shapes of the profile", this.#enter(new GroupError("environment.shape")),
      ...shapes.map((_, index) => this.#shapeGroup(index, words)),
      make("p", { className: "buttons" }, another, add));
  }

  #usualShape(word) {
    const shape = this.#shapes.find(({ name }) => name === word);
    return structuredClone({ type: word, ...shape?.values });
  }

  #shapeGroup(index, words) {
    const path = `environment.shape[${index}]`;
    const key = this.#keys.get("environment.shape.type");
    const now = this.#store.get(`${path}.type`);
    const type = new ChoiceField(this.#store, key, `${path}.type`, false, words, (word) => {
      this.#store.set(path, this.#usualShape(word));
    });
    const remove = make("button", { type: "button", textContent: "Remove" });
    remove.ariaLabel = `remove shape ${index + 1}`;
    remove.addEventListener("click", () => {
      const rest = this.#store.get("environment.shape").filter((_, other) => other !== index);
      this.#store.set("environment.shape", rest.length > 0 ? rest : undefined);
      document.getElementById("add-shape")?.focus();
    });
    const shape = this.#shapes.find(({ name }) => name === now);
    const rows = (shape?.keys ?? []).map((own) => {
      const key = this.#keys.get(own);
      return this.#add(key, `${path}.${own.split(".").pop()}`, !key.needed && key.default === null);
    });
    return this.#group(`Shape ${index + 1}`, this.#enter(type), ...rows, remove);
  }

  /** The share of a map in the scene; a map has no fields. */
  #anticogging() {
    if (this.#store.get("anticogging") === undefined) return [];
    return [this.#group("Anticogging", this.#add(this.#keys.get("anticogging.share")))];
  }

  #limits() {
    return this.#group("Limits", ...this.#rows("Limits", this.#keysOf("limits")));
  }

  #human() {
    return this.#table("human", "Hand");
  }

  /** Shows each fault beside its field, and faults of no field above all fields. */
  #complain(errors) {
    const sentences = new Map();
    const others = [];
    for (const { key, sentence } of errors) {
      const field = this.#nearest(key);
      if (field) sentences.set(field, [...(sentences.get(field) ?? []), sentence]);
      else others.push(sentence);
    }
    for (const field of this.#fields.values()) {
      field.complain(sentences.get(field)?.join(" "));
      // A fault is not hidden in a tooltip.
      if (sentences.has(field)) field.row.closest("details")?.setAttribute("open", "");
    }
    const shown = [...this.#problems.children].map((item) => item.textContent);
    if (JSON.stringify(shown) === JSON.stringify(others)) return;
    this.#problems.replaceChildren(...others.map((sentence) => make("li", { textContent: sentence })));
  }

  /** The field of a key, or of the list or table that it is in. */
  #nearest(key) {
    for (let path = key ?? ""; path !== ""; path = path.replace(/(\.?[^.[\]]+|\[\d+\])$/, "")) {
      const field = this.#fields.get(path);
      if (field && path !== "device") return field;
    }
    return undefined;
  }

  /** Below the fields stand the words of the field with the focus or under the pointer. */
  #hint() {
    const hint = document.getElementById("hint");
    const say = ({ target }) => {
      const words = target.closest?.(".field")?.dataset.words;
      if (words) hint.textContent = words;
      hint.classList.toggle("shown", words !== undefined);
    };
    this.#form.addEventListener("focusin", say);
    this.#form.addEventListener("pointerover", say);
    this.#form.addEventListener("focusout", () => hint.classList.remove("shown"));
    hint.textContent = "What a field means stands here while it is pointed at or has the focus.";
  }
}
