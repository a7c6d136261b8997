// A board at a serial port of this machine, where the browser has Web Serial.

/** Longest wait for bytes that are still written when a port closes, in ms. */
const SERIAL_PATIENCE = 500;

/** A serial port that the user has chosen. */
class SerialLine {
  #port;
  #reader;
  #isOpen = false;
  #reading = Promise.resolve();
  #writes = Promise.resolve();
  /** What the line is called in sentences. */
  name = "the serial port";

  constructor(port) {
    this.#port = port;
  }

  /** Whether this browser has serial ports. */
  static isThere() {
    return navigator.serial !== undefined;
  }

  /** Has the user choose a port. */
  static async choose() {
    return new SerialLine(await navigator.serial.requestPort());
  }

  /** Opens the port. Calls `on.bytes` with what comes, and `on.lost` with a sentence once nothing comes any
   * more. */
  async open(on, { baud }) {
    await this.#find();
    await this.#port.open({ baudRate: baud, bufferSize: 1 << 16 });
    this.#isOpen = true;
    this.#reading = this.#read(on);
    on.open();
  }

  /** A board that was plugged in again may have another port, of the same make. */
  async #find() {
    const ports = await navigator.serial.getPorts();
    const make = (port) => JSON.stringify(port.getInfo());
    if (ports.includes(this.#port)) return;
    this.#port = ports.find((port) => make(port) === make(this.#port)) ?? this.#port;
  }

  async #read(on) {
    let why = "the port is closed";
    try {
      while (this.#isOpen && this.#port.readable) {
        this.#reader = this.#port.readable.getReader();
        try {
          for (;;) {
            const { value, done } = await this.#reader.read();
            if (done) break;
            on.bytes(value);
          }
        } catch (error) {
          // A parity error or an overrun ends a reader; what follows of it is bytes that were lost.
          why = error.message;
        } finally {
          this.#reader.releaseLock();
        }
      }
    } finally {
      const wasOpen = this.#isOpen;
      this.#isOpen = false;
      // A write that never ends must not keep the page waiting.
      await Promise.race([this.#writes, new Promise((done) => setTimeout(done, SERIAL_PATIENCE))]);
      await this.#port.close().catch(() => {});
      if (wasOpen) on.lost(`the link to ${this.name} is lost: ${why}`);
    }
  }

  /** Sends bytes, each after those before. */
  send(bytes) {
    this.#writes = this.#writes.then(async () => {
      const writer = this.#port.writable?.getWriter();
      if (writer === undefined) return;
      try {
        await writer.write(bytes);
      } finally {
        writer.releaseLock();
      }
    }).catch(() => {});
  }

  /** Closes the port. */
  async close() {
    this.#isOpen = false;
    await this.#reader?.cancel().catch(() => {});
    await this.#reading;
  }
}
