// All edits, the latest first: any of them can be gone back to, and those that no longer fit stand first.
const KINDS = { rename: "name", recut: "granularity", foreign: "foreign", propagate: "spread" };

onCurrent(() => {
  const box = document.getElementById("journal"), edits = [...current.journal].reverse(), misfits = unfit();
  const nAfter = (number) => current.journal.filter((edit) => edit.number >= number && !edit.undone).length;
  const entry = (edit) => {
    // Going back to a moment: what came after it is undone, one by one.
    const after = nAfter(edit.number + 1);
    return element("li", { className: `${edit.undone ? "is-undone" : ""} ${edit.unfit ? "is-unfit" : ""}` },
      element("span", { className: "edit-number", textContent: edit.number }),
      element("span", { className: "edit-kind", textContent: KINDS[edit.kind] ?? edit.kind }),
      element("span", { className: "edit-text" }, element("bdi", { textContent: edit.text }), edit.undone ? element("span", { className: "quiet", textContent: " (undone)" }) : "",
        edit.unfit ? element("span", { className: "unfit" }, "⚠ no longer fits: ", element("bdi", { textContent: edit.unfit })) : ""),
      edit.undone || after === 0 ? "" : element("button", { type: "button", textContent: "Back to here", title: `Undo the ${plural(after, "edit")} after this one`, onclick: () => undoTimes(after) }));
  };
  const all = nAfter(-Infinity);
  refilled(box, element("div", { className: "sheet" },
    element("h1", { textContent: "Journal" }),
    element("p", { className: "quiet", textContent: "Each edit is a line in a file beside the model, kept through restarts and updates. Nothing is ever dropped from it." }),
    misfits.length ? element("div", { className: "misfits" }, element("h2", { textContent: `⚠ ${plural(misfits.length, "edit")} no longer ${misfits.length === 1 ? "fits" : "fit"} the model` }),
      element("ol", { className: "edits" }, ...misfits.map(entry))) : "",
    element("p", { className: "row" }, element("button", { type: "button", disabled: !current.canUndo, onclick: () => tried({ kind: "undo" }) }, "Undo ", element("kbd", { textContent: "Ctrl-Z" })),
      element("button", { type: "button", disabled: !current.canRedo, onclick: () => tried({ kind: "redo" }) }, "Redo ", element("kbd", { textContent: "Ctrl-Shift-Z" })),
      all ? element("button", { type: "button", textContent: "Back to the model as it was learned", onclick: () => undoTimes(all) }) : ""),
    edits.length ? element("ol", { className: "edits" }, ...edits.map(entry)) : element("p", { textContent: "No edit yet." })));
});

async function undoTimes(n) {
  for (let k = 0; k < n && current.canUndo; k++) if (await tried({ kind: "undo" }) === null) return;
}
