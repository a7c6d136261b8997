// Unpacks the page's program, which is as readable in its package, and starts it.

/** The bytes that a script element of the page holds: compressed, and as letters, two for 13 bits. */
async function unpacked(element) {
  const text = element.textContent.trim();
  // `<` is not one of the letters.
  const digit = (code) => (code < 60 ? code - 33 : code - 34);
  const isOdd = text.length % 2;
  const packed = new Uint8Array(Math.floor((13 * (text.length - isOdd) / 2 + 6 * isOdd) / 8));
  let [held, bits, count] = [0, 0, 0];
  for (let at = 0; at < text.length; at += 2) {
    const high = at + 1 < text.length ? digit(text.charCodeAt(at + 1)) : 0;
    held |= (digit(text.charCodeAt(at)) + 93 * high) << bits;
    for (bits += 13; bits >= 8; bits -= 8) {
      // Bits beyond the last byte are left out.
      packed[count] = held;
      count += 1;
      held >>= 8;
    }
  }
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

unpacked(document.getElementById("program")).then((program) =>
  import(URL.createObjectURL(new Blob([program], { type: "text/javascript" }))));
