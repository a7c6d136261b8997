// The pictures of the scene: drawn as it changes, those that take longer by a worker.

/** What the simulated motion is a run of, in ms after the last change: of a rejected scene the hand is looked
 * for in which it oscillates most, and that takes longer than a frame. */
const SHAKING_PAUSE = 350;

/** Shows all pictures. `source` is the worker's. */
function showPictures(engine, store, module, source) {
  const section = document.getElementById("pictures");
  const grid = document.createElement("div");
  grid.className = "pictures";
  section.append(grid);
  Picture.scene = () => store.scene.name ?? "scene";
  const worker = new PictureWorker(module, source);
  const map = new MapPicture(store, grid, (question) => worker.ask(question));
  const nyquist = new NyquistPicture(engine, grid);
  const profile = new ProfilePicture(engine, grid);
  const motion = new MotionPicture(grid, (question) => worker.ask(question));
  worker.listen("map", (answer) => map.take(answer));
  worker.listen("motion", (answer) => motion.take(answer));
  store.listen(({ judged }) => {
    // What cannot be read has no pictures: those of before are shown as such.
    grid.classList.toggle("stale", judged.errors !== undefined);
    if (judged.errors) return;
    const text = store.text();
    map.show();
    nyquist.show(text);
    profile.show(text);
    motion.show(text, judged.report.verdict);
  });
}

/** Why there is no picture, in a sentence. */
function refusalOf(what, refusal) {
  return `No ${what}: ${refusal.replace(/\.$/, "")}.`;
}

/** The worker, made of the sources in the page. */
class PictureWorker {
  #worker;
  #listeners = new Map();
  #asked = 0;

  constructor(module, source) {
    const address = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
    this.#worker = new Worker(address);
    this.#worker.onmessage = ({ data }) => this.#listeners.get(data.kind)?.(data);
    this.#worker.postMessage({ module });
  }

  /** Sends a question; its number, which the answers have too. A newer one of its kind takes its place. */
  ask(question) {
    this.#asked += 1;
    this.#worker.postMessage({ ...question, id: this.#asked });
    return this.#asked;
  }

  /** Has a function called with the answers to a kind of question. */
  listen(kind, listener) {
    this.#listeners.set(kind, listener);
  }
}

/** Torque and angle of a simulated run. */
class MotionPicture {
  #ask;
  #strip;
  #asked = 0;
  #isAwaited = false;
  #next = null;
  #shaking;

  constructor(parent, ask) {
    this.#ask = ask;
    this.#strip = new Strip(parent, {
      name: "motion",
      title: "Simulated motion",
      height: 320,
      lines: [
        { name: "torque", unit: "N m", ink: "--plot-1", least: 1e-9 },
        { name: "angle", unit: "rad", ink: "--plot-3", least: 1e-9 },
      ],
    });
  }

  /** Shows a run of a scene, given as text, of which the verdict is known. */
  show(text, verdict) {
    clearTimeout(this.#shaking);
    this.#strip.picture.update(() => this.#question(`typical\n${text}`));
    if (verdict === "certified") return;
    this.#shaking = setTimeout(() => this.#strip.picture.update(() => this.#question(text)), SHAKING_PAUSE);
  }

  #question(scene) {
    if (this.#isAwaited) {
      this.#next = scene;
      return;
    }
    [this.#isAwaited, this.#next] = [true, null];
    this.#asked = this.#ask({ kind: "motion", scene });
  }

  /** Takes an answer of the worker. */
  take({ id, refusal, motion, numbers }) {
    if (id !== this.#asked) return;
    this.#isAwaited = false;
    if (refusal !== undefined) {
      const sentence = refusalOf("motion", refusal);
      this.#strip.picture.draw({ sentence, words: () => sentence });
    } else {
      this.#draw(motion, numbers);
    }
    if (this.#next !== null) this.#question(this.#next);
  }

  #draw(motion, numbers) {
    const [times, angles, torques] = [0, 1, 2].map((index) =>
      numbers.subarray(index * motion.samples, (index + 1) * motion.samples));
    const limit = motion.torque_limit;
    this.#strip.levels = [
      ...(limit === null ? [] : [limit, -limit].map((value) => ({ line: 0, value, words: "torque limit" }))),
      ...(motion.face === null ? [] : [{ line: 1, value: motion.face, words: "face of the wall" }]),
    ];
    const sentences = [
      motion.what,
      ...(motion.lost === null ? [] : [`from ${plotNumber(motion.lost)} s on it is farther than is shown`]),
    ];
    const legend = [
      { ink: "--plot-1", words: `torque; ${sentences.join("; ")}` },
      { ink: "--plot-3", words: "angle" },
    ];
    this.#strip.show(times, [torques, angles], { legend });
  }
}
