// The handle: a simulated device in the hand of the person before the page, with the servo that boards run.

/** The most time in s that a frame makes up for, the most ms and ticks that it computes, and what a tick is
 * taken to cost in ms until it is known; the ms between two readings in words, the strip's length in s and in
 * samples. */
const HANDLE = {
  longest: 0.05, budget: 8, most: 20_000, cost: 0.002, words: 120, seconds: 2, samples: 2000,
};

/** Places in a tick's numbers. */
const TICK = { count: 0, angle: 1, torque: 2, code: 3, limit: 4, setpoint: 5, position: 6, numbers: 7 };

class Handle {
  #engine;
  #store;
  #held;
  #text;
  #isHeld = true;
  #isTakingOver = false;
  #target = 0;
  #position = 0;
  #time = 0;
  #owed = 0;
  #frame = 0;
  #tickCost = HANDLE.cost;
  #said = 0;
  #turn;
  #limit;
  #isSeen = true;
  #section;
  #canvas;
  #drawing;
  #input;
  #strip;
  #sound = new Sound();
  #bar = new ForceBar();
  #settings = new HandSettings(() => this.#hold());
  #parts = {};

  constructor(engine, store, laws) {
    [this.#engine, this.#store] = [engine, store];
    this.#section = document.getElementById("handle");
    this.#build(laws);
    this.#drawing = new HandleDrawing(this.#canvas);
    this.#input = new HandInput(this.#canvas, this.#drawing, this, (words) => say(this.#parts.news, words));
    new IntersectionObserver((entries) => { this.#isSeen = entries.at(-1).isIntersecting; })
      .observe(this.#section);
    store.listen(() => this.#hold());
  }

  /** Starts time. */
  start() {
    requestAnimationFrame((now) => this.#draw(now));
  }

  // What moves the hand.

  /** The angle in rad from the middle of the drawing to its edge. */
  get span() {
    return this.#drawing.span;
  }

  /** Takes the device, where it is, also from a push. */
  grab() {
    this.#isTakingOver = true;
    if (!this.#isHeld) this.#target = this.#position;
    this.#isHeld = true;
  }

  turn(by) {
    // A drawing without a size has no angles.
    if (Number.isFinite(by)) this.#target += by;
  }

  put(angle) {
    this.#target = angle;
  }

  /** The pointer is up: the hand lets go, unless it is to stay. */
  release() {
    if (!this.#parts.stays.checked) this.#isHeld = false;
  }

  toggle() {
    if (this.#isHeld) this.#isHeld = false;
    else this.grab();
    this.#isTakingOver = true;
  }

  // What programs ask.

  /** The codes that the servo of a scene, as text or object, makes of counts. */
  codes(scene, counts, countsPerTurn = null) {
    const text = typeof scene === "string" ? scene : JSON.stringify(scene);
    const question = { scene: text, counts_per_turn: countsPerTurn, counts: Array.from(counts) };
    this.#engine.ask("handle_replay", JSON.stringify(question));
    return Array.from(this.#engine.numbers());
  }

  /** What the servo did since it was built: scene, counts a turn, and count and code of each tick. */
  dragged() {
    const scene = this.#engine.ask("handle_record");
    const numbers = this.#engine.numbers();
    const column = (part) => Array.from(numbers.filter((_, index) => index % 2 === part));
    const [counts, codes] = [column(0), column(1)];
    return { scene, countsPerTurn: this.#held.counts_per_turn, counts, codes };
  }

  // The elements.

  #build(laws) {
    const parts = this.#parts;
    parts.state = make("p", { id: "handle-state", role: "status" });
    parts.news = make("p", { id: "handle-news", role: "status" });
    parts.error = make("p", { id: "handle-error", className: "error", role: "alert" });
    this.#canvas = make("canvas", {
      id: "handle-drawing", tabIndex: 0, role: "slider", "aria-label": "Handle: arrow keys turn the hand, "
        + "Page Up and Page Down turn it further, Home puts it to zero, the space bar lets go and holds",
      "aria-valuemin": "-3.14", "aria-valuemax": "3.14", "aria-valuenow": "0",
    });
    parts.words = make("p", { id: "handle-words" });
    parts.oscillation = make("p", { id: "handle-oscillation" });
    parts.energy = make("p", { id: "handle-energy" });
    parts.taken = make("p", { id: "handle-taken" });
    this.#section.append(
      parts.state, parts.error, this.#canvas, this.#bar.element, parts.words, parts.oscillation,
      this.#buttons(), this.#host(laws), parts.news, this.#settings.element, parts.energy);
    const lines = [
      { name: "motor torque", unit: "N m", least: 0.01 }, { name: "device", unit: "rad", least: 0.01 },
      { name: "hand", unit: "rad", dash: [4, 4] },
    ];
    this.#strip = new Strip(this.#section, {
      name: "handle", title: "Torque and angle of the handle", seconds: HANDLE.seconds, height: 320, lines,
    });
  }

  #buttons() {
    const parts = this.#parts;
    const button = (words, act) => {
      const element = make("button", { type: "button", textContent: words });
      element.addEventListener("click", act);
      return element;
    };
    const choice = (words, checked, act) => {
      const box = make("input", { type: "checkbox", checked });
      box.addEventListener("change", act);
      return [box, make("label", {}, box, ` ${words}`)];
    };
    parts.push = button("Push", () => this.#push());
    parts.push.title = "A simulated hand plays the motion that shows this environment";
    parts.hold = button("Let go", () => this.toggle());
    parts.sound = button("Sound", () => this.#turnSound());
    parts.sound.setAttribute("aria-pressed", "false");
    parts.volume = make("input", {
      type: "range", min: 0, max: 1, step: 0.05, value: 0.5, hidden: true, "aria-label": "Volume",
    });
    parts.volume.addEventListener("input", () => { this.#sound.volume = Number(parts.volume.value); });
    const [stays, staysLabel] = choice("Stays when the pointer is up", false, () => {});
    const [check, checkLabel] = choice("Check: torque of certified scenes only", true, () => this.#hold());
    [stays.id, check.id] = ["handle-stays", "handle-check"];
    [parts.stays, parts.check] = [stays, check];
    [parts.push.id, parts.hold.id, parts.sound.id] = ["handle-push", "handle-hold", "handle-sound"];
    return make("div", { id: "handle-buttons" },
      parts.push, parts.hold, parts.sound, parts.volume, staysLabel, checkLabel);
  }

  /** The switch for a host that wants energy, of scenes that may have one. */
  #host(laws) {
    const parts = this.#parts;
    const options = ["", ...laws].map((law) => new Option(law || "none", law));
    parts.law = make("select", { id: "handle-host" }, ...options);
    parts.tank = make("input", { type: "checkbox", id: "handle-tank", checked: true });
    for (const part of [parts.law, parts.tank]) part.addEventListener("change", () => this.#hold());
    parts.host = make("div", { id: "handle-hosted", hidden: true },
      make("label", {}, "Hostile host: ", parts.law), " ", make("label", {}, parts.tank, " Tank of energy"), parts.taken);
    return parts.host;
  }

  // The scene.

  /** Takes the scene that the page shows into the hand. */
  #hold() {
    const parts = this.#parts;
    const settings = this.#settings.read();
    if (!settings) return;
    const { counts, ...hand } = settings;
    const last = this.#held ? " The handle keeps the last scene that could." : "";
    if (this.#store.judged?.errors) {
      say(parts.error, `This scene cannot be read.${last}`);
      return;
    }
    const scene = this.#store.text();
    const question = {
      scene, counts_per_turn: counts, hand, is_checked: parts.check.checked, host: parts.law.value || null,
      has_no_tank: !parts.tank.checked,
    };
    try {
      this.#held = this.#engine.json("handle_hold", JSON.stringify(question));
    } catch (error) {
      say(parts.error, `This scene cannot be held: ${error.message}.${last}`);
      return;
    }
    say(parts.error, "");
    const { torque_limit: limit } = this.#held;
    if (scene !== this.#text) this.#turn = undefined;
    if (scene !== this.#text || limit !== this.#limit) this.#bar.begin(limit);
    this.#limit = limit;
    this.#text = scene;
    parts.host.hidden = !this.#held.has_host;
    this.#drawing.show(this.#held);
    this.#canvas.setAttribute("aria-valuemin", (-this.span).toFixed(3));
    this.#canvas.setAttribute("aria-valuemax", this.span.toFixed(3));
    this.#strip.levels = [-1, 1].map((sign) => ({ line: 0, value: sign * this.#held.torque_limit }));
    this.#sayState();
  }

  #sayState() {
    const { rendering, refusal, period, counts_per_turn: counts } = this.#held;
    this.#section.dataset.rendering = rendering;
    const rate = `${plotNumber(1 / period)} Hz, ${plotNumber(counts, 6)} counts a turn`;
    const because = refusal ? ` ${refusal[0].toUpperCase()}${refusal.slice(1)}.` : "";
    say(this.#parts.state, {
      certified: `Certified: the servo of the board, tick by tick in f32, at ${rate}.`,
      unchecked: `Check off: simulation only, and never sent to a board. At ${rate}.${because}`,
      off: `No torque.${because}`,
    }[rendering]);
  }

  // Time.

  #draw(now) {
    requestAnimationFrame((next) => this.#draw(next));
    const elapsed = Math.min((now - this.#frame) / 1000, HANDLE.longest);
    this.#frame = now;
    if (!this.#held || !(this.#isSeen || this.#sound.isOn)) return;
    this.#input.poll();
    const { period } = this.#held;
    const speed = this.#speed(elapsed / period);
    this.#owed += elapsed * speed / period;
    const ticks = Math.floor(this.#owed);
    this.#owed -= ticks;
    if (ticks > 0) this.#move(ticks, speed);
  }

  /** The part of its own speed at which so many ticks a frame can be shown. */
  #speed(ticks) {
    let speed = 1;
    const most = Math.min(HANDLE.most, HANDLE.budget / this.#tickCost);
    while (ticks * speed > most) speed /= 2;
    return speed;
  }

  #move(ticks, speed) {
    const begin = performance.now();
    const question = {
      ticks, setpoint: this.#target, is_held: this.#isHeld, takes_over: this.#isTakingOver,
    };
    const moved = this.#engine.json("handle_move", JSON.stringify(question));
    if (moved.fault && this.#held.rendering !== "off") {
      Object.assign(this.#held, { rendering: "off", refusal: moved.fault });
      this.#sayState();
    }
    const numbers = this.#engine.numbers();
    const cost = (performance.now() - begin) / ticks;
    // The first calls are those of a program that is not compiled for speed yet.
    this.#tickCost += 0.1 * (cost - this.#tickCost);
    this.#isTakingOver = false;
    if (moved.is_pushing || !moved.is_held) this.#target = moved.setpoint;
    this.#isHeld = moved.is_held;
    this.#position = numbers.at(-1);
    this.#keep(numbers, ticks, speed);
    this.#show(moved, numbers, speed);
  }

  /** Puts ticks into the strip, the extremes of several where there are many, and into the sound. */
  #keep(numbers, ticks, speed) {
    const { period } = this.#held;
    const group = Math.max(1, Math.ceil(HANDLE.seconds / period / HANDLE.samples));
    const parts = new Float64Array(ticks);
    for (let tick = 0; tick < ticks; tick += 1) parts[tick] = -numbers[tick * TICK.numbers + TICK.torque];
    this.#bar.widen(parts);
    for (let first = 0; first < ticks; first += group) {
      const torques = parts.subarray(first, Math.min(first + group, ticks));
      const row = (first + torques.length) * TICK.numbers - TICK.numbers;
      const hand = this.#isHeld ? numbers[row + TICK.setpoint] : NaN;
      const extremes = group === 1 ? [torques[0]] : [Math.min(...torques), Math.max(...torques)];
      for (const torque of extremes) {
        this.#time += torques.length * period / extremes.length;
        this.#strip.push(this.#time, [torque, numbers[row + TICK.position], hand]);
      }
    }
    this.#sound.play(parts.map((torque) => torque / this.#bar.scale), speed / period);
  }

  #show(moved, numbers, speed) {
    let [least, most, sum, limit] = [Infinity, -Infinity, 0, 0];
    for (let row = 0; row < numbers.length; row += TICK.numbers) {
      const torque = -numbers[row + TICK.torque];
      [least, most, sum] = [Math.min(least, torque), Math.max(most, torque), sum + torque];
      limit ||= numbers[row + TICK.limit];
    }
    const mean = sum / (numbers.length / TICK.numbers);
    this.#bar.show({ least, most, mean, limit });
    this.#showRim();
    const setpoint = this.#isHeld ? moved.setpoint : undefined;
    this.#drawing.draw({ ...this.#held, position: this.#position, setpoint });
    this.#strip.draw();
    const now = performance.now();
    if (now - this.#said < HANDLE.words) return;
    this.#said = now;
    this.#sayMotion(moved, mean, speed);
  }

  /** The detents around a knob, those of the turn in which it is. */
  #showRim() {
    if (!this.#held.is_knob) return;
    const turn = 2 * Math.PI * Math.round(this.#position / (2 * Math.PI));
    if (turn === this.#turn) return;
    this.#turn = turn;
    const question = { scene: this.#text, from: turn - Math.PI, to: turn + Math.PI };
    const { ends } = this.#engine.json("handle_rim", JSON.stringify(question));
    this.#drawing.setRim(turn, this.#engine.numbers(), ends);
  }

  #sayMotion(moved, mean, speed) {
    const parts = this.#parts;
    const slow = speed < 1 ? `, shown at 1/${Math.round(1 / speed)} of its speed` : "";
    const { gain } = this.#drawing;
    const times = gain > 1 ? `; angles are drawn ${plotNumber(gain, 2)} times as large` : "";
    const hand = this.#isHeld ? `hand at ${this.#target.toFixed(4)} rad` : "let go";
    say(parts.words, `Device at ${this.#position.toFixed(4)} rad, ${hand}${times}${slow}.`);
    const { oscillation, energy } = moved;
    const shakes = oscillation && oscillation.counts > 3;
    this.#section.dataset.oscillates = String(Boolean(shakes));
    parts.oscillation.classList.toggle("error", Boolean(shakes));
    const kind = shakes ? "Oscillates" : "Hunts between steps of the encoder";
    say(parts.oscillation, oscillation
      ? `${kind}: ${plotNumber(oscillation.amplitude, 2)} N m at ${plotNumber(oscillation.frequency, 3)} Hz.`
      : "No oscillation.");
    const millijoules = (joules) => `${plotNumber(1000 * joules, 3)} mJ`;
    const more = energy.got_back > energy.given ? ", more than it gave" : "";
    const [given, back] = [energy.given, energy.got_back].map(millijoules);
    say(parts.energy, `The hand gave ${given} and got back ${back}${more}.`);
    this.#sayTaken(moved.host, millijoules);
    say(parts.hold, this.#isHeld ? "Let go" : "Hold");
    say(parts.push, moved.is_pushing ? "Pushing" : "Push");
    this.#canvas.setAttribute("aria-valuenow", this.#target.toFixed(3));
    this.#canvas.setAttribute("aria-valuetext", `${hand}, motor torque ${mean.toFixed(2)} N m`);
  }

  /** What the hand has taken of a host's budget. */
  #sayTaken(host, millijoules) {
    const { taken } = this.#parts;
    const isAbove = Boolean(host && host.taken > host.budget);
    taken.classList.toggle("error", isAbove);
    const budget = host && `${millijoules(host.taken)} of a budget of ${millijoules(host.budget)}`;
    say(taken, host
      ? `The hand took ${budget}${isAbove ? ", more than that" : ""}; ${plotNumber(100 * host.refused, 2)} % refused.`
      : this.#held.host_refusal ?? "");
  }

  #push() {
    this.#isTakingOver = false;
    this.#engine.ask("handle_push");
  }

  async #turnSound() {
    const { sound, volume, news } = this.#parts;
    try {
      if (this.#sound.isOn) await this.#sound.turnOff();
      else await this.#sound.turnOn();
    } catch (error) {
      say(news, `No sound: ${error.message}`);
    }
    sound.setAttribute("aria-pressed", String(this.#sound.isOn));
    volume.hidden = !this.#sound.isOn;
  }
}

/** Shows the handle, and lets other programs ask it. */
function showHandle(engine, store, laws) {
  const handle = new Handle(engine, store, laws);
  window.haptic.handle = (scene, counts, countsPerTurn) => handle.codes(scene, counts, countsPerTurn);
  window.haptic.dragged = () => handle.dragged();
  handle.start();
}
