// What the page knows of the model: `known` until its file changes, `current` until the next edit.
let known = null, current = null;
const byKey = new Map();
let membersByKey = new Map(), foreign = new Set(), positionOf = new Map(), lowered = [], isSkipped = new Set();

// `listeners` of the report's figures are their own.
const followers = [];
function onCurrent(follower) { followers.push(follower); }

// Whoever keeps something of rows, for when these are other scans.
const forgetters = [];
function onOtherScans(forgetter) { forgetters.push(forgetter); }

function takeModel(document) {
  const before = known?.scans.names ?? [];
  known = document;
  if (before.some((name, row) => name !== known.scans.names[row])) for (const forget of forgetters) forget();
  lowered = known.scans.names.map((name) => name.toLowerCase());
  isSkipped = new Set(known.scans.skipped);
  useSegmentColours(known.segmentColours);
}

function takeState(document) {
  // An answer that was overtaken by a later one tells nothing new.
  if (current !== null && document.version < current.version) return;
  current = document;
  byKey.clear();
  positionOf = new Map();
  membersByKey = new Map();
  current.concepts.forEach((concept, position) => {
    byKey.set(concept.key, concept);
    positionOf.set(concept.key, position);
    membersByKey.set(concept.key, []);
  });
  current.conceptOfScan.forEach((key, row) => membersByKey.get(key)?.push(row));
  foreign = new Set(current.foreign);
  for (const follower of followers) follower();
}

const nScans = () => known.scans.names.length;
const nameOfScan = (row) => known.scans.names[row];
const nameOfKey = (key) => (key < 0 ? "no concept" : byKey.get(key)?.name || `concept ${key}`);
const conceptOf = (row) => current.conceptOfScan[row];
const membersOf = (key) => membersByKey.get(key) ?? [];
const doubtOf = (row) => current.doubts?.[row] ?? null;
// Another concept is nearer than its own.
const isDoubtful = (row) => conceptOf(row) >= 0 && (doubtOf(row) ?? 0) > 0.5;
const withoutConcept = () => known.scans.names.map((_, row) => row)
  .filter((row) => conceptOf(row) < 0 && !foreign.has(row) && !isSkipped.has(row));
const uncertain = () => known.scans.names.map((_, row) => row).filter((row) => conceptOf(row) >= 0 && (doubtOf(row) ?? 0) >= current.doubtfulFrom);
const unfit = () => current.journal.filter((edit) => edit.unfit);

// On dark paper, dark colours are too dark.
const CONCEPT_COLOURS_ON_DARK = ["#8f83dd", "#dd8a97", "#4fb370", "#ddaa33", "#88ccee", "#cf6ea0", "#44aa99", "#b5b54d", "#cf7fcc", "#6d9ae0"];
const isDark = matchMedia("(prefers-color-scheme: dark)");
const colourOfKey = (key) => (key < 0 ? NONE_COLOUR : (isDark.matches ? CONCEPT_COLOURS_ON_DARK : CONCEPT_COLOURS)[key % CONCEPT_COLOURS.length]);
