// Finds the parts of the page that a reader could not read, and writes them into the page.
window.addEventListener("load", () => {
  const found = [];
  const width = document.documentElement.clientWidth;
  const name = element => `${element.tagName} "${(element.textContent || "").slice(0, 40)}"`;
  const beyond = (box, frame) =>
    box.left < frame.left - 1 || box.right > frame.right + 1 ||
    box.top < frame.top - 1 || box.bottom > frame.bottom + 1;
  for (const element of document.body.querySelectorAll("*:not(svg *)")) {
    const box = element.getBoundingClientRect();
    if (box.left < -1 || box.right > width + 1) found.push(`off the page: ${name(element)}`);
    if (element.scrollWidth > element.clientWidth + 1 && element.clientWidth > 0)
      found.push(`wider than its box: ${name(element)}`);
  }
  for (const picture of document.querySelectorAll("svg")) {
    const frame = picture.getBoundingClientRect();
    const texts = [...picture.querySelectorAll("text")];
    const boxes = texts.map(text => text.getBoundingClientRect());
    if (texts.length < 8) found.push(`a picture with ${texts.length} texts`);
    texts.forEach((text, i) => {
      if (beyond(boxes[i], frame)) found.push(`cut off: ${name(text)}`);
      for (let j = 0; j < i; j++) {
        const [a, b] = [boxes[i], boxes[j]];
        // Boxes of lines are higher than their letters.
        const slack = 0.25 * Math.min(a.height, b.height);
        const wide = Math.min(a.right, b.right) - Math.max(a.left, b.left);
        const high = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
        if (wide > 1 && high > slack) found.push(`overlap: ${name(text)} and ${name(texts[j])}`);
      }
    });
  }
  for (const entry of performance.getEntriesByType("resource")) found.push(`fetched: ${entry.name}`);
  const report = {
    found,
    texts: Object.fromEntries(["verdict", "numbers", "assumptions", "remedies", "nyquist", "map", "motion"]
      .map(id => [id, document.getElementById(id)?.innerText ?? null])),
    pictures: document.querySelectorAll("figure svg").length,
    title: document.title,
  };
  const place = document.createElement("pre");
  place.id = "measured";
  place.textContent = btoa(unescape(encodeURIComponent(JSON.stringify(report))));
  document.body.append(place);
});
