// Annexation curve and barcode over one axis of time, with a cursor that can be pulled.
const LEFT = 44, RIGHT = 22, CURVE = 130, GAP = 46, AXIS = 38;
// Where each row of the barcode begins, as a share of its height. Of many, the last are given more room: those that outlive
// the others are what one looks for.
const isCrowded = nVertices > 120;
const rowTop = (row) => (isCrowded ? 1 - Math.sqrt(1 - row / nVertices) : row / nVertices);
const rowAt = (share) => Math.floor((isCrowded ? 1 - (1 - share) ** 2 : share) * nVertices);
const barHeight = () => Math.max(120, Math.min(380, nVertices * 6));

// Death of the class of each vertex; those that are left never die.
const deaths = new Float64Array(nVertices).fill(Infinity);
filtration.annexations.forEach(([dying], i) => { deaths[dying] = filtration.times[i]; });
const byDeath = Array.from({ length: nVertices }, (_, i) => i).sort((a, b) => deaths[a] - deaths[b] || a - b);
const rowOf = new Int32Array(nVertices);
byDeath.forEach((vertex, row) => { rowOf[vertex] = row; });

function timelineFigure() {
  const canvas = element("canvas", { className: "timeline", role: "img",
    ariaLabel: `Annexations over time, and barcode of ${nVertices} classes` });
  canvas.style.height = `${CURVE + GAP + barHeight() + AXIS}px`;
  drawnInSight(canvas, () => drawTimeline(canvas));
  const pulledTo = (event) => timeAt(Math.max(0, Math.min(1, (event.offsetX - LEFT) / (canvas.clientWidth - LEFT - RIGHT))));
  const barAt = (event) => {
    const share = (event.offsetY - CURVE - GAP) / barHeight();
    return share >= 0 && share < 1 ? byDeath[rowAt(share)] : null;
  };
  // A bar that is pressed and let go of is chosen; pulled aside, it is the time that is pulled.
  let isPulling = false, pressed = null;
  const pull = (event) => { isPulling = true; pressed = null; change({ time: pulledTo(event), hovered: null }); showTip(null); };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    const vertex = barAt(event);
    if (vertex === null) pull(event); else pressed = { vertex, x: event.offsetX };
  });
  canvas.addEventListener("pointermove", (event) => {
    if (isPulling || (pressed !== null && Math.abs(event.offsetX - pressed.x) > 4)) { pull(event); return; }
    const vertex = barAt(event);
    if (vertex === null) showTip(null);
    else {
      const died = Number.isFinite(deaths[vertex]) ? `annexed at ${shownTime(deaths[vertex])}` : "never annexed";
      showTip(scansAt[vertex][0], event.clientX, event.clientY, died);
    }
    change({ hovered: vertex === null || rankOfVertex[vertex] < 0 ? null : rankOfVertex[vertex] });
  });
  const release = () => { isPulling = false; pressed = null; };
  canvas.addEventListener("pointerup", () => { if (pressed !== null) choosePlace(canvas, pressed.vertex); release(); });
  canvas.addEventListener("pointercancel", release);
  canvas.addEventListener("pointerleave", () => { showTip(null); change({ hovered: null }); });
  return element("figure", {}, element("h3", { textContent: "Annexations over time, and the barcode" }), canvas,
    element("figcaption", { textContent:
      `Above: how many classes are annexed in each step of time. ${stopText()}`
      + `Below, one bar for each scan${isSample ? " shown" : ""} (persistent homology calls it the barcode of H₀): it lasts until its class is `
      + "annexed by a larger one" + (isBusiest ? ". Long bars are groups that hold their own." : "; those with an arrow are the concepts.")
      + (isCrowded ? " Their rows widen downwards, for those that last." : "")
      + (isOdds ? " Time is the mean divergence of two groups that join, from 0, the same, to 1, nothing in common; its axis is that of odds." : "") }));
}

// What makes the concepts.
function stopText() {
  const time = filtration.conceptTime;
  if (isBusiest) {
    return time === null ? "" : `The concepts are taken at ε_max = ${shownTime(time)}, the busiest step of all `
      + "those that leave at least two concepts and none with more than half of the scans. ";
  }
  return "Two groups are two concepts if there is a gap between them that chance does not explain, and their scans have "
    + `on average less than ${(100 * filtration.granularity).toFixed(0)} % in common; `
    + (nBetween ? `${plural(nBetween, "annexation")} ${nBetween === 1 ? "is" : "are"} between such groups (the marks on the line). ` : "no annexation is between such groups. ");
}

function drawTimeline(canvas) {
  const width = canvas.clientWidth, height = canvas.clientHeight;
  if (!width) return;
  const context = sharpContext(canvas, width, height);
  const x = (time) => LEFT + position(time) * (width - LEFT - RIGHT);
  const top = CURVE + GAP;
  context.font = "11px system-ui, sans-serif";
  context.textBaseline = "middle";
  drawCurve(context, x);
  drawBars(context, x, top, barHeight());
  context.fillStyle = theme.quiet;
  context.textAlign = "center";
  for (const [time, text] of ticks(44 / (width - LEFT - RIGHT))) {
    context.fillText(text, x(time), top + barHeight() + 14);
    context.fillRect(Math.round(x(time)), top + barHeight() + 2, 1, 4);
  }
  context.fillText(isOdds ? "time (mean divergence)" : "time", (LEFT + width - RIGHT) / 2, top + barHeight() + 29);
  context.textAlign = "right";
  let free = 0;
  for (const left of [nVertices, ...[1000, 500, 200, 100, 50, 20, 10, 5].filter((n) => n < nVertices)]) {
    const y = top + rowTop(nVertices - left) * barHeight();
    if (y < free || y > top + barHeight() - 10) continue;
    context.fillText(WHOLE.format(left), LEFT - 6, y + 4);
    free = y + 18;
  }
  context.textAlign = "center";
  context.save();
  context.translate(8, top + barHeight() / 2);
  context.rotate(-Math.PI / 2);
  context.fillText(isSample ? "classes left of those shown" : "classes left", 0, 0);
  context.restore();
  drawCursor(context, x, top);
}

function drawCurve(context, x) {
  const most = filtration.stepCounts.reduce((m, n) => Math.max(m, n), 1);
  const y = (count) => CURVE - count / most * (CURVE - 26);
  filtration.stepEnds.forEach((end, i) => {
    const start = i === 0 ? 0 : filtration.stepEnds[i - 1];
    const isPeak = isBusiest && filtration.conceptTime !== null && Math.abs(end - filtration.conceptTime) < 1e-9;
    context.fillStyle = isPeak ? theme.accent : start < state.time - 1e-9 ? theme.past : theme.future;
    const left = x(start), right = x(end);
    context.fillRect(left, y(filtration.stepCounts[i]), Math.max(right - left - (right - left > 4 ? 1 : 0), 0.7), CURVE - y(filtration.stepCounts[i]));
  });
  context.strokeStyle = theme.future;
  context.lineWidth = 1;
  context.beginPath();
  context.moveTo(x(0), CURVE + 0.5);
  context.lineTo(x(1), CURVE + 0.5);
  context.stroke();
  context.fillStyle = theme.accent;
  for (const time of filtration.timesBetween) {
    context.beginPath();
    context.moveTo(x(time), CURVE - 1);
    context.lineTo(x(time) - 4, CURVE + 7);
    context.lineTo(x(time) + 4, CURVE + 7);
    context.fill();
  }
  context.fillStyle = theme.quiet;
  context.textAlign = "right";
  context.fillText(most < 1e5 ? WHOLE.format(most) : `${WHOLE.format(most / 1000)} k`, LEFT - 6, y(most));
  context.fillText("0", LEFT - 6, CURVE);
}

function drawBars(context, x, top, height) {
  const chosen = highlighted();
  const bar = (vertex, thinnest) => {
    const isLeft = !Number.isFinite(deaths[vertex]), end = isLeft ? x(1) : x(deaths[vertex]);
    const [from, to] = [rowTop(rowOf[vertex]), rowTop(rowOf[vertex] + 1)];
    const pitch = height * (to - from);
    const thick = Math.max(Math.min(pitch * (pitch > 3 ? 0.72 : 1), 7), thinnest);
    const middle = top + height * (from + to) / 2;
    context.fillRect(x(0), middle - thick / 2, end - x(0), thick);
    if (!isLeft) return;
    const wide = Math.max(2.5, Math.min(5, pitch / 2));
    context.beginPath();
    context.moveTo(end + 10, middle);
    context.lineTo(end, middle - wide);
    context.lineTo(end, middle + wide);
    context.fill();
  };
  context.globalAlpha = chosen === null ? 0.9 : 0.18;
  for (const vertex of byDeath) {
    context.fillStyle = vertexColour(vertex);
    bar(vertex, 0.35);
  }
  context.globalAlpha = 1;
  for (const vertex of chosen === null ? [] : byDeath) {
    if (rankOfVertex[vertex] !== chosen) continue;
    context.fillStyle = vertexColour(vertex);
    bar(vertex, 1.6);
  }
  if (state.marked === null) return;
  context.fillStyle = theme.accent;
  bar(state.marked, 3);
}

function drawCursor(context, x, top) {
  const line = (time, dashes, thick, note) => {
    context.setLineDash(dashes);
    context.strokeStyle = context.fillStyle = theme.accent;
    context.lineWidth = thick;
    context.beginPath();
    context.moveTo(x(time), 14);
    context.lineTo(x(time), top + barHeight());
    context.stroke();
    context.setLineDash([]);
    context.font = "600 12px system-ui, sans-serif";
    context.textAlign = position(time) > 0.85 ? "right" : "left";
    context.fillText(note, x(time) + (position(time) > 0.85 ? -4 : 4), 8);
  };
  const chosen = filtration.conceptTime;
  if (isBusiest && chosen !== null) line(chosen, [5, 4], 1.2, `ε_max ${shownTime(chosen)}`);
  if (!isBusiest || state.time !== chosen) {
    const isNear = isBusiest && chosen !== null && Math.abs(position(chosen) - position(state.time)) < 0.1;
    line(state.time, [], 2, isNear ? "" : shownTime(state.time));
  }
  context.beginPath();
  context.arc(x(state.time), CURVE + GAP / 2, 7, 0, 2 * Math.PI);
  context.fillStyle = theme.accent;
  context.fill();
}
