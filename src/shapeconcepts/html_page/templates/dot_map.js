// A graph whose vertices are places of the topological space: the spanning tree, and F.
const COLD = [38, 70, 140], MILD = [190, 176, 160], HOT = [236, 112, 20];
function heatColour(heat) {
  const [from, to, share] = heat < 0.5 ? [COLD, MILD, 2 * heat] : [MILD, HOT, 2 * heat - 1];
  return `rgb(${from.map((c, i) => Math.round(c + (to[i] - c) * share)).join(",")})`;
}
function vertexColour(vertex) {
  if (state.colouring === "heat") return heatColour(filtration.heat[vertex]);
  if (state.colouring === "label") return labelColour(scans.labels[scansAt[vertex][0]]);
  return conceptColour(rankOfVertex[vertex]);
}
const vertexNote = (vertex) => {
  const others = filtration.equal[vertex] - 1, all = filtration.standsFor[vertex];
  const heat = filtration.heatKind === "geodesic" ? `heat ${filtration.heat[vertex].toFixed(2)}`
    : Number.isFinite(joinTimes[vertex]) ? `joins another at ${shownTime(joinTimes[vertex])}` : "alone";
  return heat + (others ? ` · ${plural(others, "equal scan")} here too` : "")
    + (isSample && all > others + 1 ? ` · stands for ${plural(all, "scan")}` : "");
};

// Edges within a concept: a broad stroke along them shows it as a region.
function stroke(context, pairs, at) {
  context.beginPath();
  for (const [a, b] of pairs) { context.moveTo(...at(a)); context.lineTo(...at(b)); }
  context.stroke();
}

class DotMap {
  // walls: pairs that never join; place: size of the canvas -> function from a vertex to its place; backdrop: drawn first.
  constructor(canvas, { pairs, walls = [], place, backdrop }) {
    Object.assign(this, { canvas, pairs, walls, place, backdrop });
    this.regions = concepts.map(() => []);
    for (const [a, b] of pairs) {
      if (rankOfVertex[a] >= 0 && rankOfVertex[a] === rankOfVertex[b]) this.regions[rankOfVertex[a]].push([a, b]);
    }
    canvas.addEventListener("pointermove", (event) => this.point(event));
    canvas.addEventListener("pointerleave", () => { showTip(null); change({ hovered: null }); });
    canvas.addEventListener("click", (event) => {
      const vertex = this.point(event);
      if (vertex === null) change({ selected: null });
      else choosePlace(canvas, vertex);
      // A finger does not hover.
      if (event.pointerType !== "mouse") change({ hovered: null });
    });
    drawnInSight(canvas, () => this.draw());
  }

  point(event) {
    const vertex = this.nearest(event.offsetX, event.offsetY);
    if (vertex === null) showTip(null);
    else showTip(scansAt[vertex][0], event.clientX, event.clientY, vertexNote(vertex));
    this.canvas.style.cursor = vertex === null ? "" : "pointer";
    change({ hovered: vertex === null || rankOfVertex[vertex] < 0 ? null : rankOfVertex[vertex] });
    return vertex;
  }

  nearest(x, y) {
    let best = null, reach = 16 ** 2;
    for (let vertex = 0; vertex < nVertices; vertex++) {
      const [vx, vy] = this.at(vertex);
      const square = (vx - x) ** 2 + (vy - y) ** 2;
      if (square < reach) { best = vertex; reach = square; }
    }
    return best;
  }

  draw() {
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    if (!width || !height) return;
    const context = sharpContext(this.canvas, width, height);
    this.at = this.place(width, height);
    const chosen = highlighted();
    const dot = Math.max(2.1, Math.min(6, 70 / Math.sqrt(nVertices))) * (width < 500 ? 0.75 : 1);
    context.lineCap = context.lineJoin = "round";
    this.backdrop?.(context, width, height);
    this.drawRegions(context, chosen, dot);
    const nJoined = filtration.times.filter((time) => time <= state.time).length;
    // Of thousands, fans of lines would be solid walls.
    context.globalAlpha = areThousands ? 1000 / nVertices : 1;
    context.lineWidth = 1;
    context.strokeStyle = theme.faint;
    stroke(context, this.pairs.slice(nJoined), this.at);
    context.lineWidth = dot > 4.5 ? 1.6 : 0.8;
    context.strokeStyle = chosen !== null ? theme.future : dot > 4.5 ? theme.joined : theme.joined;
    stroke(context, this.pairs.slice(0, nJoined), this.at);
    context.globalAlpha = 1;
    this.drawDots(context, chosen, dot);
    this.drawWalls(context, dot);
    this.drawNumbers(context, chosen);
  }

  drawRegions(context, chosen, dot) {
    this.regions.forEach((pairs, rank) => {
      context.globalAlpha = chosen === null ? 0.2 : chosen === rank ? 0.45 : 0.06;
      context.lineWidth = 5.2 * dot;
      context.strokeStyle = conceptColour(rank);
      stroke(context, pairs, this.at);
    });
    context.globalAlpha = 1;
  }

  drawDots(context, chosen, dot) {
    for (let vertex = 0; vertex < nVertices; vertex++) {
      const isChosen = chosen !== null && rankOfVertex[vertex] === chosen;
      const radius = dot * Math.sqrt(Math.min(filtration.equal[vertex], 25)) * (isChosen ? 1.25 : 1);
      context.globalAlpha = chosen === null || isChosen ? 1 : 0.28;
      context.beginPath();
      context.arc(...this.at(vertex), radius, 0, 2 * Math.PI);
      context.fillStyle = vertexColour(vertex);
      context.fill();
      context.lineWidth = isChosen ? 1.2 : 0.7;
      context.strokeStyle = isChosen ? theme.ink : theme.card;
      context.stroke();
    }
    context.globalAlpha = 1;
    if (state.marked === null) return;
    context.beginPath();
    context.arc(...this.at(state.marked), 2.4 * dot + 3, 0, 2 * Math.PI);
    context.lineWidth = 3;
    context.strokeStyle = theme.accent;
    context.stroke();
  }

  // A bar across each line that never joins.
  drawWalls(context, dot) {
    context.lineWidth = 2;
    context.strokeStyle = theme.accent;
    context.beginPath();
    for (const [a, b] of this.walls) {
      const [[ax, ay], [bx, by]] = [this.at(a), this.at(b)];
      const reach = 2.4 * dot / Math.max(Math.hypot(bx - ax, by - ay), 1e-9);
      const [dx, dy] = [(ay - by) * reach, (bx - ax) * reach];
      context.moveTo((ax + bx) / 2 - dx, (ay + by) / 2 - dy);
      context.lineTo((ax + bx) / 2 + dx, (ay + by) / 2 + dy);
    }
    context.stroke();
  }

  drawNumbers(context, chosen) {
    context.font = "600 12px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    const taken = [];
    concepts.forEach((concept, rank) => {
      if (chosen !== null && chosen !== rank) return;
      const [x, y] = this.at(scans.vertices[concept.members[0]]);
      // The better rank has the room.
      if (taken.some(([tx, ty]) => Math.abs(tx - x) < 18 && Math.abs(ty - y) < 13)) return;
      taken.push([x, y]);
      context.lineWidth = 4;
      context.strokeStyle = theme.card;
      context.strokeText(concept.number, x, y - 12);
      context.fillStyle = theme.ink;
      context.fillText(concept.number, x, y - 12);
    });
  }
}
