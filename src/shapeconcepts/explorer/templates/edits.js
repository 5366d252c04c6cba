// Edits: what is said to the model. One after the other, so that an undo undoes what was seen.
let isBehind = Promise.resolve();

function edit(document) {
  let before = 0;
  const done = isBehind.then(() => { before = current.nEdits; return posted("edit", document); }).then((state) => {
    takeState(state);
    const made = state.journal.at(-1), isStep = document.kind === "undo" || document.kind === "redo";
    if (isStep) say(document.kind === "undo" ? "Undone." : "Done again.");
    else if (made !== undefined && state.nEdits !== before) say(made.text, true);
    return state;
  });
  isBehind = done.catch(() => {});
  return done;
}

// An edit from outside of a dialog: a refusal is said.
const tried = (document) => edit(document).catch((failure) => { refused(failure.message); return null; });

const trouble = document.getElementById("trouble");
let troubleTimer = null;
function refused(text) {
  clearTimeout(troubleTimer);
  trouble.hidden = false;
  trouble.replaceChildren(element("bdi", { textContent: text }),
    element("button", { type: "button", textContent: "×", ariaLabel: "Close", onclick: () => { trouble.hidden = true; } }));
  troubleTimer = setTimeout(() => { trouble.hidden = true; }, 12000);
}

function nameDialog(key) {
  const concept = byKey.get(key);
  const input = element("input", { type: "text", value: concept.name, autocomplete: "off", maxLength: 200, required: true });
  input.dataset.first = "";
  const submit = submitButton("Name it");
  const twin = () => current.concepts.find((other) => other.key !== key && other.name && other.name === input.value.trim());
  const update = () => { submit.textContent = twin() ? `Merge with “${twin().name}”` : "Name it"; };
  input.addEventListener("input", update);
  openDialog(`What is ${nameOfKey(key)}?`, dialogForm(() => (twin() ? edit({ kind: "merge", keys: [twin().key, key], name: twin().name })
    : edit({ kind: "rename", key, name: input.value.trim() })), submit,
  field("Name", input), suggestedNames(key, (name) => { input.value = name; update(); input.focus(); })));
  input.select();
}

// What it may be called: its shape in words, and the commonest labels that came with its scans.
function namesFor(key) {
  const counts = new Map();
  for (const row of membersOf(key)) {
    const label = known.scans.labels[row];
    if (label >= 0) counts.set(label, (counts.get(label) ?? 0) + 1);
  }
  const labels = [...counts].sort((a, b) => b[1] - a[1]).slice(0, 2).map(([label]) => known.labelNames[label]);
  return [...new Set([byKey.get(key).suggested, ...labels].filter(Boolean))];
}
function suggestedNames(key, take) {
  const names = namesFor(key);
  return names.length ? element("p", { className: "suggestions" }, element("span", { className: "quiet", textContent: "Suggested:" }),
    ...names.map((name) => element("button", { type: "button", onclick: () => take(name) }, named(name)))) : "";
}

function mergeDialog(key) {
  const picker = conceptPicker("With which concept", (text) => conceptsLike(text, [key]));
  openDialog(`Merge ${nameOfKey(key)}`, dialogForm(async () => {
    const other = picker.taken();
    if (other === null) return false;
    await edit({ kind: "merge", keys: [key, other.key], name: byKey.get(key).name || byKey.get(other.key).name });
    go(`#concept/${byKey.has(key) ? key : other.key}`);
    return true;
  }, submitButton("Merge"), picker.node));
}

function moveDialog(rows, after = () => {}) {
  const keys = new Set(rows.map(conceptOf));
  const picker = conceptPicker("To which concept", (text) => [
    ...conceptsLike(text, keys.size === 1 ? [...keys] : []),
    ...(text && current.concepts.some(({ name }) => name === text) ? [] : [{ key: null, name: text, label: text ? `a new concept “${text}”` : "a new concept", note: "" }])]);
  openDialog(`Move ${plural(rows.length, "scan")}`, dialogForm(async () => {
    const { key, name = "" } = picker.taken();
    await edit(key === null ? { kind: "move", scans: rows, key: null, name } : { kind: "move", scans: rows, key });
    after();
    return true;
  }, submitButton("Move"), picker.node));
}

function splitDialog(key, rows) {
  const along = element("input", { type: "radio", name: "how", value: "tree", checked: true });
  const these = element("input", { type: "radio", name: "how", value: "scans" });
  const few = rows.length > 0 && rows.length < membersOf(key).length;
  if (few) these.checked = true;
  openDialog(`Split ${nameOfKey(key)}`, dialogForm(() => edit({ kind: "split", key, scans: few && these.checked ? rows : null }), submitButton("Split"),
    element("label", { className: "choice" }, along, "where the tree of concepts splits it next"),
    element("label", { className: "choice" }, Object.assign(these, { disabled: !few }), few ? `the ${plural(rows.length, "chosen scan")} apart from the others` : "the chosen scans (none are chosen here)")));
}

function propagateDialog() {
  const rate = element("input", { type: "number", min: 0.1, max: 50, step: "any", value: 5 });
  openDialog("Spread the names", dialogForm(() => edit({ kind: "propagate", rate: Number(rate.value) / 100 }), submitButton("Spread"),
    element("p", { textContent: "Scans in no concept join the named one that they fit, by the calibrated p-values. What is doubtful stays and is asked for." }),
    field("Of 100 that fit, at most so many are left out", rate)));
}
