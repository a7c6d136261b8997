// The worker of the pictures: what takes longer than a frame is computed here, the newest question first.

/** Sides of the blocks of cells that a map is drawn in, from coarse to fine: the first picture has to be there
 * in a tenth of a second where a verdict takes long, and before the browser has compiled it for speed. */
const MAP_BLOCKS = [16, 8, 4, 2, 1];
/** Longest time in ms without a look for a newer question, and without a picture. */
const WORKER_PAUSE = { look: 12, picture: 90 };

/** A map that is computed until a newer question is there: coarse, then finer along the borders, and then all
 * cells that lie between others of the same kind, in case there is something smaller than a coarse block. */
class MapJob {
  #engine;
  #isOld;
  #question;
  #regions;
  #known;
  #begun = performance.now();
  #looked = this.#begun;
  #sent = this.#begun;

  constructor(engine, isOld, question) {
    [this.#engine, this.#isOld, this.#question] = [engine, isOld, question];
    const [columns, rows] = question.cells;
    [this.#regions, this.#known] = [new Uint8Array(columns * rows), new Uint8Array(columns * rows)];
  }

  /** Answers with the axes, and with regions several times. */
  async run() {
    const { id, scene, axes, ranges, cells } = this.#question;
    let map;
    try {
      map = this.#engine.json("map_begin", JSON.stringify({ scene, axes, ranges, cells }));
    } catch (refusal) {
      postMessage({ id, kind: "map", refusal: refusal.message });
      return;
    }
    for (const block of MAP_BLOCKS) {
      if (!await this.#pass(block, (column, row) => this.#isNearBorder(column, row, block))) return;
      // The axes are said once.
      const begun = block === MAP_BLOCKS[0] ? { map } : {};
      this.#send({ done: `1/${block * block}`, ...begun });
    }
    if (await this.#pass(1, () => true)) this.#send({ done: "all" });
  }

  /** Computes the blocks of a size that are wanted and not known; whether there is still nothing newer. */
  async #pass(block, isWanted) {
    const [columns, rows] = this.#question.cells;
    for (let row = 0; row < rows; row += block) {
      const wanted = [];
      for (let column = 0; column < columns; column += block) {
        if (!this.#known[row * columns + column] && isWanted(column, row)) wanted.push(column);
      }
      if (wanted.length > 0) this.#row(row, wanted, block);
      const now = performance.now();
      if (now - this.#sent > WORKER_PAUSE.picture && block < MAP_BLOCKS[0]) this.#send({});
      if (now - this.#looked < WORKER_PAUSE.look) continue;
      await breath();
      this.#looked = performance.now();
      if (this.#isOld(this.#question.id)) return false;
    }
    return true;
  }

  /** Whether the block that a finer one is a part of has another one of a different kind beside it. */
  #isNearBorder(column, row, block) {
    if (block === MAP_BLOCKS[0]) return true;
    const [columns, rows] = this.#question.cells;
    const side = 2 * block;
    const [left, low] = [column - (column % side), row - (row % side)];
    const own = this.#regions[low * columns + left];
    for (let y = low - side; y <= low + side; y += side) {
      for (let x = left - side; x <= left + side; x += side) {
        const isInside = x >= 0 && y >= 0 && x < columns && y < rows;
        if (isInside && this.#regions[y * columns + x] !== own) return true;
      }
    }
    return false;
  }

  /** Computes blocks of a row by their first columns, and fills them. */
  #row(row, wanted, block) {
    const [columns, rows] = this.#question.cells;
    this.#engine.ask("map_row", `${row} ${wanted.join(" ")}`);
    const found = this.#engine.numbers();
    wanted.forEach((left, index) => {
      this.#known[row * columns + left] = 1;
      const right = Math.min(columns, left + block);
      for (let at = row; at < Math.min(rows, row + block); at += 1) {
        this.#regions.fill(found[index], at * columns + left, at * columns + right);
      }
    });
  }

  #send(more) {
    const { id, cells } = this.#question;
    const regions = this.#regions.slice();
    this.#sent = performance.now();
    const time = this.#sent - this.#begun;
    postMessage({ id, kind: "map", cells, regions, time, ...more }, [regions.buffer]);
  }
}

/** Lets what has been sent to the worker in. */
function breath() {
  return new Promise((resolve) => {
    const { port1, port2 } = new MessageChannel();
    port1.onmessage = () => {
      port1.close();
      resolve();
    };
    port2.postMessage(0);
  });
}

/** Computes a run of the scene. */
function answerMotion(engine, { id, scene }) {
  try {
    const motion = engine.json("motion", scene);
    const numbers = engine.numbers();
    postMessage({ id, kind: "motion", motion, numbers }, [numbers.buffer]);
  } catch (refusal) {
    postMessage({ id, kind: "motion", refusal: refusal.message });
  }
}

/** Answers questions: of maps the newest one, and that of a run also while a map is computed. */
function startWorker() {
  let engine;
  let [newest, waiting, isBusy] = [null, null, false];
  const work = async () => {
    if (isBusy) return;
    isBusy = true;
    while (waiting) {
      const question = waiting;
      waiting = null;
      await new MapJob(engine, (id) => newest !== id, question).run();
    }
    isBusy = false;
  };
  const answer = (question) => {
    if (question.kind === "motion") {
      answerMotion(engine, question);
      return;
    }
    [newest, waiting] = [question.id, question];
    work();
  };
  // Requests before the start of the program are answered after it.
  const early = [];
  self.onmessage = async ({ data }) => {
    if (data.module) {
      engine = await Engine.start(data.module);
      early.splice(0).forEach(answer);
    } else if (engine) {
      answer(data);
    } else {
      early.push(data);
    }
  };
}

startWorker();
