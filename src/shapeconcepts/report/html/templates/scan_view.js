// Draws scans as discs on a plain canvas: no WebGL, so as many at a time as fit the screen, on any machine.
const N_SHADES = 20;
const shades = contents.segmentColours.map((colour) => {
  const channels = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
  return Array.from({ length: N_SHADES }, (_, i) => {
    const light = i / (N_SHADES - 1);
    const lit = channels.map((c) => (light < 0.75
      ? c * (0.5 + 0.5 * (light / 0.75))
      : c + (255 - c) * 0.4 * ((light - 0.75) / 0.25)));
    return `rgb(${lit.map(Math.round).join(",")})`;
  });
});
const NO_SEGMENT = contents.segmentColours.length - 1;

const decoded = new Map();
function scanElements(scan) {
  if (decoded.has(scan)) return decoded.get(scan);
  const text = atob(scans.previews[scan]);
  const n = text.length / 6;
  const positions = new Float32Array(3 * n), normals = new Float32Array(3 * n), colours = new Uint8Array(n), sizes = new Float32Array(n);
  let farthest = 1e-6;
  for (let i = 0; i < n; i++) {
    for (let axis = 0; axis < 3; axis++) positions[3 * i + axis] = text.charCodeAt(6 * i + axis) / 127.5 - 1;
    const x = text.charCodeAt(6 * i + 3) / 127.5 - 1, y = text.charCodeAt(6 * i + 4) / 127.5 - 1;
    normals.set([x, y, Math.sqrt(Math.max(0, 1 - x * x - y * y))], 3 * i);
    colours[i] = Math.min(text.charCodeAt(6 * i + 5) & 15, NO_SEGMENT);
    sizes[i] = 0.45 + 0.55 * (text.charCodeAt(6 * i + 5) >> 4) / 15;
    farthest = Math.max(farthest, Math.hypot(...positions.subarray(3 * i, 3 * i + 3)));
  }
  const spacing = scans.extents[scan] > 0 ? 2 * scans.spacings[scan] / scans.extents[scan] : 1;
  const made = { n, positions, normals, colours, sizes, farthest: farthest + spacing / 2, radius: 0.72 * spacing };
  decoded.set(scan, made);
  return made;
}

function drawScan(canvas, scan, yaw, pitch) {
  const width = canvas.clientWidth, height = canvas.clientHeight;
  const context = sharpContext(canvas, width, height);
  const { n, positions, normals, colours, sizes, farthest, radius } = scanElements(scan);
  const scale = 0.47 * Math.min(width, height) / farthest;
  const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
  const turn = (v, i) => {
    const x = cy * v[i] + sy * v[i + 2], z = cy * v[i + 2] - sy * v[i];
    return [x, cp * v[i + 1] - sp * z, sp * v[i + 1] + cp * z];
  };
  const turned = Array.from({ length: n }, (_, i) => turn(positions, 3 * i));
  const order = Array.from({ length: n }, (_, i) => i).sort((a, b) => turned[a][2] - turned[b][2]);
  for (const i of order) {
    const [x, y, z] = turned[i];
    const [nx, ny, nz] = turn(normals, 3 * i);
    // Light from above left, on both sides of the surface; what is far is a little darker.
    const facing = Math.abs(-0.35 * nx + 0.5 * ny + 0.79 * nz);
    const light = 0.88 * facing + 0.12 * (0.5 + z / (2 * farthest));
    context.fillStyle = shades[colours[i]][Math.max(0, Math.min(N_SHADES - 1, Math.round(light * (N_SHADES - 1))))];
    context.beginPath();
    const r = Math.max(radius * sizes[i] * scale, 1);
    context.ellipse(width / 2 + x * scale, height / 2 - y * scale, r * Math.max(Math.abs(nz), 0.3), r,
      Math.atan2(-ny, nx), 0, 2 * Math.PI);
    context.fill();
  }
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

function turnable(canvas, open) {
  let last = null, moved = 0;
  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    last = [event.clientX, event.clientY];
    moved = 0;
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (last === null) return;
    const [dx, dy] = [event.clientX - last[0], event.clientY - last[1]];
    last = [event.clientX, event.clientY];
    moved += Math.abs(dx) + Math.abs(dy);
    turnBy(canvas, dx, dy);
  });
  canvas.addEventListener("pointerup", () => {
    if (last !== null && moved < 5 && open) open();
    last = null;
  });
  canvas.addEventListener("pointercancel", () => { last = null; });
}

function turnBy(canvas, dx, dy) {
  const perPixel = 3 / Math.max(canvas.clientWidth, 120);
  canvas.yaw += dx * perPixel;
  canvas.pitch = Math.max(-1.5, Math.min(1.5, canvas.pitch + dy * perPixel));
  requestAnimationFrame(canvas.redraw);
}
