// Starts the page.

async function main() {
  const parts = ["module", "worker"].map((id) => unpacked(document.getElementById(id)));
  const [bytes, worker] = await Promise.all(parts);
  const module = await WebAssembly.compile(bytes);
  const engine = await Engine.start(module);
  const start = JSON.parse(document.getElementById("start").textContent);
  const store = new Store(engine, await sceneOfAddress(engine) ?? start.scene);
  const table = engine.json("keys");
  window.haptic = forPrograms(engine, store);
  showVerdict(store);
  showHandle(engine, store, table.hosts);
  showPictures(engine, store, module, worker);
  showBoard(engine, store);
  store.judge();
  new Fields(store, table).show();
  showActions(store, engine, table);
  linkScene(store, engine);
}

/** What other programs call. */
function forPrograms(engine, store) {
  return {
    /** The scene that is shown, as text. */
    scene: () => store.text(),
    /** The output of `haptic certify --json` for a scene, which is a text or an object: an object whose
     * text is the printed text, to the last digit. */
    certify: (scene) => {
      const printed = engine.ask("certify", typeof scene === "string" ? scene : JSON.stringify(scene));
      return Object.defineProperty(JSON.parse(printed), "toString", { value: () => printed });
    },
  };
}

main();
