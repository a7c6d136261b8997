// What all parts of the page do with its elements.

/** A new element with attributes or properties, and children. */
function make(name, properties = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key in element) element[key] = value;
    else element.setAttribute(key, value);
  }
  element.append(...children);
  return element;
}

/** Changes the text of an element where it is another one: what stays is not read out again. */
function say(element, words) {
  if (element.textContent !== words) element.textContent = words;
}

/** Shows a sentence at the top of the page; none: takes it away. */
function notice(sentence) {
  const element = document.getElementById("notice");
  element.textContent = sentence;
  element.hidden = sentence === "";
}

/** Copies a text, and says so on the button. */
async function copy(text, button) {
  const words = button.dataset.words ??= button.textContent;
  try {
    await navigator.clipboard.writeText(text);
    button.textContent = "Copied";
  } catch (error) {
    notice(`The clipboard cannot be written to: ${error.message}`);
  }
  setTimeout(() => { button.textContent = words; }, 1500);
}

/** Has the browser keep a file. */
function download(name, blob) {
  const address = URL.createObjectURL(blob);
  make("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}
