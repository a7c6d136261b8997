// The certificate, the servo and the wire's decoder as WebAssembly: how the page calls them.

/** An instance of the program: a worker has one of its own. */
class Engine {
  static #encoder = new TextEncoder();
  static #decoder = new TextDecoder();
  #functions;

  /** Starts a compiled module. */
  static async start(module) {
    const engine = new Engine();
    engine.#functions = (await WebAssembly.instantiate(module, {})).exports;
    return engine;
  }

  /** Asks a function. Throws its refusal, a sentence. */
  ask(name, question = "") {
    const functions = this.#functions;
    const bytes = Engine.#encoder.encode(question);
    const place = functions.input(bytes.length);
    new Uint8Array(functions.memory.buffer, place, bytes.length).set(bytes);
    const status = functions[name]();
    // A view of the memory is only good until the program asks for more of it.
    const answer = Engine.#decoder.decode(
      new Uint8Array(functions.memory.buffer, functions.text(), functions.text_bytes()));
    if (status !== 0) throw new Error(answer);
    return answer;
  }

  /** Asks a function that answers in JSON. */
  json(name, question) {
    return JSON.parse(this.ask(name, question));
  }

  /** A copy of the numbers of the last answer. */
  numbers() {
    const functions = this.#functions;
    return new Float64Array(
      functions.memory.buffer, functions.numbers(), functions.numbers_count()).slice();
  }
}
