// All that can be done, by button and by key.
const chosenRows = () => (gallery.chosen().length ? gallery.chosen() : gallery.active() !== null ? [gallery.active()] : []);
const conceptHere = () => place.key ?? (gallery.active() === null ? -1 : conceptOf(gallery.active()));
const hasConcept = () => byKey.has(conceptHere());
const hasRows = () => chosenRows().length > 0;

async function linkChosen(together) {
  const [first, ...others] = chosenRows();
  for (const other of others) if (await tried({ kind: "link", scans: [first, other], together }) === null) return;
}

const ACTIONS = [
  { id: "name", key: "n", text: "Name", what: "Name the concept", on: "concept", can: hasConcept,
    run: () => { if (document.getElementById("answer")) document.getElementById("answer").focus(); else nameDialog(conceptHere()); } },
  { id: "merge", key: "m", text: "Merge", what: "Merge the concept with another", on: "concept", can: () => hasConcept() && current.concepts.length > 1, run: () => mergeDialog(conceptHere()) },
  { id: "split", key: "s", text: "Split", what: "Split the concept along the tree, or the chosen scans off", on: "concept", can: hasConcept,
    run: () => splitDialog(conceptHere(), gallery.chosen().filter((row) => conceptOf(row) === conceptHere())) },
  { id: "move", key: "v", text: "Move", what: "Move the chosen scans to another concept, or a new one", on: "scans", can: hasRows, run: () => moveDialog(chosenRows(), () => gallery.focus()) },
  { id: "foreign", key: "x", text: "Foreign", what: "Mark the chosen scans as foreign", on: "scans", can: hasRows, run: () => tried({ kind: "foreign", scans: chosenRows() }) },
  { id: "confirm", key: "c", text: "Right here", what: "Confirm that the chosen scans are where they belong", on: "scans", can: hasRows, run: () => tried({ kind: "confirm", scans: chosenRows() }) },
  { id: "together", key: "t", text: "Together", what: "The chosen scans belong together", on: "scans", can: () => gallery.chosen().length > 1, run: () => linkChosen(true), isRare: true },
  { id: "apart", key: "a", text: "Apart", what: "The two chosen scans do not belong together", on: "scans", can: () => gallery.chosen().length === 2, run: () => linkChosen(false), isRare: true },
  { id: "question", key: "q", text: "Next question", what: "What the page asks for next", on: "page", can: () => true, run: () => { openView("scans"); nextQuestion(); } },
  { id: "propagate", key: "p", text: "Spread names", what: "Spread the names to scans in no concept", on: "page", can: () => true, run: propagateDialog },
  { id: "undo", key: "Ctrl-Z", text: "Undo", what: "Undo the last edit", on: "page", can: () => current.canUndo, run: () => tried({ kind: "undo" }) },
  { id: "redo", key: "Ctrl-Shift-Z", text: "Redo", what: "Do it again", on: "page", can: () => current.canRedo, run: () => tried({ kind: "redo" }) },
  { id: "export", key: "e", text: "Export", what: "Write the corrected data set, or its report", on: "page", can: () => true, run: () => exportDialog() },
  { id: "search", key: "/", text: "Search", what: "Search names, paths and concepts", on: "page", can: () => true, run: () => document.getElementById("search").focus() },
  { id: "figures", key: "f", text: "Figures", what: "The scan or concept in the figures, and back to the scans", on: "page", can: () => true, run: () => (openedView() === "figures" ? openView("scans") : showInFigures(gallery.active(), conceptHere())) },
  { id: "journal", key: "j", text: "Journal", what: "All edits, and back to the scans", on: "page", can: () => true, run: () => openView(openedView() === "journal" ? "scans" : "journal") },
  { id: "help", key: "?", text: "Help", what: "This list", on: "page", can: () => true, run: () => helpDialog() },
];
const actionOf = new Map(ACTIONS.map((action) => [action.id, action]));

function actionButton(id) {
  const { key, text, what, can, run } = actionOf.get(id);
  return element("button", { type: "button", id: `do-${id}`, title: what, disabled: !can(), onclick: run }, `${text} `, element("kbd", { textContent: key.toUpperCase() }));
}

let areKeysOn = true;
document.addEventListener("keydown", (event) => {
  if (current === null || dialog.open) return;
  // A moment after a dialog has closed, the keyboard may still be in it.
  const isTyping = !dialog.contains(event.target) && event.target.matches("input:not([type=range], [type=radio], [type=checkbox]), select, textarea");
  const command = event.ctrlKey || event.metaKey;
  if (command && event.key.toLowerCase() === "z" && !isTyping) run(event, actionOf.get(event.shiftKey ? "redo" : "undo"));
  else if (command && event.key.toLowerCase() === "y" && !isTyping) run(event, actionOf.get("redo"));
  else if (command || event.altKey || isTyping) return;
  else if (event.key === "Escape") escape();
  else if (event.key === "Enter" && place.isChoosing && !event.target.closest("button, a")) { event.preventDefault(); confirmRest(); }
  else if (event.key === "Enter" && event.target === gallery.list) { event.preventDefault(); openScanSheet(); document.querySelector("#right canvas")?.focus(); }
  else if (areKeysOn) run(event, ACTIONS.find(({ key }) => key === event.key.toLowerCase()));
});
function run(event, action) {
  if (!action) return;
  event.preventDefault();
  if (action.can()) action.run();
}

// Escape goes back by one step.
function escape() {
  if (closeSheets()) return;
  if (openedView() !== "scans") openView("scans");
  else if (passing !== null) { passing = null; showPlace(); }
  else if (gallery.chosen().length) gallery.clear();
  else if (place.kind !== "overview") go("#");
  gallery.focus();
}

function helpDialog() {
  const row = (keys, what) => element("tr", {}, element("th", { scope: "row" }, ...keys.map((key) => element("kbd", { textContent: key }))), element("td", { textContent: what }));
  openDialog("By keyboard", element("label", { className: "choice" }, element("input", { type: "checkbox", checked: areKeysOn, onchange: (event) => { areKeysOn = event.target.checked; } }), "single letters are commands"),
  element("table", { className: "help" },
    ...ACTIONS.map(({ key, what }) => row([key.length === 1 ? key.toUpperCase() : key], what)),
    row(["← ↑ → ↓"], "Walk through the gallery; in a scan, turn it"),
    row(["Space"], "Choose one more scan, or let go of it"),
    row(["Shift ←", "Shift →"], "Choose a range"), row(["Ctrl-A"], "Choose all"),
    row(["Enter"], "Answer the question; else to the scan at the right"), row(["Escape"], "One step back")));
}

function exportDialog() {
  const layout = element("select", {}, ...(known.layouts ?? []).map(([name, text]) => element("option", { value: name, textContent: `${name}: ${text}` })),
    element("option", { value: "report", textContent: "report: one page to look at, of the corrected model" }));
  layout.dataset.first = "";
  const name = element("input", { type: "text", autocomplete: "off", required: true, maxLength: 120, value: "corrected" });
  const done = element("p", { role: "status" });
  openDialog("Write the corrected data set", dialogForm(async () => {
    done.textContent = "writing …";
    try {
      const isReport = layout.value === "report";
      const answer = await posted(isReport ? "report" : "export", isReport ? { name: name.value } : { layout: layout.value, name: name.value });
      done.replaceChildren("Written: ", element("bdi", { textContent: answer.path }), element("br"),
        [`${WHOLE.format(answer.written ?? 0)} written`, answer.missing?.length ? `${answer.missing.length} not found` : "", answer.skipped?.length ? `${answer.skipped.length} left out` : ""].filter(Boolean).join(", "));
    } catch (failure) {
      done.textContent = "";
      throw failure;
    }
    return false;
  }, submitButton("Write"), field("As", layout), field("Name of the new folder or file", name, "beside the model; nothing that is there is replaced"), done));
}
