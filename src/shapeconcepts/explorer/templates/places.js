// What the gallery may show. The address says which, so that the browser's "back" works.
const ORDERS = [["typical", "most typical first"], ["doubtful", "most doubtful first"], ["name", "by name"], ["size", "largest first"]];
let order = "typical";

// Scans in an order; what is not known comes last.
function ordered(rows, by = order) {
  const value = {
    typical: (row) => (byKey.get(conceptOf(row))?.medoid === row ? -Infinity : doubtOf(row) ?? Infinity),
    doubtful: (row) => -(doubtOf(row) ?? -Infinity),
    size: (row) => -(sidesOf(row)?.[0] ?? -Infinity),
  }[by];
  if (by === "name") return [...rows].sort((a, b) => (lowered[a] < lowered[b] ? -1 : lowered[a] > lowered[b] ? 1 : a - b));
  const values = new Map(rows.map((row) => [row, value(row)]));
  return [...rows].sort((a, b) => values.get(a) - values.get(b) || a - b);
}

// Members in order, until something changes: the slider comes by here many times a second.
const memberOrders = new Map();
onCurrent(() => memberOrders.clear());
function orderedMembers(key) {
  const name = `${order} ${key}`;
  if (order === "size") return ordered(membersOf(key));
  if (!memberOrders.has(name)) memberOrders.set(name, ordered(membersOf(key)));
  return memberOrders.get(name);
}
const conceptSection = (key) => ({ key, heading: nameOfKey(key), rows: orderedMembers(key), link: `#concept/${key}` });

// Scans below a branch of the tree of concepts.
function rowsOfBranch(branch) {
  const isInside = known.tree.map((_, group) => group === branch);
  for (let group = branch - 1; group >= 0; group--) isInside[group] ||= isInside[known.tree[group].parent] ?? false;
  return known.treeGroupOfScan.flatMap((group, row) => (group >= 0 && isInside[group] ? [row] : []));
}

// Names and paths that have all the words, in any order; the names of concepts count, too.
function found(text) {
  const words = text.toLowerCase().split(/\s+/).filter(Boolean);
  const ofConcept = new Map([...byKey.keys()].map((key) => [key, nameOfKey(key).toLowerCase()]));
  ofConcept.set(-1, "");
  return lowered.flatMap((name, row) => (words.every((word) => name.includes(word) || (ofConcept.get(conceptOf(row)) ?? "").includes(word)) ? [row] : []));
}

const LISTS = {
  uncertain: { title: "Uncertain", note: "another concept is not much farther than their own", rows: () => ordered(uncertain(), "doubtful") },
  none: { title: "In no concept", note: "rare here, in between, or seen badly", rows: () => ordered(withoutConcept()) },
  foreign: { title: "Foreign", note: "marked as belonging to nothing here", rows: () => ordered([...foreign]) },
  all: { title: "All scans", note: "", rows: () => ordered(known.scans.names.map((_, row) => row)) },
};

// Title, and the sections of an address; null where there is nothing (any more).
function placeAt(address) {
  const [kind, ...rest] = address.replace(/^#/, "").split("/");
  const argument = rest.join("/");
  if (kind === "concept" && byKey.has(Number(argument))) {
    const key = Number(argument);
    return { kind, key, title: nameOfKey(key), sections: [{ ...conceptSection(key), heading: null }] };
  }
  if (kind in LISTS) return { kind, title: LISTS[kind].title, note: LISTS[kind].note, isMixed: true, sections: [{ heading: null, rows: LISTS[kind].rows() }] };
  if (kind === "search") {
    const text = decodeURIComponent(argument);
    return { kind, text, title: `Found for “${text}”`, isMixed: true, sections: [{ heading: null, rows: found(text) }] };
  }
  if (kind === "branch" && known.tree[Number(argument)]) {
    return { kind, branch: Number(argument), title: "A branch of the tree", isMixed: true, sections: [{ heading: null, rows: ordered(rowsOfBranch(Number(argument))) }] };
  }
  if (kind === "question" && current.question !== null) return placeOfQuestion();
  return { kind: "overview", title: "All concepts", sections: current.concepts.map((concept) => ({ ...conceptSection(concept.key), isOneLine: true })) };
}

let place = null;
// A preview of another granularity is at no address.
let passing = null;
onOtherScans(() => { passing = null; });
const placeFollowers = [];
function onPlace(follower) { placeFollowers.push(follower); }
function showPlace() {
  place = passing ?? placeAt(location.hash);
  for (const follower of placeFollowers) follower();
}
function go(address) {
  passing = null;
  if (location.hash === address) showPlace();
  else location.hash = address;
}
function pass(through) {
  passing = through;
  showPlace();
}
