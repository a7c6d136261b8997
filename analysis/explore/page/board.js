// A running board: its line, kept open; its state, as `haptic scope` says it; and what it is asked for.

/** Time between two polls, in ms; bytes are taken as they come. */
const BOARD_TURN = 50;
/** Most rows of a record: half an hour at 1 kHz, some 150 MB. */
const BOARD_ROWS = 2_000_000;

/** The explanation before a motor moves. */
const BOARD_EXPLAINED = {
  arm: ["Switch the motor on", (program) =>
    `This switches the motor on. The torque of ${program} fades in where the handle is. Hold the handle ` +
    "with one hand, and keep hair, sleeves and cables away from it. Disarm, or the Escape key, fades the " +
    "torque out and switches the motor off; a fault of the board switches it off, too. If this page or its " +
    "link is lost, the board goes on, unless its program stops without a host: have the supply's switch at hand."],
  align: ["Turn the handle", () =>
    "This aligns a brushless motor: its field turns the handle for some seconds, so that the board knows how " +
    "rotor and encoder stand. Keep the hand off. It is needed once after each reset, unless the program states " +
    "the offset of the encoder's index. Disarm, or the Escape key, ends it."],
};

/** Bytes as letters, as the program takes them. */
function lettersOf(bytes) {
  let letters = "";
  for (let at = 0; at < bytes.length; at += 4096) {
    letters += String.fromCharCode(...bytes.subarray(at, at + 4096));
  }
  return letters;
}

/** The link to a board, which is opened again and again until it is disconnected. */
class BoardLink {
  #engine;
  #on;
  #facts;
  #line;
  #timer;
  #retry;
  #number = Math.floor(Math.random() * 65536);

  /** Calls `on.link` with a state and a sentence, `on.board` with a board, `on.reply` with what became of a
   * request, and `on.rows` with rows of a record. */
  constructor(engine, on) {
    this.#engine = engine;
    this.#on = on;
    this.#facts = engine.json("wire_facts");
  }

  /** What holds for every board. */
  get facts() {
    return this.#facts;
  }

  /** Connects by this line, instead of any before. */
  async connect(line) {
    await this.disconnect();
    this.#line = line;
    await this.#open(line, true);
  }

  /** Ends the link. */
  async disconnect() {
    const line = this.#line;
    this.#line = undefined;
    this.#stop();
    this.#on.link("off", "");
    await line?.close();
  }

  /** Asks the board for something; throws the reason where it is not even sent. */
  request(request, changes = "") {
    this.#take(this.#engine.json("wire_request", JSON.stringify({ now: performance.now(), request, changes })));
  }

  async #open(line, isFirst) {
    this.#on.link("opening", `connecting to ${line.name} ...`);
    const of = (call) => (...values) => {
      if (this.#line === line) call(...values);
    };
    try {
      await line.open({
        open: of(() => this.#start()),
        bytes: of((bytes) => this.#turn(bytes)),
        waits: of((why) => this.#wait(why)),
        lost: of((why, isFinal) => this.#lose(why, isFinal)),
      }, this.#facts);
      if (this.#line !== line) await line.close();
    } catch (error) {
      of(() => this.#lose(error.message, isFirst))();
    }
  }

  /** Begins to talk to the board. */
  #start() {
    clearInterval(this.#timer);
    this.#timer = setInterval(() => this.#turn(new Uint8Array()), BOARD_TURN);
    this.#number = (this.#number + 4096) % 65536;
    const start = { address: this.#line.name, now: performance.now(), id: this.#number };
    this.#take(this.#engine.json("wire_start", JSON.stringify(start)));
  }

  #turn(bytes) {
    this.#take(this.#engine.json("wire_turn", `${performance.now()}\n${lettersOf(bytes)}`));
  }

  /** Forwards new messages. */
  #take({ send, replies, rows, board, lost }) {
    if (send !== "") this.#line?.send(Uint8Array.from(send, (letter) => letter.charCodeAt(0)));
    if (rows !== "") this.#on.rows(rows);
    for (const reply of replies) this.#on.reply(reply);
    if (board !== null) {
      this.#on.link("on", `connected to ${board.address}`);
      this.#on.board(board);
    }
    if (lost !== null) this.#lose(lost, false);
  }

  /** The port of the board is lost where the line itself is not. */
  #wait(why) {
    this.#stop();
    this.#on.link("lost", `${why}; connecting again`);
  }

  #lose(why, isFinal) {
    const line = this.#line;
    this.#stop();
    line?.close();
    if (isFinal) {
      this.#line = undefined;
      this.#on.link("off", why);
      return;
    }
    this.#on.link("lost", `${why}; connecting again`);
    this.#retry = setTimeout(() => this.#open(line, false), this.#facts.retry);
  }

  /** Ends the conversation, of which nothing is waited for any more. */
  #stop() {
    clearInterval(this.#timer);
    clearTimeout(this.#retry);
    for (const reply of this.#engine.json("wire_lost").replies) this.#on.reply(reply);
  }
}

/** The table of a record, row by row. */
class BoardRecord {
  #engine;
  #rows = [];
  /** How many rows there are. */
  count = 0;
  /** Whether more are added. */
  isRunning = false;

  constructor(engine) {
    this.#engine = engine;
  }

  /** Begins a new table, or ends this one. */
  toggle(columns) {
    this.isRunning = !this.isRunning;
    this.#engine.ask("wire_record", this.isRunning ? "on" : "off");
    if (this.isRunning) [this.#rows, this.count] = [[`${columns}\n`], 0];
  }

  /** Adds rows; a full table takes no more. */
  add(rows) {
    if (!this.isRunning) return;
    this.#rows.push(rows);
    for (const letter of rows) this.count += letter === "\n" ? 1 : 0;
    if (this.count >= BOARD_ROWS) this.toggle();
  }

  /** Has the browser save the table as a file. */
  save(name) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob(this.#rows, { type: "text/csv" }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  }
}

/** The fields of the numbers that run on a board, and their changes. */
class BoardNumbers {
  #engine;
  #form;
  #fields = new Map();
  #sets;

  constructor(engine, form) {
    this.#engine = engine;
    this.#form = form;
    form.addEventListener("input", () => this.judge());
  }

  /** Shows the numbers of a board. Text being typed stays until it runs. */
  show({ numbers, sets }) {
    const names = numbers.map(({ name }) => name).join(" ");
    if (names !== [...this.#fields.keys()].join(" ")) this.#make(numbers);
    const isOther = sets !== this.#sets;
    this.#sets = sets;
    for (const { name, value, unit } of numbers) {
      const field = this.#fields.get(name);
      if (isOther || field.input.value === String(field.value)) field.input.value = String(value);
      field.value = value;
      field.runs.textContent = `runs: ${value} ${unit}`.trim();
    }
    this.judge();
  }

  /** The changes, as they are typed on a command line. */
  changes() {
    const isChanged = ([, { input, value }]) => input.value.trim() !== String(value);
    const changed = [...this.#fields].filter(isChanged);
    return changed.map(([name, { input }]) => `${name}=${input.value.trim()}`).join(", ");
  }

  /** Judges the typed numbers by the scene of the board, and states why they cannot run. */
  judge() {
    const changes = this.changes();
    const says = document.getElementById("board-judged");
    const apply = document.getElementById("board-apply");
    let why = "";
    if (changes !== "") {
      try {
        this.#engine.ask("wire_judge", changes);
      } catch (refusal) {
        why = refusal.message;
      }
    }
    apply.disabled = changes === "" || why !== "";
    if (says.textContent !== why) says.textContent = why;
    for (const { input, value } of this.#fields.values()) {
      const isChanged = input.value.trim() !== String(value);
      input.setAttribute("aria-invalid", String(isChanged && why !== ""));
    }
  }

  #make(numbers) {
    this.#fields.clear();
    const rows = numbers.map(({ name, words, unit, value }) => {
      const [row, label, input, runs] = ["p", "label", "input", "span"].map((tag) => document.createElement(tag));
      input.id = `board-number-${name}`;
      input.inputMode = "decimal";
      input.setAttribute("aria-describedby", "board-judged");
      label.htmlFor = input.id;
      label.textContent = unit ? `${name}, ${unit}` : name;
      label.title = words;
      row.append(label, input, runs);
      this.#fields.set(name, { input, runs, value: undefined });
      return row;
    });
    this.#form.replaceChildren(...rows);
  }
}

/** Shows the board's part of the page. */
function showBoard(engine, store) {
  const part = (name) => document.getElementById(`board-${name}`);
  const section = document.getElementById("board");
  const record = new BoardRecord(engine);
  const numbers = new BoardNumbers(engine, part("numbers"));
  let [shown, wanted] = [undefined, undefined];
  const begin = store.text();
  let isOpened = false;
  const say = (sentence) => { part("reply").textContent = sentence; };
  const link = new BoardLink(engine, {
    link: (state, sentence) => {
      section.dataset.link = state;
      if (part("link").textContent !== sentence) part("link").textContent = sentence;
      part("disconnect").hidden = state === "off";
      for (const name of ["disarm", "arm", "align"]) part(name).disabled = state !== "on";
      if (state !== "on") {
        explain(undefined);
        delete section.dataset.state;
      }
    },
    board: (board) => {
      shown = board;
      showBoardState(part, section, board);
      numbers.show(board);
      isOpened ||= openSceneOfBoard(engine, store, begin);
    },
    reply: say,
    rows: (rows) => {
      record.add(rows);
      showRecord();
    },
  });

  const attempt = (action) => {
    try {
      action();
    } catch (refusal) {
      say(refusal.message);
    }
  };
  const connect = async (line) => {
    try {
      await link.connect(await line());
    } catch (error) {
      part("link").textContent = error.message;
    }
  };
  /** Explains a request, which its button then makes; nothing hides the explanation. */
  function explain(request) {
    wanted = request;
    part("explained").hidden = request === undefined;
    if (request === undefined) return;
    const [button, words] = BOARD_EXPLAINED[request];
    part("explanation").textContent = words(shown.program);
    part("go").textContent = button;
    part("explained").focus();
  }
  function disarm() {
    explain(undefined);
    attempt(() => link.request("disarm"));
  }
  function showRecord() {
    part("record").textContent = record.isRunning ? "End the record" : "Record";
    part("save").disabled = record.count === 0;
    const full = record.count >= BOARD_ROWS ? ": the table is full" : "";
    part("recorded").textContent = record.count === 0 ? "" : `${record.count} ticks${full}`;
  }

  part("serial").hidden = !SerialLine.isThere();
  part("no-serial").hidden = SerialLine.isThere();
  part("address").value = ServedLine.own() ?? "";
  part("serial").onclick = () => connect(() => SerialLine.choose());
  part("socket").onsubmit = (event) => {
    event.preventDefault();
    connect(() => new ServedLine(part("address").value));
  };
  part("disconnect").onclick = () => link.disconnect();
  part("disarm").onclick = disarm;
  part("arm").onclick = () => explain("arm");
  part("align").onclick = () => explain("align");
  part("cancel").onclick = () => explain(undefined);
  part("go").onclick = () => {
    const request = wanted;
    explain(undefined);
    attempt(() => link.request(request));
  };
  part("change").onsubmit = (event) => {
    event.preventDefault();
    attempt(() => link.request("set", numbers.changes()));
  };
  part("record").onclick = () => {
    record.toggle(link.facts.columns);
    showRecord();
  };
  part("save").onclick = () => record.save(`${shown?.program ?? "board"}.csv`);
  document.addEventListener("keydown", ({ key }) => {
    if (key === "Escape" && section.dataset.link === "on") disarm();
  });
  const draw = () => {
    requestAnimationFrame(draw);
    if (section.dataset.link !== "on") return;
    engine.ask("wire_curves", String(Math.max(1, Math.round(part("curves").clientWidth))));
    drawStrips(part("curves"), curvesOf(engine.numbers()), link.facts.window);
  };
  draw();
}

/** Shows the scene of the board in place of that with which the page began; true once it is known. */
function openSceneOfBoard(engine, store, begin) {
  const scene = engine.json("wire_scene");
  if (scene !== null && store.text() === begin) store.replace(scene);
  return scene !== null;
}

/** Shows how a board is, in words. */
function showBoardState(part, section, board) {
  const set = (name, text) => {
    const element = part(name);
    if (element.textContent !== text) element.textContent = text;
    element.hidden = text === "";
  };
  section.dataset.state = board.fault ? "fault" : board.is_armed ? "armed" : "off";
  part("live").hidden = false;
  set("state", `${board.program}: ${board.state}`);
  set("fault", board.fault ?? "");
  set("lost", board.is_link_lost ? "the board counts its host as lost" : "");
  set("previous", [board.previous_fault, board.reset].filter(Boolean).join("; "));
  set("power", board.power ?? "");
  part("align").hidden = board.power === null;
  const lines = board.lines.map((line) => {
    const item = document.createElement("li");
    item.textContent = line;
    return item;
  });
  part("words").replaceChildren(...lines);
}
