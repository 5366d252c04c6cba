// Annexation curve and barcode over one axis of time, with a cursor that can be pulled.
const LEFT = 44, RIGHT = 14, CURVE = 130, GAP = 46, AXIS = 34;
const barHeight = () => Math.max(120, Math.min(380, nVertices * 6));

// Death of the class of each vertex; the one that is left never dies.
const deaths = new Float64Array(nVertices).fill(Infinity);
filtration.annexations.forEach(([dying], i) => { deaths[dying] = filtration.times[i]; });
const byDeath = Array.from({ length: nVertices }, (_, i) => i).sort((a, b) => deaths[a] - deaths[b] || a - b);
const rowOf = new Int32Array(nVertices);
byDeath.forEach((vertex, row) => { rowOf[vertex] = row; });

function timelineFigure() {
  const canvas = element("canvas", { className: "timeline", role: "img",
    ariaLabel: `Annexations over time, and barcode of ${nVertices} classes` });
  canvas.style.height = `${CURVE + GAP + barHeight() + AXIS}px`;
  const draw = () => drawTimeline(canvas);
  onChange(draw);
  new ResizeObserver(draw).observe(canvas);
  const timeAt = (event) => Math.max(0, Math.min(1, (event.offsetX - LEFT) / (canvas.clientWidth - LEFT - RIGHT)));
  const barAt = (event) => {
    const row = Math.floor((event.offsetY - CURVE - GAP) / barHeight() * nVertices);
    return row >= 0 && row < nVertices ? byDeath[row] : null;
  };
  let isPulling = false;
  canvas.addEventListener("pointerdown", (event) => {
    isPulling = true;
    canvas.setPointerCapture(event.pointerId);
    change({ time: timeAt(event), hovered: null });
    showTip(null);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (isPulling) { change({ time: timeAt(event) }); return; }
    const vertex = barAt(event);
    if (vertex === null) showTip(null);
    else {
      const died = Number.isFinite(deaths[vertex]) ? `annexed at ${deaths[vertex].toFixed(2)}` : "outlives all";
      showTip(scansAt[vertex][0], event.clientX, event.clientY, died);
    }
    change({ hovered: vertex === null || rankOfVertex[vertex] < 0 ? null : rankOfVertex[vertex] });
  });
  const release = () => { isPulling = false; };
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("pointercancel", release);
  canvas.addEventListener("pointerleave", () => { showTip(null); change({ hovered: null }); });
  const epsilon = filtration.conceptTime;
  return element("figure", {}, element("h3", { textContent: "Annexations over time, and the barcode" }), canvas,
    element("figcaption", { textContent:
      "Above: how many classes are annexed in each step of time. "
      + (epsilon === null ? "" : `The concepts are taken at ε_max = ${epsilon.toFixed(2)}, the busiest step of all `
        + "those that leave at least two concepts and none with more than half of the scans. ")
      + "Below, one bar for each scan (persistent homology calls it the barcode of H₀): it lasts until its class is "
      + "annexed by a larger one. Long bars are groups that hold their own." }));
}

function drawTimeline(canvas) {
  const width = canvas.clientWidth, height = canvas.clientHeight;
  if (!width) return;
  const context = sharpContext(canvas, width, height);
  const x = (time) => LEFT + time * (width - LEFT - RIGHT);
  const top = CURVE + GAP;
  context.font = "11px system-ui, sans-serif";
  context.textBaseline = "middle";
  drawCurve(context, x, width);
  drawBars(context, x, top, barHeight(), width);
  context.fillStyle = "#5b6070";
  context.textAlign = "center";
  for (let tenth = 0; tenth <= 10; tenth += width < 500 ? 5 : 1) {
    context.fillText((tenth / 10).toFixed(1), x(tenth / 10), top + barHeight() + 12);
  }
  context.fillText("time", x(0.5), top + barHeight() + 26);
  context.save();
  context.translate(10, top + barHeight() / 2);
  context.rotate(-Math.PI / 2);
  context.fillText(plural(nVertices, "class", "classes"), 0, 0);
  context.restore();
  drawCursor(context, x, top);
}

function drawCurve(context, x) {
  const most = filtration.stepCounts.reduce((m, n) => Math.max(m, n), 1);
  const y = (count) => CURVE - count / most * (CURVE - 26);
  const step = 1 / filtration.stepEnds.length;
  const epsilon = filtration.conceptTime;
  filtration.stepEnds.forEach((end, i) => {
    const isPeak = epsilon !== null && Math.abs(end - epsilon) < 1e-9;
    context.fillStyle = isPeak ? ACCENT : end - step < state.time - 1e-9 ? "#7d8db0" : "#d3d7e0";
    const left = x(end - step), right = x(end);
    context.fillRect(left, y(filtration.stepCounts[i]), Math.max(right - left - (right - left > 4 ? 1 : 0), 0.7), CURVE - y(filtration.stepCounts[i]));
  });
  context.strokeStyle = "#c9cbd1";
  context.lineWidth = 1;
  context.beginPath();
  context.moveTo(x(0), CURVE + 0.5);
  context.lineTo(x(1), CURVE + 0.5);
  context.stroke();
  context.fillStyle = "#5b6070";
  context.textAlign = "right";
  context.fillText(most, LEFT - 6, y(most));
  context.fillText("0", LEFT - 6, CURVE);
}

function drawBars(context, x, top, height, width) {
  const chosen = highlighted();
  const pitch = height / nVertices;
  const thickness = Math.max(pitch * (pitch > 3 ? 0.72 : 1), 0.35);
  const bar = (vertex, thick) => {
    const end = Number.isFinite(deaths[vertex]) ? x(deaths[vertex]) : width;
    context.fillRect(x(0), top + (rowOf[vertex] + 0.5) * pitch - thick / 2, end - x(0), thick);
  };
  context.globalAlpha = chosen === null ? 0.9 : 0.18;
  for (const vertex of byDeath) {
    context.fillStyle = vertexColour(vertex);
    bar(vertex, thickness);
  }
  context.globalAlpha = 1;
  if (chosen === null) return;
  for (const vertex of byDeath) {
    if (rankOfVertex[vertex] !== chosen) continue;
    context.fillStyle = vertexColour(vertex);
    bar(vertex, Math.max(thickness, 1.6));
  }
}

function drawCursor(context, x, top) {
  const line = (time, dashes, thick, note) => {
    context.setLineDash(dashes);
    context.strokeStyle = context.fillStyle = ACCENT;
    context.lineWidth = thick;
    context.beginPath();
    context.moveTo(x(time), 14);
    context.lineTo(x(time), top + barHeight());
    context.stroke();
    context.setLineDash([]);
    context.font = "600 12px system-ui, sans-serif";
    context.textAlign = time > 0.85 ? "right" : "left";
    context.fillText(note, x(time) + (time > 0.85 ? -4 : 4), 8);
  };
  const epsilon = filtration.conceptTime;
  const isThere = epsilon !== null && Math.abs(state.time - epsilon) < 1e-9;
  if (epsilon !== null) line(epsilon, [5, 4], 1.2, `ε_max ${epsilon.toFixed(2)}`);
  if (!isThere) line(state.time, [], 2, epsilon !== null && Math.abs(epsilon - state.time) < 0.1 ? "" : state.time.toFixed(2));
  context.beginPath();
  context.arc(x(state.time), CURVE + GAP / 2, 7, 0, 2 * Math.PI);
  context.fillStyle = ACCENT;
  context.fill();
}
