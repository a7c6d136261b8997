// A board behind `haptic serve`: its bytes by HTTP, down in one response, up in a request for each few.

/** Most bytes in a request. */
const SERVED_BYTES = 4096;

/** The wire at an address that `haptic serve` has printed. */
class ServedLine {
  #address;
  /** Ends the response. */
  #ending;
  /** The address for bytes, once the server has named it. */
  #up;
  #waiting = [];
  #isSending = false;
  /** What the line is called in sentences. */
  name;

  /** Takes the address as it was printed; throws a sentence if it is invalid. */
  constructor(text) {
    let address;
    try {
      address = new URL(text.trim());
    } catch {
      throw new Error(`\`${text}\` is not an address: expected http://127.0.0.1:PORT/?token=..., ` +
        "as `haptic serve` prints it");
    }
    const token = address.searchParams.get("token");
    if (address.protocol !== "http:" || !token) {
      throw new Error(`\`${text}\` has no token: copy the whole address that \`haptic serve\` prints`);
    }
    this.name = `haptic serve at ${address.host}`;
    this.#address = `http://${address.host}/wire?token=${encodeURIComponent(token)}`;
  }

  /** The address of the server that this page is from, where it is from one. */
  static own() {
    const { protocol, href } = window.location;
    const isServed = protocol === "http:" && new URL(href).searchParams.has("token");
    return isServed ? href.split("#")[0] : undefined;
  }

  /** Opens the wire. Calls `on.open` once the board's port is open, `on.bytes` with what comes, `on.waits`
   * with a sentence while the port is lost, and `on.lost` once nothing comes any more. */
  async open(on) {
    const ending = new AbortController();
    this.#ending = ending;
    const response = await fetch(this.#address, { method: "POST", signal: ending.signal }).catch(() => undefined);
    if (response?.ok) return void this.#read(response, ending, on);
    if (response?.status !== 409) {
      throw new Error(`${this.name} does not answer, or does not know this token: is it still running, ` +
        "and is this the address that it has printed last?");
    }
    // A second page's: trying again would be no use.
    on.lost(`the link to ${this.name} is lost: ${(await response.text()).trim()}`, true);
  }

  /** Reads the lines of the response until its end. */
  async #read(response, ending, on) {
    let why = "the connection was closed";
    const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
    for (let text = ""; ;) {
      // A connection that is cut ends, too.
      const { done, value } = await reader.read().catch(() => ({ done: true }));
      if (done) break;
      const lines = (text + value).split("\n");
      text = lines.pop();
      for (const line of lines) why = this.#take(JSON.parse(line), ending, on) ?? why;
    }
    if (this.#ending === ending) on.lost(`the link to ${this.name} is lost: ${why}`);
  }

  /** Takes a line; the reason, where it is the last one. */
  #take({ page, bytes, port, why, end }, ending, on) {
    if (this.#ending !== ending) return undefined;
    if (page) this.#up = `${this.#address}&page=${page}`;
    else if (bytes) on.bytes(Uint8Array.from(bytes.match(/../g), (digits) => parseInt(digits, 16)));
    else if (port === "open") on.open();
    else if (port === "lost") on.waits(why);
    return end;
  }

  /** Sends bytes, each after those before. */
  async send(bytes) {
    this.#waiting.push(...bytes);
    if (this.#isSending) return;
    this.#isSending = true;
    while (this.#up && this.#waiting.length > 0) {
      const body = Uint8Array.from(this.#waiting.splice(0, SERVED_BYTES));
      // If it fails, the response ends, too, and says why.
      await fetch(this.#up, { method: "POST", body }).catch(() => {});
    }
    this.#isSending = false;
  }

  /** Closes the wire. */
  async close() {
    const ending = this.#ending;
    this.#ending = this.#up = undefined;
    this.#waiting = [];
    ending?.abort();
  }
}
