// A picture as a PNG: with its title, the scene's name and its legend, on the ground of the theme.

/** Pixels of a PNG to one of the page, whatever the screen has. */
const PNG_SCALE = 2;
/** Height of a line of words. */
const PNG_ROW = 20;

/** Has the browser save a picture. */
async function savePng(picture) {
  const image = await pngOf(picture);
  if (!image) return;
  const link = document.createElement("a");
  link.href = URL.createObjectURL(image);
  const name = String(Picture.scene()).replace(/[^\p{L}\p{N}]+/gu, "-").replace(/^-|-$/g, "").slice(0, 60);
  link.download = `${name || "scene"}-${picture.name}.png`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/** A picture as the bytes of a PNG; nothing where there is no picture yet. */
function pngOf(picture) {
  if (!picture.content) return Promise.resolve(null);
  const legend = picture.content.legend ?? [];
  const [width, drawn] = [Math.max(480, picture.canvas.clientWidth), picture.canvas.clientHeight];
  const canvas = document.createElement("canvas");
  const context = canvas.getContext("2d");
  const words = { left: 54, width: width - 64 };
  // The words are laid out once for their height, and drawn when the canvas has it.
  const write = (top) => {
    let down = top;
    for (const entry of legend) {
      paintSwatch(context, entry, 10, down);
      down += Math.max(PNG_ROW, paragraph(context, entry.words, { ...words, top: down }));
    }
    return down - top;
  };
  const height = PNG_ROW + 12 + drawn + 8 + write(0);
  [canvas.width, canvas.height] = [width * PNG_SCALE, Math.ceil(height * PNG_SCALE)];
  context.scale(PNG_SCALE, PNG_SCALE);
  context.fillStyle = Inks.of("--plot-back");
  context.fillRect(0, 0, width, height);
  paragraph(context, `${Picture.scene()}: ${picture.title}`, { left: 10, top: 8, width: width - 20 });
  context.translate(0, PNG_ROW + 12);
  picture.paint(context, width, drawn);
  write(drawn + 8);
  return new Promise((resolve) => canvas.toBlob(resolve, "image/png"));
}
