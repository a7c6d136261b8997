// The verdict in words, as `haptic certify` says it, and as attributes of the page for programs.

/** Time in ms without a change after which the verdict is read out. */
const PAUSE_BEFORE_SPEECH = 700;

/** Shows a verdict whenever the scene changes. */
function showVerdict(store) {
  const announcement = document.getElementById("verdict-announcement");
  let pause;
  store.listen(({ judged }) => {
    mark(judged.report);
    showWord(judged);
    // While a value is invalid, the last verdict stays.
    if (judged.report) {
      showMargin(judged.report);
      showRows(store, judged);
    }
    for (const id of ["verdict-rows", "margin", "margin-words"]) {
      document.getElementById(id).classList.toggle("stale", judged.report === undefined);
    }
    document.getElementById("verdict-stale").hidden = judged.report !== undefined;
    clearTimeout(pause);
    pause = setTimeout(() => say(announcement, inWords(judged)), PAUSE_BEFORE_SPEECH);
  });
}

/** The verdict for who hears the page. */
function inWords({ report, errors }) {
  return report ? report.message : `not judged: ${errors.map(({ sentence }) => sentence).join("; ")}`;
}

function showWord({ rows, errors }) {
  const wrong = errors?.length === 1 ? "one value is wrong" : `${errors?.length} values are wrong`;
  const words = rows?.find(([label]) => label === "verdict")[1] ?? `NOT JUDGED: ${wrong}`;
  const word = document.getElementById("verdict-word");
  say(word, words);
  // A certified scene that no board renders is rejected, too.
  word.classList.toggle("rejected", words.startsWith("REJECTED"));
}

/** The margin as a bar from the middle on: full to the right where all of the device's passivity is left,
 * full to the left where as much again is lacking. */
function showMargin({ margin, delta }) {
  const [bar, fill] = [document.getElementById("margin"), document.getElementById("margin-fill")];
  const isKnown = typeof margin === "number" && delta > 0;
  const part = isKnown ? Math.max(-1, Math.min(1, margin / delta)) : 0;
  fill.style.left = `${50 + 50 * Math.min(part, 0)}%`;
  fill.style.width = `${50 * Math.abs(part)}%`;
  fill.classList.toggle("negative", part < 0);
  const digits = (number) => Number(number.toPrecision(4));
  const sense = part < 0 ? "lacks" : "to spare";
  const words = isKnown
    ? `${sense} ${digits(Math.abs(margin))} of ${digits(delta)} N m s/rad`
    : "no margin";
  say(document.getElementById("margin-words"), words);
  bar.ariaLabel = `margin: ${words}`;
}

/** Shows the rows; what stays the same stays the same element, so that it keeps the focus. */
function showRows(store, { rows, remedies }) {
  const list = document.getElementById("verdict-rows");
  while (list.children.length > 2 * rows.length) list.lastChild.remove();
  while (list.children.length < 2 * rows.length) list.append(make("dt"), make("dd"));
  let label = "";
  rows.forEach(([name, value], index) => {
    label = name || label;
    const [term, words] = [list.children[2 * index], list.children[2 * index + 1]];
    say(term, name);
    term.className = name === "WARNING" ? "warning" : "";
    const isApplicable = ({ sentence, changes }) => sentence === value && changes.length > 0;
    const remedy = label === "remedies" && remedies.find(isApplicable);
    if (remedy) showRemedy(store, words, remedy);
    else say(words, value);
    if (!remedy && words.firstElementChild) words.textContent = value;
  });
}

/** A remedy is a button that applies it. */
function showRemedy(store, words, { sentence, changes }) {
  let button = words.firstElementChild;
  if (!button) {
    button = make("button", { type: "button", title: "Apply this remedy" });
    words.replaceChildren(button);
  }
  say(button, sentence);
  button.onclick = () => {
    for (const [path, value] of changes) store.set(path, value ?? undefined);
  };
}

/** Numbers as the shortest decimal that is the double. */
function mark(report) {
  const marks = report === undefined ? {} : {
    verdict: report.verdict,
    alphaLo: report.alpha.lo,
    alphaHi: report.alpha.hi,
    delta: report.delta,
    margin: report.margin,
  };
  for (const name of ["verdict", "alphaLo", "alphaHi", "delta", "margin"]) {
    const value = marks[name];
    if (value === undefined || value === null) delete document.documentElement.dataset[name];
    else document.documentElement.dataset[name] = String(value);
  }
}
