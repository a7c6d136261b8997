// The handle as a drawing: a paddle before its wall, or a knob with its detents.

/** Shares of the drawing, and the widest that a paddle is shown to turn, in rad on the screen. */
const DRAWN = { widest: 1.25, hub: 0.07, coils: 9, quiet: 1e-9 };

/** Draws a handle, and says which angle is where. Positive angles are to the right, and clockwise. */
class HandleDrawing {
  #canvas;
  #isKnob = false;
  #span = 0.25;
  #detents = [];
  #ends = [];

  constructor(canvas) {
    this.#canvas = canvas;
  }

  /** What kind of handle it is, and the angle in rad from its middle to its edge. */
  show({ is_knob: isKnob, face }) {
    this.#isKnob = isKnob;
    this.#span = isKnob ? Math.PI : Math.max(0.25, 1.5 * Math.abs(face ?? 0));
  }

  /** The angle in rad from the middle of the drawing to its edge. */
  get span() {
    return this.#span;
  }

  /** How many times larger than they are angles are drawn. */
  get gain() {
    return this.#isKnob ? 1 : DRAWN.widest / this.#span;
  }

  /** Takes the torque at rest in N m around the turn whose middle is at an angle in rad: where it draws a
   * knob back to, it has a detent. Beyond the `ends` there is a stop. */
  setRim(middle, torques, ends) {
    const angle = (index) => middle + Math.PI * (2 * index / (torques.length - 1) - 1);
    this.#detents = [];
    this.#ends = (ends ?? []).filter((end) => Math.abs(end - middle) <= Math.PI);
    let [sign, since] = [0, 0];
    torques.forEach((torque, index) => {
      if (!(Math.abs(torque) > DRAWN.quiet)) return;
      if (sign < 0 && torque > 0) this.#detents.push(angle((since + index) / 2));
      [sign, since] = [Math.sign(torque), index];
    });
  }

  /** Where things are, in pixels. */
  get #place() {
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    if (this.#isKnob) {
      return { x: width / 2, y: height / 2, radius: 0.33 * Math.min(width, height) };
    }
    const radius = Math.min(0.74 * height, 0.4 * width);
    return { x: width / 2, y: 0.93 * height, radius };
  }

  /** The angle in rad that a place in pixels stands for. */
  angleAt(x, y) {
    const place = this.#place;
    if (this.#isKnob) return Math.atan2(x - place.x, place.y - y);
    return (x - place.x) / place.radius / this.gain;
  }

  /** From one such angle to another; a knob turns the short way. */
  between(from, to) {
    if (!this.#isKnob) return to - from;
    return (to - from) - 2 * Math.PI * Math.round((to - from) / (2 * Math.PI));
  }

  /** Draws it: `position` and `setpoint` in rad, the latter undefined where no hand holds it. */
  draw({ position, setpoint, face, one_sided: oneSided }) {
    const [canvas, density] = [this.#canvas, devicePixelRatio || 1];
    const pixels = (side) => Math.round(side * density);
    const [width, height] = [pixels(canvas.clientWidth), pixels(canvas.clientHeight)];
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const pen = canvas.getContext("2d");
    pen.setTransform(density, 0, 0, density, 0, 0);
    pen.clearRect(0, 0, width, height);
    [pen.lineCap, pen.lineJoin] = ["round", "round"];
    pen.font = `12px ${getComputedStyle(canvas).fontFamily}`;
    if (this.#isKnob) this.#knob(pen, position, setpoint);
    else this.#paddle(pen, position, setpoint, face, oneSided);
  }

  /** A place in pixels, at an angle in rad on the screen and a part of the radius. */
  #at(angle, part) {
    const { x, y, radius } = this.#place;
    return [x + part * radius * Math.sin(angle), y - part * radius * Math.cos(angle)];
  }

  /** An angle in rad as it is drawn. */
  #drawn(angle) {
    if (this.#isKnob) return angle;
    return Math.min(Math.max(angle * this.gain, -1.15 * DRAWN.widest), 1.15 * DRAWN.widest);
  }

  #line(pen, points, ink, width, dash = []) {
    pen.beginPath();
    points.forEach((point, index) => (index ? pen.lineTo(...point) : pen.moveTo(...point)));
    [pen.strokeStyle, pen.lineWidth] = [Inks.of(ink), width];
    pen.setLineDash(dash);
    pen.stroke();
    pen.setLineDash([]);
  }

  #disc(pen, [x, y], radius, fill, edge) {
    pen.beginPath();
    pen.arc(x, y, radius, 0, 2 * Math.PI);
    pen.fillStyle = Inks.of(fill);
    pen.fill();
    [pen.strokeStyle, pen.lineWidth] = [Inks.of(edge), 2];
    pen.stroke();
  }

  #paddle(pen, position, setpoint, face, oneSided) {
    const angle = this.#drawn(position);
    if (face !== null) this.#wall(pen, this.#drawn(face), oneSided);
    this.#scale(pen);
    this.#line(pen, [this.#at(angle, 0), this.#at(angle, 1)], "--ink", 10);
    this.#line(pen, [this.#at(angle, 0), this.#at(angle, 1)], "--accent", 5);
    this.#disc(pen, this.#at(0, 0), DRAWN.hub * this.#place.radius, "--panel", "--ink");
    if (setpoint !== undefined) this.#hand(pen, angle, this.#drawn(setpoint), 1);
    this.#disc(pen, this.#at(angle, 1), 9, "--accent", "--ink");
  }

  /** The wall: hatched from its face on, on both sides of where it rests unless it pushes one way only. */
  #wall(pen, face, oneSided) {
    const edge = 1.15 * DRAWN.widest;
    if (oneSided) {
      pen.save();
      pen.beginPath();
      pen.moveTo(...this.#at(0, 0));
      for (let step = 0; step <= 24; step += 1) {
        pen.lineTo(...this.#at(face + (edge - face) * step / 24, 1.12));
      }
      pen.clip();
      const { x, y, radius } = this.#place;
      for (let at = -2 * radius; at < 2 * radius; at += 9) {
        this.#line(pen, [[x + at, y], [x + at + radius * 1.2, y - radius * 1.2]], "--edge", 1);
      }
      pen.restore();
    }
    const [thick, dash] = oneSided ? [3, []] : [2, [5, 6]];
    this.#line(pen, [this.#at(face, 0.15), this.#at(face, 1.12)], "--edge", thick, dash);
    const [x, y] = this.#at(face, 1.17);
    [pen.fillStyle, pen.textAlign] = [Inks.of("--muted"), "center"];
    pen.fillText(oneSided ? "face" : "rest", x, y - 4);
  }

  /** Marks of round angles, in rad. */
  #scale(pen) {
    [pen.fillStyle, pen.textAlign] = [Inks.of("--muted"), "center"];
    for (const angle of roundNumbers([-this.#span, this.#span], 6)) {
      const drawn = this.#drawn(angle);
      this.#line(pen, [this.#at(drawn, 1.08), this.#at(drawn, 1.12)], "--edge", 1);
      if (angle === 0) continue;
      const [x, y] = this.#at(drawn, 1.2);
      pen.fillText(`${angle}`, x, y + 4);
    }
  }

  #knob(pen, position, setpoint) {
    const { x, y, radius } = this.#place;
    for (const end of this.#ends) {
      this.#line(pen, [this.#at(end, 1.03), this.#at(end, 1.3)], "--bad", 4);
      const [at, height] = this.#at(end, 1.42);
      [pen.fillStyle, pen.textAlign] = [Inks.of("--muted"), "center"];
      pen.fillText("stop", at, height + 4);
    }
    for (const detent of this.#detents) {
      this.#line(pen, [this.#at(detent, 1.06), this.#at(detent, 1.16)], "--ink", 2);
    }
    this.#disc(pen, [x, y], radius, "--panel", "--ink");
    for (let ridge = 0; ridge < 36; ridge += 1) {
      const angle = position + ridge * Math.PI / 18;
      this.#line(pen, [this.#at(angle, 0.94), this.#at(angle, 0.99)], "--edge", 1);
    }
    this.#line(pen, [this.#at(position, 0.35), this.#at(position, 0.92)], "--accent", 6);
    if (setpoint !== undefined) this.#hand(pen, position, setpoint, 1.3);
    this.#disc(pen, this.#at(position, 0.8), 7, "--accent", "--ink");
  }

  /** The hand's set-point as a ring, and its spring to the device. */
  #hand(pen, angle, setpoint, part) {
    const points = [this.#at(angle, this.#isKnob ? 0.8 : part)];
    // Windings further than a turn are drawn as one.
    const way = Math.min(Math.max(setpoint - angle, -2 * Math.PI), 2 * Math.PI);
    for (let coil = 1; coil < 2 * DRAWN.coils; coil += 1) {
      const swing = Math.min(0.03, 0.3 * Math.abs(way)) * (coil % 2 ? 1 : -1);
      points.push(this.#at(angle + way * coil / (2 * DRAWN.coils), part + swing));
    }
    points.push(this.#at(setpoint, part));
    this.#line(pen, points, "--warn", 2);
    this.#disc(pen, this.#at(setpoint, part), 8, "--paper", "--warn");
    const [x, y] = this.#at(setpoint, part);
    const side = setpoint < angle ? -1 : 1;
    [pen.fillStyle, pen.textAlign] = [Inks.of("--warn"), side < 0 ? "right" : "left"];
    pen.fillText("hand", x + 13 * side, y + 4);
  }
}
