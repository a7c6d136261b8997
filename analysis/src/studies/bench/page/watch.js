// Runs in a page before its own scripts, and watches it: what `haptic bench` reads is in `window.bench`.

window.bench = {
  /** When the first verdict was on the screen, in ms after the page was opened. */
  shown: undefined,

  /** Begins to watch frames and verdicts: their times in ms. */
  watch() {
    const seen = { frames: [], judge: [], judge_without_remedies: [] };
    const observer = new PerformanceObserver((list) => {
      for (const { name, duration } of list.getEntries()) seen[name]?.push(duration);
    });
    observer.observe({ type: "measure" });
    let [isOver, last] = [false, undefined];
    const frame = (time) => {
      if (last !== undefined) seen.frames.push(time - last);
      last = time;
      if (!isOver) requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
    this.watched = () => {
      isOver = true;
      observer.disconnect();
      return seen;
    };
  },

  /** Starts an instance of the page's program to be asked in turns with this machine's. */
  async start(questions) {
    const module = await WebAssembly.compile(await unpacked(document.getElementById("module")));
    this.program = (await WebAssembly.instantiate(module, {})).exports;
    this.questions = questions;
  },

  /** Answers of the page's program, as the page's engine asks for them. */
  answers() {
    const program = this.program;
    const [encoder, decoder] = [new TextEncoder(), new TextDecoder()];
    return this.questions.map((question) => {
      const bytes = encoder.encode(question);
      // Asking for a place may move all of the memory.
      const place = program.input(bytes.length);
      new Uint8Array(program.memory.buffer, place, bytes.length).set(bytes);
      program.certify();
      return decoder.decode(new Uint8Array(program.memory.buffer, program.text(), program.text_bytes()));
    });
  },

  /** Time in ms of so many rounds of all answers. */
  round(rounds) {
    const begin = performance.now();
    for (let round = 0; round < rounds; round += 1) this.answers();
    return performance.now() - begin;
  },
};

// The document itself is there before anything in it.
new MutationObserver((_, observer) => {
  if (document.documentElement?.dataset.verdict === undefined) return;
  observer.disconnect();
  // After the frame that shows it.
  requestAnimationFrame(() => setTimeout(() => {
    window.bench.shown = performance.now();
  }));
}).observe(document, { attributes: true, attributeFilter: ["data-verdict"], subtree: true });
