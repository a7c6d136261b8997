// A board behind `haptic serve`: its bytes through a WebSocket.

/** The socket of an address that `haptic serve` has printed. */
class SocketLine {
  #address;
  #socket;
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
    if (!["http:", "ws:"].includes(address.protocol) || !token) {
      throw new Error(`\`${text}\` has no token: copy the whole address that \`haptic serve\` prints`);
    }
    this.name = `haptic serve at ${address.host}`;
    this.#address = `ws://${address.host}/wire?token=${encodeURIComponent(token)}`;
  }

  /** The address of the server that this page is from, where it is from one. */
  static own() {
    const { protocol, href } = window.location;
    const isServed = protocol === "http:" && new URL(href).searchParams.has("token");
    return isServed ? href.split("#")[0] : undefined;
  }

  /** Opens the socket. Calls `on.open` once the board's port is open, `on.bytes` with what comes, `on.waits`
   * with a sentence while the port is lost, and `on.lost` once nothing comes any more. */
  open(on) {
    return new Promise((resolve, reject) => {
      const socket = new WebSocket(this.#address);
      let isOpen = false;
      this.#socket = socket;
      socket.binaryType = "arraybuffer";
      socket.onopen = () => {
        isOpen = true;
        resolve();
      };
      socket.onmessage = ({ data }) => {
        if (this.#socket !== socket) return;
        if (typeof data !== "string") return on.bytes(new Uint8Array(data));
        const { port, why } = JSON.parse(data);
        if (port === "open") on.open();
        else on.waits(why);
      };
      socket.onclose = ({ code, reason }) => {
        if (!isOpen) {
          reject(new Error(`${this.name} does not answer, or does not know this token: is it still running, ` +
            "and is this the address that it has printed last?"));
        } else if (this.#socket === socket) {
          const why = reason || "the connection was closed";
          // Of these codes the first is a second page's: trying again would be no use.
          on.lost(`the link to ${this.name} is lost: ${why}`, code === 4000);
        }
      };
    });
  }

  /** Sends bytes. */
  send(bytes) {
    if (this.#socket?.readyState === WebSocket.OPEN) this.#socket.send(bytes);
  }

  /** Closes the socket. */
  async close() {
    const socket = this.#socket;
    this.#socket = undefined;
    socket?.close();
  }
}
