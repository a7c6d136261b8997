// Unpacks the page's program, which is as readable in its package, and starts it.

/** The bytes that a script element of the page holds: compressed, in base64. */
async function unpacked(element) {
  const packed = Uint8Array.from(atob(element.textContent.trim()), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

unpacked(document.getElementById("program")).then((program) =>
  import(URL.createObjectURL(new Blob([program], { type: "text/javascript" }))));
