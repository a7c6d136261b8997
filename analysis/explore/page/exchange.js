// Scenes in and out of the page: presets, files, the clipboard, the scene as text.

/** Time in ms without a change after which the text of the whole scene follows. */
const PAUSE_BEFORE_TEXT = 200;

/** Fills the head of the page. */
function showActions(store, engine, { presets }) {
  const actions = document.getElementById("actions");
  const button = (id, text, act) => {
    const element = make("button", { type: "button", id, textContent: text });
    element.addEventListener("click", act);
    return element;
  };
  const file = make("input", { type: "file", id: "file", accept: ".toml,.json", hidden: true });
  file.addEventListener("change", async () => {
    for (const chosen of file.files) readScene(store, engine, await chosen.text(), chosen.name);
    file.value = "";
  });
  actions.append(
    presetChoice(store, engine, presets),
    button("open-file", "Open\u2026", () => file.click()), file,
    button("export-toml", "TOML", () => {
      const text = asToml(store, engine);
      showExport("Scene file", `${fileName(store)}.${text.startsWith("{") ? "json" : "toml"}`, text);
    }),
    button("export-rust", "Rust", () => {
      showExport("Rust constants", `${fileName(store)}.rs`, asConstants(store, engine));
    }),
    button("copy-link", "Copy link", async (event) => copy(await linkOf(store), event.target)),
    themeButton(),
  );
  takeDropped(store, engine);
  editWhole(store, engine);
}

function presetChoice(store, engine, presets) {
  const none = new Option("Choose\u2026", "");
  const names = presets.map(({ name }, index) => new Option(name, index));
  const choice = make("select", { id: "preset" }, none, ...names);
  choice.addEventListener("change", () => {
    const preset = presets[choice.value];
    if (preset) readScene(store, engine, preset.toml, preset.name);
    choice.value = "";
  });
  return make("label", { htmlFor: "preset" }, "Preset ", choice);
}

/** Takes a scene file as the scene, with all that is wrong in it but its grammar. */
function readScene(store, engine, text, name) {
  const { scene, errors } = engine.json("parse", text);
  const faults = () => errors.map(placed).join("; ");
  notice(scene ? "" : `${name} is not a scene file: ${faults()}. The scene is as it was.`);
  if (scene) store.replace(scene);
}

function placed({ line, column, sentence }) {
  return `line ${line}, column ${column}: ${sentence}`;
}

/** Files and texts that are dropped onto the page, or pasted where there is no field. */
function takeDropped(store, engine) {
  const mark = (isOver) => document.body.classList.toggle("dragged", isOver);
  addEventListener("dragover", (event) => {
    event.preventDefault();
    mark(true);
  });
  addEventListener("dragleave", () => mark(false));
  addEventListener("drop", async (event) => {
    event.preventDefault();
    mark(false);
    const [file] = event.dataTransfer.files;
    const text = file ? await file.text() : event.dataTransfer.getData("text/plain");
    readScene(store, engine, text, file?.name ?? "What was dropped");
  });
  addEventListener("paste", (event) => {
    if (event.target.closest?.("input, textarea")) return;
    const text = event.clipboardData?.getData("text/plain") ?? "";
    if (text !== "") readScene(store, engine, text, "What was pasted");
  });
}

/** The scene as Rust; where there is none, the reason as a comment. */
function asConstants(store, engine) {
  try {
    return engine.ask("constant", store.text());
  } catch (error) {
    return `// ${error.message.replaceAll("\n", "\n// ")}\n`;
  }
}

/** The scene as TOML; an incomplete scene as its JSON. */
function asToml(store, engine) {
  try {
    return engine.ask("toml", store.text());
  } catch {
    return JSON.stringify(store.scene, null, 1);
  }
}

/** The scene's name as that of a file. */
function fileName(store) {
  const name = String(store.scene.name ?? "");
  return name.replaceAll(/[^\p{L}\p{N}]+/gu, "-").replaceAll(/^-|-$/g, "") || "scene";
}

/** Shows a text to copy or to keep. */
function showExport(title, file, text) {
  document.getElementById("export")?.remove();
  const area = make("textarea", { readOnly: true, value: text, ariaLabel: title, spellcheck: false });
  const act = (words, action) => {
    const button = make("button", { type: "button", textContent: words });
    button.addEventListener("click", () => action(button));
    return button;
  };
  const dialog = make("dialog", { id: "export", ariaLabel: title },
    make("h2", { textContent: title }), area,
    make("p", { className: "buttons" },
      act("Copy", (button) => copy(text, button)),
      act(`Download ${file}`, () => download(file, new Blob([text], { type: "text/plain" }))),
      act("Close", () => dialog.close())));
  dialog.addEventListener("close", () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
}

/** The page's address with the present scene, and without the token of a board's server. */
async function linkOf(store) {
  const link = new URL(location);
  link.searchParams.delete("token");
  link.hash = SCENE_IN_ADDRESS + await packedScene(store.text());
  return link.href;
}

/** The whole scene as a text that can be changed: keys that have no field are here. */
function editWhole(store, engine) {
  const ids = ["whole-scene", "whole", "whole-error"];
  const [details, area, error] = ids.map((id) => document.getElementById(id));
  const complain = (sentence) => {
    error.textContent = sentence;
    area.ariaInvalid = sentence === "" ? null : "true";
  };
  const show = () => {
    if (!details.open || document.activeElement === area) return;
    area.value = asToml(store, engine);
    complain("");
  };
  let pause;
  store.listen(() => {
    clearTimeout(pause);
    pause = setTimeout(show, PAUSE_BEFORE_TEXT);
  });
  details.addEventListener("toggle", show);
  // An invalid text stays until it is valid, or until another scene is chosen.
  area.addEventListener("input", () => {
    const { scene, errors } = engine.json("parse", area.value);
    complain(scene ? "" : errors.map(placed).join("; "));
    if (scene) store.replace(scene);
  });
}
