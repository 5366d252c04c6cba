// Draws scans as discs on a plain canvas: no WebGL, so as many at a time as fit the screen, on any machine.
const N_SHADES = 20;
let shades = [], NO_SEGMENT = 0;
// From dark to bright, of each segment's colour; the last is that of what is in none.
function useSegmentColours(colours) {
  NO_SEGMENT = colours.length - 1;
  shades = colours.map((colour) => {
    const channels = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
    return Array.from({ length: N_SHADES }, (_, i) => {
      const light = i / (N_SHADES - 1);
      const lit = channels.map((c) => (light < 0.75
        ? c * (0.5 + 0.5 * (light / 0.75))
        : c + (255 - c) * 0.4 * ((light - 0.75) / 0.25)));
      return `rgb(${lit.map(Math.round).join(",")})`;
    });
  });
}

// The surface elements of a preview: six bytes each, as `ScanPreview.to_bytes` writes them.
function decodedElements(bytes, extent, elementSpacing) {
  const n = bytes.length / 6;
  const positions = new Float32Array(3 * n), normals = new Float32Array(3 * n), colours = new Uint8Array(n), sizes = new Float32Array(n);
  let farthest = 1e-6;
  for (let i = 0; i < n; i++) {
    for (let axis = 0; axis < 3; axis++) positions[3 * i + axis] = bytes[6 * i + axis] / 127.5 - 1;
    const x = bytes[6 * i + 3] / 127.5 - 1, y = bytes[6 * i + 4] / 127.5 - 1;
    normals.set([x, y, Math.sqrt(Math.max(0, 1 - x * x - y * y))], 3 * i);
    colours[i] = Math.min(bytes[6 * i + 5] & 15, NO_SEGMENT);
    sizes[i] = 0.45 + 0.55 * (bytes[6 * i + 5] >> 4) / 15;
    farthest = Math.max(farthest, Math.hypot(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]));
  }
  const spacing = extent > 0 ? 2 * elementSpacing / extent : 1;
  return { n, positions, normals, colours, sizes, farthest: farthest + spacing / 2, radius: 0.72 * spacing };
}
const bytesOf = (base64) => Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));

// `lit`: the colours that are shown, where the others are grey; null for all.
function drawElements(context, width, height, elements, yaw, pitch, lit = null) {
  const { n, positions, normals, colours, sizes, farthest, radius } = elements;
  const scale = 0.47 * Math.min(width, height) / farthest;
  const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
  // Across, up and towards the eye.
  const turned = (v) => {
    const made = new Float32Array(3 * n);
    for (let i = 0; i < 3 * n; i += 3) {
      const z = cy * v[i + 2] - sy * v[i];
      made[i] = cy * v[i] + sy * v[i + 2];
      made[i + 1] = cp * v[i + 1] - sp * z;
      made[i + 2] = sp * v[i + 1] + cp * z;
    }
    return made;
  };
  const at = turned(positions), facing = turned(normals);
  for (const i of Uint16Array.from({ length: n }, (_, k) => k).sort((a, b) => at[3 * a + 2] - at[3 * b + 2])) {
    const [nx, ny, nz] = [facing[3 * i], facing[3 * i + 1], facing[3 * i + 2]];
    // Light from above left, on both sides of the surface; what is far is a little darker.
    const light = 0.88 * Math.abs(-0.35 * nx + 0.5 * ny + 0.79 * nz) + 0.12 * (0.5 + at[3 * i + 2] / (2 * farthest));
    const colour = lit === null || lit.has(colours[i]) ? colours[i] : NO_SEGMENT;
    context.fillStyle = shades[colour][Math.max(0, Math.min(N_SHADES - 1, Math.round(light * (N_SHADES - 1))))];
    context.beginPath();
    const r = Math.max(radius * sizes[i] * scale, 1);
    context.ellipse(width / 2 + at[3 * i] * scale, height / 2 - at[3 * i + 1] * scale, r * Math.max(Math.abs(nz), 0.3), r,
      Math.atan2(-ny, nx), 0, 2 * Math.PI);
    context.fill();
  }
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
