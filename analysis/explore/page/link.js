// The address holds the scene, so that a link is a design: `#scene=` and the scene as JSON, either as it is
// (with the escapes of an address) or deflated, in base64 with the letters of an address.

/** What a link's scene begins with. */
const SCENE_IN_ADDRESS = "#scene=";
/** Longest scene in characters that is read out of a link: as long as the program reads a scene file. */
const LONGEST_SCENE = 4 << 20;
/** Longest address in characters: browsers and messengers cut off longer ones. */
const LONGEST_ADDRESS = 60_000;
/** Time in ms without a change after which the address follows: browsers refuse too many changes. */
const PAUSE_BEFORE_ADDRESS = 400;

/** A scene as letters of an address. */
async function packedScene(text) {
  const stream = new Blob([text]).stream().pipeThrough(new CompressionStream("deflate-raw"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  let letters = "";
  for (const byte of bytes) letters += String.fromCharCode(byte);
  return btoa(letters).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

/** The text of a scene in such letters. Throws their fault as a sentence. */
async function unpackedScene(letters) {
  if (letters.length > LONGEST_SCENE) throw new Error(`it is longer than ${LONGEST_SCENE} characters`);
  return /^(%7B|\{)/i.test(letters) ? decodeURIComponent(letters) : inflated(letters);
}

async function inflated(letters) {
  if (!/^[\w-]+$/.test(letters)) throw new Error("it has other characters than letters, digits, - and _");
  const base64 = letters.replaceAll("-", "+").replaceAll("_", "/");
  const packed = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  const reader = stream.pipeThrough(new TextDecoderStream("utf-8", { fatal: true })).getReader();
  // A few letters may stand for any number of characters.
  for (let text = ""; ;) {
    const { done, value } = await reader.read();
    if (done) return text;
    text += value;
    if (text.length > LONGEST_SCENE) throw new Error(`it is longer than ${LONGEST_SCENE} characters`);
  }
}

/** The scene of the page's address; undefined where it has none, or a bad one, which is named. */
async function sceneOfAddress(engine) {
  if (!location.hash.startsWith(SCENE_IN_ADDRESS)) return undefined;
  try {
    const text = await unpackedScene(location.hash.slice(SCENE_IN_ADDRESS.length));
    const { scene, errors } = engine.json("parse", text);
    if (!scene) throw new Error(errors.map(({ sentence }) => sentence).join("; "));
    notice("");
    return scene;
  } catch (error) {
    const why = (error.message || "it is cut off or changed").replace(/\.$/, "");
    notice(`The scene of this link cannot be read: ${why}. The page shows the scene that it had before.`);
    return undefined;
  }
}

/** Lets the address follow the scene, and the scene the address. */
function linkScene(store, engine) {
  let shown = store.text();
  let pause;
  store.listen(() => {
    clearTimeout(pause);
    pause = setTimeout(async () => {
      const text = store.text();
      if (text === shown) return;
      shown = text;
      const address = SCENE_IN_ADDRESS + await packedScene(text);
      const isShort = address.length <= LONGEST_ADDRESS;
      document.getElementById("copy-link").disabled = !isShort;
      try {
        // An address that is too long would be cut off; that of another scene would be wrong.
        history.replaceState(null, "", isShort ? address : location.pathname + location.search);
      } catch {
        // A page within another one may not change its address.
      }
    }, PAUSE_BEFORE_ADDRESS);
  });
  addEventListener("hashchange", async () => {
    const scene = await sceneOfAddress(engine);
    if (scene === undefined) return;
    store.replace(scene);
    shown = store.text();
  });
}
