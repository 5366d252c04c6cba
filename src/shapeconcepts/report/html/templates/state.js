// What is shown, what is highlighted, and who wants to know.
const contents = JSON.parse(document.getElementById("contents").textContent);
const { scans, concepts, filtration, labels, counts } = contents;
const hasLabels = labels.length > 0;
const nVertices = filtration.heat.length;
// Of very many scans a sample is here; what is counted are all.
const nShown = scans.names.length;
const nUsed = counts.scans - contents.skipped.length;
const isSample = nShown < nUsed;

// Categorical colours that colour-blind readers tell apart too (P. Tol's "muted"; Okabe and Ito's, and what lies
// farthest from those in CIELAB under normal and simulated red- and green-blind vision).
// Numbers say what colours cannot where there are more concepts than colours.
const CONCEPT_COLOURS = ["#332288", "#cc6677", "#117733", "#ddaa33", "#88ccee", "#882255", "#44aa99", "#999933", "#aa4499", "#3f78c9"];
const LABEL_COLOURS = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#554400", "#bbcc66",
  "#ee1155", "#112299", "#ffbb99", "#990088", "#662222", "#88ccb0", "#7700cc", "#7f8794",
  "#660044", "#aa66ff", "#99ddee", "#0000ff", "#dddd55", "#884466", "#007733", "#ff2244"];
const NONE_COLOUR = "#b9bcc4", INK = "#1d2433", FAINT = "#d9dade", ACCENT = "#c2410c";
const conceptColour = (rank) => (rank < 0 ? NONE_COLOUR : CONCEPT_COLOURS[rank % CONCEPT_COLOURS.length]);
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

const state = { hovered: null, selected: null, time: isBusiest ? filtration.conceptTime ?? 1 : 1, colouring: "concept" };
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
const toggle = (rank) => change({ selected: state.selected === rank ? null : rank });

// Text is only ever set as text: names come from files.
function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name === "style") for (const [key, v] of Object.entries(value)) made.style.setProperty(key, v);
    else if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (name in made && name !== "list") made[name] = value;
    else made.setAttribute(name, value);
  }
  made.append(...children.filter((child) => child !== null && child !== undefined && child !== ""));
  return made;
}
const named = (text, className = "") => element("bdi", { className, textContent: text, title: text });
// A name on one line, whose middle is left out where it is too long: folders differ at the begin and files at the end.
const oneLine = (text) => {
  const made = named(text, "one-line");
  placesOfNames.observe(made);
  return made;
};
const ruler = document.createElement("canvas").getContext("2d");
const placesOfNames = new ResizeObserver((places) => {
  for (const { target, contentRect } of places) {
    ruler.font = getComputedStyle(target).font;
    const fits = (most) => ruler.measureText(shortened(target.title, most)).width <= contentRect.width + 0.5;
    let [least, most] = [1, target.title.length];
    if (fits(most)) least = most;
    while (least < most) {
      const middle = (least + most + 1) >> 1;
      if (fits(middle)) least = middle; else most = middle - 1;
    }
    target.textContent = shortened(target.title, least);
  }
});
function shortened(text, most) {
  // Accents, which a Mac writes apart, stay with their letters. In little room the end has more: "031.npy" says which.
  const letters = text.match(/.\p{M}*/gsu) ?? [], nLast = Math.max((most - 1) >> 1, Math.min(8, most - 4));
  return letters.length <= most ? text
    : `${letters.slice(0, most - 1 - nLast).join("")}…${letters.slice(letters.length - nLast).join("")}`;
}
// Made once: `toLocaleString` makes one for each number, which takes seconds for thousands of scans.
const [WHOLE, ONE_DIGIT, UP_TO_TWO_DIGITS] = [[0, 0], [1, 1], [0, 2]].map(([least, most]) =>
  new Intl.NumberFormat("en", { minimumFractionDigits: least, maximumFractionDigits: most }));
// The unit is that of the longest side: a file in millimetres that was read as metres is seen at once.
function shownSize(scan) {
  const sides = scans.sides[scan];
  if (sides === null) return "";
  const [unit, metres] = sides[0] < 0.01 ? ["mm", 0.001] : sides[0] < 1 ? ["cm", 0.01] : ["m", 1];
  const number = (side) => {
    const value = side / metres;
    return (value < 0.95 ? UP_TO_TWO_DIGITS : value < 9.95 ? ONE_DIGIT : WHOLE).format(value);
  };
  return `${sides.map(number).join(" × ")}\u00a0${unit}`;
}
const sizeLine = (scan) => (scans.sides[scan] === null ? "" : element("span", { className: "size", textContent: shownSize(scan) }));
const plural = (n, one, many = one + "s") => `${WHOLE.format(n)} ${n === 1 ? one : many}`;
const percent = (share) => `${Math.round(100 * share)} %`;

// A canvas as sharp as the screen; returns its context in CSS pixels.
function sharpContext(canvas, width, height) {
  const ratio = Math.min(window.devicePixelRatio || 1, 2);
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return context;
}

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
