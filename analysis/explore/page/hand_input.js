// How a person moves the hand: by mouse, finger or pen, by keys, or by the stick of a game controller.

/** Dead zone of a stick as a part of its way, and the step of a key as a part of the shown range. */
const INPUT = { deadZone: 0.1, key: 1 / 60, page: 1 / 6 };

/** Moves a hand, which has these functions: grab(), turn(by), put(angle), release(), toggle(), both in rad;
 * and `span`, the angle in rad from the middle of the drawing to its edge. */
class HandInput {
  #canvas;
  #drawing;
  #hand;
  #pointer;
  #last;
  #isPushed = false;

  constructor(canvas, drawing, hand, say) {
    [this.#canvas, this.#drawing, this.#hand] = [canvas, drawing, hand];
    canvas.addEventListener("pointerdown", (event) => this.#down(event));
    canvas.addEventListener("pointermove", (event) => this.#moved(event));
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
      canvas.addEventListener(end, (event) => this.#up(event));
    }
    canvas.addEventListener("keydown", (event) => this.#key(event));
    addEventListener("gamepadconnected", ({ gamepad }) => {
      say(`Game controller connected: ${gamepad.id}. Its first stick moves the hand.`);
    });
    addEventListener("gamepaddisconnected", ({ gamepad }) => say(`Game controller gone: ${gamepad.id}.`));
  }

  #down(event) {
    if (this.#pointer !== undefined || event.button !== 0) return;
    this.#pointer = event.pointerId;
    this.#canvas.setPointerCapture(event.pointerId);
    this.#last = this.#drawing.angleAt(event.offsetX, event.offsetY);
    this.#hand.grab();
  }

  #moved(event) {
    if (event.pointerId !== this.#pointer) return;
    const angle = this.#drawing.angleAt(event.offsetX, event.offsetY);
    this.#hand.turn(this.#drawing.between(this.#last, angle));
    this.#last = angle;
  }

  #up(event) {
    if (event.pointerId !== this.#pointer) return;
    this.#pointer = undefined;
    this.#hand.release();
  }

  #key(event) {
    const step = this.#hand.span * INPUT.key;
    const page = this.#hand.span * INPUT.page;
    const moves = {
      ArrowRight: step, ArrowUp: step, ArrowLeft: -step, ArrowDown: -step, PageUp: page, PageDown: -page,
    };
    if (event.key === " ") {
      if (!event.repeat) this.#hand.toggle();
    } else if (event.key === "Home") {
      this.#hand.grab();
      this.#hand.put(0);
    } else if (event.key in moves) {
      this.#hand.grab();
      this.#hand.turn(moves[event.key]);
    } else {
      return;
    }
    event.preventDefault();
  }

  /** Asks the stick, which nothing announces: once a frame. */
  poll() {
    const stick = [...(navigator.getGamepads?.() ?? [])].find((pad) => pad?.axes.length > 0);
    if (!stick) return;
    const way = stick.axes[0];
    const isPushed = Math.abs(way) > INPUT.deadZone;
    if (isPushed && !this.#isPushed) this.#hand.grab();
    const part = (Math.abs(way) - INPUT.deadZone) / (1 - INPUT.deadZone);
    if (isPushed) this.#hand.put(Math.sign(way) * part * this.#hand.span);
    else if (this.#isPushed) this.#hand.put(0);
    this.#isPushed = isPushed;
  }
}
