// Previews of scans: asked for in batches, drawn a few a frame, kept as small pictures. What scrolled away is neither.
const BATCH = 32, MOST_RECORDS = 8000, MOST_PIXELS = 8_000_000, FRAME = 8;
const records = new Map(), pictures = new Map(), waiting = new Map(), batches = new Set();
let nPixels = 0, isPumping = false, fetchTimer = null;

// Kept in the order of their last use.
function used(map, key) {
  const value = map.get(key);
  if (value !== undefined) { map.delete(key); map.set(key, value); }
  return value;
}

onOtherScans(() => {
  for (const batch of batches) batch.abort.abort();
  records.clear();
  pictures.clear();
  waiting.clear();
  nPixels = 0;
});

const sidesOf = (row) => records.get(row)?.sides ?? null;

// Draws a scan's preview on a canvas, now or when it is there; `then` is called with whether there is one.
function showPreview(canvas, row, side, then) {
  const ratio = Math.min(window.devicePixelRatio || 1, 2), pixels = Math.round(side * ratio);
  const picture = used(pictures, `${row} ${pixels}`);
  if (picture !== undefined) { waiting.delete(canvas); copyPicture(canvas, picture, row, then); return; }
  if (canvas.width !== pixels) canvas.width = canvas.height = pixels;
  canvas.getContext("2d").clearRect(0, 0, pixels, pixels);
  waiting.set(canvas, { row, pixels, then });
  pump();
}
const forgetPreview = (canvas) => { waiting.delete(canvas); };

function copyPicture(canvas, picture, row, then) {
  const context = canvas.getContext("2d");
  if (canvas.width !== picture.width) canvas.width = canvas.height = picture.width;
  else context.clearRect(0, 0, picture.width, picture.width);
  context.drawImage(picture, 0, 0);
  then?.(true, row);
}

function drawnPicture(row, pixels, record) {
  const picture = document.createElement("canvas");
  picture.width = picture.height = pixels;
  drawElements(picture.getContext("2d"), pixels, pixels, decodedElements(record.bytes, record.extent, record.spacing), 0, 0);
  pictures.set(`${row} ${pixels}`, picture);
  nPixels += pixels * pixels;
  for (const [key, old] of pictures) {
    if (nPixels <= MOST_PIXELS) break;
    pictures.delete(key);
    nPixels -= old.width * old.height;
    old.width = old.height = 0;
  }
  return picture;
}

function pump() {
  if (isPumping) return;
  isPumping = true;
  requestAnimationFrame(() => {
    isPumping = false;
    const start = performance.now();
    let areUnknown = false;
    for (const [canvas, { row, pixels, then }] of waiting) {
      const record = used(records, row);
      if (record === undefined) { areUnknown = true; continue; }
      if (performance.now() - start > FRAME) { pump(); break; }
      waiting.delete(canvas);
      if (record === null) then?.(false, row);
      else copyPicture(canvas, used(pictures, `${row} ${pixels}`) ?? drawnPicture(row, pixels, record), row, then);
    }
    // While it scrolls fast, most tiles are gone before it would be worth asking.
    if (areUnknown && fetchTimer === null) fetchTimer = setTimeout(() => { fetchTimer = null; fetchWanted(); }, 40);
  });
}

function fetchWanted() {
  const wanted = new Set([...waiting.values()].map(({ row }) => row).filter((row) => !records.has(row)));
  for (const batch of batches) {
    if (!batch.rows.some((row) => wanted.has(row))) batch.abort.abort();
    batch.rows.forEach((row) => wanted.delete(row));
  }
  // The latest are those in sight.
  const rows = [...wanted].reverse();
  while (rows.length && batches.size < 2) fetchBatch(rows.splice(0, BATCH));
}

// The first ones of an installation wait until kernels are compiled.
const LONG = 4000;
const drawing = element("p", { id: "drawing", role: "status", hidden: true, textContent: "drawing … the first time, kernels are compiled, which takes up to a minute" });
document.body.append(drawing);

async function fetchBatch(rows) {
  const batch = { rows, abort: new AbortController() };
  batches.add(batch);
  const late = setTimeout(() => { drawing.hidden = false; }, LONG);
  try {
    const answer = await asked(`previews?rows=${rows.join(",")}`, { signal: batch.abort.signal });
    const made = await answer.arrayBuffer();
    if (!batch.abort.signal.aborted) takePreviews(made);
  } catch (failure) {
    if (failure instanceof Refusal && failure.status !== 503 && !batch.abort.signal.aborted) rows.forEach((row) => records.set(row, null));
    else if (failure.name !== "AbortError") await pause(500);
  } finally {
    clearTimeout(late);
    batches.delete(batch);
    drawing.hidden = batches.size === 0 || drawing.hidden;
    pump();
  }
}

function takePreviews(buffer) {
  const view = new DataView(buffer);
  for (let at = 0; at < buffer.byteLength;) {
    const row = view.getUint32(at, true), n = view.getUint16(at + 4, true);
    const [extent, spacing, ...sides] = [8, 12, 16, 20, 24].map((offset) => view.getFloat32(at + offset, true));
    records.set(row, n === 0 ? null : { bytes: new Uint8Array(buffer.slice(at + 28, at + 28 + 6 * n)), extent, spacing, sides });
    at += 28 + 6 * n;
  }
  for (const row of records.keys()) {
    if (records.size <= MOST_RECORDS) break;
    records.delete(row);
  }
}
