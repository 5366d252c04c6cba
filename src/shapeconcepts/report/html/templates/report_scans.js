// The scans of the report, which came with it.
useSegmentColours(contents.segmentColours);
const decoded = new Map();
function scanElements(scan) {
  if (!decoded.has(scan)) decoded.set(scan, decodedElements(bytesOf(scans.previews[scan]), scans.extents[scan], scans.spacings[scan]));
  return decoded.get(scan);
}
function drawScan(canvas, scan, yaw, pitch) {
  const width = canvas.clientWidth, height = canvas.clientHeight;
  drawElements(sharpContext(canvas, width, height), width, height, scanElements(scan), yaw, pitch);
}

// Only what is near the window holds pixels.
const nearWindow = new IntersectionObserver((entries) => {
  for (const { target, isIntersecting } of entries) {
    target.isNear = isIntersecting;
    if (isIntersecting) target.redraw();
    else target.width = target.height = 0;
  }
}, { rootMargin: "300px" });

// A canvas on which a scan can be turned; a click without a drag calls `open`.
function scanCanvas(scan, open) {
  const canvas = element("canvas", { className: "scan" });
  if (scans.previews[scan] === null) return canvas;
  canvas.isNear = false;
  canvas.yaw = canvas.pitch = 0;
  canvas.redraw = () => { if (canvas.isNear) drawScan(canvas, scan, canvas.yaw, canvas.pitch); };
  turnable(canvas, open);
  nearWindow.observe(canvas);
  return canvas;
}
