// What is shown, what is highlighted, and who wants to know.
const { scans, concepts, filtration, labels, counts } = contents;
const hasLabels = labels.length > 0;
const nVertices = filtration.heat.length;
// Of very many scans a sample is here; what is counted are all.
const nShown = scans.names.length;
const nUsed = counts.scans - contents.skipped.length;
const isSample = nShown < nUsed;

const conceptColour = (rank) => (rank < 0 ? NONE_COLOUR : concepts[rank].colour ?? CONCEPT_COLOURS[rank % CONCEPT_COLOURS.length]);
const labelColour = (label) => (label < 0 ? NONE_COLOUR : LABEL_COLOURS[label % LABEL_COLOURS.length]);
const conceptName = (rank) => concepts[rank].name || `concept ${concepts[rank].number}`;
const lifetime = (concept) => (concept.death === null ? 1 : concept.death) - concept.birth;

// Rank of each scan's and each vertex's concept, -1 for none; scans at each vertex.
const rankOfScan = new Int32Array(nShown).fill(-1);
concepts.forEach((concept, rank) => concept.members.forEach((scan) => { rankOfScan[scan] = rank; }));
const rankOfVertex = new Int32Array(nVertices).fill(-1);
const scansAt = Array.from({ length: nVertices }, () => []);
scans.vertices.forEach((vertex, scan) => {
  if (vertex < 0) return;
  scansAt[vertex].push(scan);
  rankOfVertex[vertex] = rankOfScan[scan];
});

// As in time_scale.py: positions on the axis of time, 0 to 1, and back. Nothing has joined at the very begin.
const isOdds = filtration.axisEnds !== null;
const logOdds = (time) => Math.log(time / (1 - time));
const [firstOdds, lastOdds] = isOdds ? filtration.axisEnds.map(logOdds) : [0, 1];
const position = (time) => (!isOdds ? time
  : time <= filtration.axisEnds[0] ? 0 : time >= filtration.axisEnds[1] ? 1 : (logOdds(time) - firstOdds) / (lastOdds - firstOdds));
const timeAt = (at) => (!isOdds ? at : at <= 0 ? 0 : at >= 1 ? 1 : 1 / (1 + Math.exp(-(firstOdds + at * (lastOdds - firstOdds)))));
const shownTime = (time) => (!isOdds || time === 0 || time === 1 ? time.toFixed(2) : time < 0.1 ? time.toPrecision(2) : time > 0.99 ? time.toFixed(4) : time.toFixed(3));

// Round times with room between them, of which there is `room` on the whole axis.
function ticks(room) {
  const candidates = !isOdds ? [0, 1, 0.5, 0.1, 0.2, 0.3, 0.4, 0.6, 0.7, 0.8, 0.9]
    : [0.5, 0.9, 0.1, 0.99, 0.999, 0.01, 0.001, 0.7, 0.3, 0.97, 0.03, 0.95, 0.05, 0.98, 0.02, 0.8, 0.2, 0.6, 0.4, 0.996, 0.005];
  const taken = [];
  for (const time of candidates) {
    if (isOdds && (time < filtration.axisEnds[0] || time > filtration.axisEnds[1])) continue;
    if (taken.every((other) => Math.abs(position(time) - position(other)) >= room)) taken.push(time);
  }
  return taken.map((time) => [time, String(time)]);
}

// Concepts are either taken at the busiest step of time, or groups that significant splits keep apart.
const isBusiest = filtration.stop === "annexations";
const nBetween = filtration.nBetween;
// Time at which each vertex has its first neighbour.
const joinTimes = Float64Array.from(filtration.joins, (time) => time ?? Infinity);
const heatName = filtration.heatKind === "geodesic" ? "heat" : "divergence";

// `marked`: a vertex whose place is looked for.
const state = { hovered: null, selected: null, marked: null, time: isBusiest ? filtration.conceptTime ?? 1 : 1, colouring: "concept" };
const listeners = [];
let isDrawing = false;
function onChange(listener) { listeners.push(listener); }
function change(values) {
  if (Object.keys(values).every((key) => state[key] === values[key])) return;
  Object.assign(state, values);
  if (isDrawing) return;
  isDrawing = true;
  requestAnimationFrame(() => { isDrawing = false; listeners.forEach((listener) => listener()); });
}
// A figure is drawn whenever something changes; one of thousands of dots, which takes its time, only while it is within a
// window's height of sight.
const areThousands = nVertices > 2000;
function drawnInSight(canvas, draw) {
  let isNear = !areThousands;
  const drawIfNear = () => { if (isNear) draw(); };
  onChange(drawIfNear);
  new ResizeObserver(drawIfNear).observe(canvas);
  if (isNear) return;
  new IntersectionObserver((entries) => { isNear = entries.at(-1).isIntersecting; drawIfNear(); }, { rootMargin: "100%" }).observe(canvas);
}
const highlighted = () => state.hovered ?? state.selected;
// A dot or a bar that was clicked: whoever shows its scans listens to this.
function choosePlace(figure, vertex) {
  const rank = rankOfVertex[vertex];
  if (rank < 0) change({ selected: null });
  else toggle(rank);
  figure.dispatchEvent(new CustomEvent("place", { bubbles: true, detail: vertex }));
}
const toggle = (rank) => change({ selected: state.selected === rank ? null : rank });

const shownSize = (scan) => shownSides(scans.sides[scan]);
const sizeLine = (scan) => (scans.sides[scan] === null ? "" : element("span", { className: "size", textContent: shownSize(scan) }));

// Bar of label proportions.
function mixBar(concept) {
  const size = concept.size;
  const unlabelled = size - concept.mix.reduce((sum, [, n]) => sum + n, 0);
  const parts = unlabelled ? [...concept.mix, [-1, unlabelled]] : concept.mix;
  return element("span", { className: "mix" }, ...parts.map(([label, n]) => element("span", {
    title: `${label < 0 ? "no label" : labels[label]}: ${n} of ${size}`,
    style: { "flex-grow": n, background: labelColour(label) },
  })));
}
