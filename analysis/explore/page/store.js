// The scene that the page shows, and its verdict: changed here, and nowhere else.

/** The names in a key's path, with the numbers of tables in a list. */
function namesOf(path) {
  return path.split(/[.[\]]+/).filter((name) => name !== "");
}

/** Time in ms beyond which a judgement with remedies is too long for each frame. */
const LONGEST_JUDGEMENT = 1;
/** Judgements in a row that took longer, which a busy machine alone rarely makes, nor a browser that has not yet
 * compiled the program for speed. */
const SLOW_IN_A_ROW = 8;
/** Time in ms without a change after which remedies are searched for. */
const PAUSE_BEFORE_REMEDIES = 150;

class Store {
  #engine;
  #slow = 0;
  #pause;
  #listeners = [];
  #due = false;
  /** The scene, of the shape of a scene file. */
  scene;
  /** What the program says of it: {report, rows, remedies}, or {errors}. */
  judged;

  constructor(engine, scene) {
    this.#engine = engine;
    this.scene = scene;
  }

  /** Has a function called with this store after each change, once a frame at most. */
  listen(listener) {
    this.#listeners.push(listener);
  }

  /** The value of a key such as `servo.period` or `environment.shape[0].torque`; undefined where it is left
   * out. */
  get(path) {
    return namesOf(path).reduce((table, name) => table?.[name], this.scene);
  }

  /** Changes the value of a key, or leaves it out where the value is undefined. */
  set(path, value) {
    const names = namesOf(path);
    const last = names.pop();
    let table = this.scene;
    names.forEach((name, index) => {
      const isList = /^\d+$/.test(names[index + 1] ?? last);
      // A value that is not a table has no keys: a table replaces it.
      if (typeof table[name] !== "object" || table[name] === null || Array.isArray(table[name]) !== isList) {
        table[name] = isList ? [] : {};
      }
      table = table[name];
    });
    if (value !== undefined) table[last] = value;
    else if (Array.isArray(table)) table.splice(last, 1);
    else delete table[last];
    this.changed();
  }

  /** Shows another scene. */
  replace(scene) {
    this.scene = scene;
    this.changed();
  }

  /** The scene as the text that the program reads. */
  text() {
    return JSON.stringify(this.scene);
  }

  /** Has the scene judged, and all that shows it drawn, with the next frame. */
  changed() {
    if (this.#due) return;
    this.#due = true;
    requestAnimationFrame(() => this.judge());
  }

  /** Judges the scene now. Where the search for remedies took too long for a frame, it waits until nothing
   * has changed for a moment. */
  judge() {
    this.#due = false;
    clearTimeout(this.#pause);
    const begin = performance.now();
    const isQuick = this.#slow >= SLOW_IN_A_ROW;
    this.#judgeBy(isQuick ? "judge_without_remedies" : "judge");
    if (isQuick) this.#pause = setTimeout(() => this.#judgeInFull(), PAUSE_BEFORE_REMEDIES);
    else this.#slow = performance.now() - begin > LONGEST_JUDGEMENT ? this.#slow + 1 : 0;
    for (const listener of this.#listeners) listener(this);
  }

  #judgeInFull() {
    const begin = performance.now();
    this.#judgeBy("judge");
    if (performance.now() - begin <= LONGEST_JUDGEMENT) this.#slow = 0;
    for (const listener of this.#listeners) listener(this);
  }

  /** How long it takes is for the browser's tools and for programs: the last time only. */
  #judgeBy(name) {
    const start = performance.now();
    this.judged = this.#engine.json(name, this.text());
    performance.clearMeasures(name);
    performance.measure(name, { start });
  }
}
