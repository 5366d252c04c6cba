// The figures of the report, of the model as it is corrected now: each leads to its scans, and a scan to its place in them.
const figuresView = (() => {
  const box = document.getElementById("figures"), tip = document.getElementById("tip");
  const sheet = element("div", { className: "sheet" });
  const chosen = element("div", { id: "in-figures", hidden: true });
  box.append(sheet, chosen);
  let drawn = null, contents = null, version = null, rankOf = new Map(), shownRow = null;

  // Asked for once, however many wait for it.
  let filling = null;
  function fill() {
    filling ??= refill().finally(() => { filling = null; });
    return filling;
  }
  async function refill() {
    if (version === current.version) return;
    const wanted = current.version;
    if (drawn === null) sheet.replaceChildren(element("p", { className: "quiet", textContent: "drawing …" }));
    let made;
    try {
      made = await (await asked("figures")).json();
    } catch (failure) {
      refused(failure.message);
      return;
    }
    if (wanted !== current.version) { await refill(); return; }
    version = wanted;
    contents = made;
    rankOf = new Map();
    contents.concepts.forEach((concept, rank) => {
      const { key } = current.concepts[concept.number];
      rankOf.set(key, rank);
      Object.assign(concept, { key, colour: colourOfKey(key), number: key });
    });
    drawn = contents.filtration.heat.length < 2 ? null : drawnFigures(contents, showTip);
    sheet.replaceChildren(element("h1", { textContent: "How the concepts came about" }),
      element("p", { className: "quiet", textContent: "Click a dot, a bar or a branch, then go to its scans." }), ...(drawn?.figures ?? [element("p", { textContent: "Fewer than two places: there is nothing to draw." })]));
    drawn?.onChange(fillChosen);
    makeReachable();
    fillChosen();
  }

  function showTip(scan, x, y, note) {
    tip.hidden = scan === null;
    if (scan === null) { shownRow = null; return; }
    const row = contents.rows[scan];
    if (row !== shownRow) {
      shownRow = row;
      const canvas = element("canvas", { className: "scan" });
      tip.replaceChildren(canvas, element("div", {}, named(nameOfScan(row), "scan-name"), element("div", { className: "quiet", textContent: nameOfKey(conceptOf(row)) }), element("div", { className: "quiet", textContent: note })));
      showPreview(canvas, row, 96);
    }
    const { width, height } = tip.getBoundingClientRect();
    tip.style.left = `${Math.max(4, x + 16 + width > innerWidth ? x - 16 - width : x + 16)}px`;
    tip.style.top = `${Math.max(4, Math.min(y - height / 2, innerHeight - height - 4))}px`;
  }

  // What is chosen in the figures, and the way to its scans: a scan, a branch of the tree, or a concept.
  let row = null, branch = null;
  sheet.addEventListener("branch", ({ detail }) => { row = null; branch = detail; drawn.change({ marked: null }); fillChosen(); });
  sheet.addEventListener("place", ({ detail }) => {
    branch = null;
    // Chosen twice, it is let go of.
    row = drawn.state.marked === detail ? null : contents.rows[drawn.scansAt[detail][0]];
    drawn.change({ marked: row === null ? null : detail, selected: row === null ? null : rankOf.get(conceptOf(row)) ?? null });
    fillChosen();
  });
  function fillChosen() {
    const rank = drawn?.state.selected ?? null;
    chosen.hidden = rank === null && row === null && branch === null;
    if (chosen.hidden) return;
    const concept = rank === null ? null : contents.concepts[rank];
    const isWhole = concept !== null && (branch === null || contents.groups[branch].isConcept);
    const name = row !== null ? nameOfScan(row) : isWhole ? nameOfKey(concept.key) : "A branch of the tree";
    const way = (text, goThere) => element("button", { type: "button", textContent: text, onclick: () => { openView("scans"); goThere(); gallery.focus(); } });
    const toAll = isWhole ? way(`Its ${plural(concept.size, "scan")}`, () => go(`#concept/${concept.key}`))
      : branch !== null ? way(`Its ${plural(contents.groups[branch].size, "scan")}`, () => go(`#branch/${branch}`)) : "";
    const toOne = row === null ? "" : way("To the scan", () => goToScan(row));
    const first = toOne || toAll;
    Object.assign(first, { id: "to-scans", className: "primary" });
    chosen.replaceChildren(element("span", { className: "swatch", style: { "--colour": concept?.colour ?? NONE_COLOUR } }), named(name), toOne,
      row !== null && isWhole ? Object.assign(toAll, { textContent: `All ${WHOLE.format(concept.size)} like it` }) : toAll,
      element("button", { type: "button", ariaLabel: "Let go of it", textContent: "×", onclick: () => { row = branch = null; drawn?.change({ selected: null, marked: null }); fillChosen(); } }));
  }

  // Bars of the granularity tree are buttons, and the canvases walk through the concepts by arrow keys.
  function makeReachable() {
    const select = (rank) => { row = branch = null; drawn.change({ selected: rank, marked: null }); };
    for (const canvas of sheet.querySelectorAll("canvas")) {
      canvas.tabIndex = 0;
      canvas.addEventListener("keydown", (event) => {
        const by = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key], n = contents.concepts.length;
        if (event.key === "Enter" && drawn.state.selected !== null) document.getElementById("to-scans").click();
        else if (by !== undefined && n) select(drawn.state.selected === null ? (by > 0 ? 0 : n - 1) : (drawn.state.selected + by + n) % n);
        else return;
        event.preventDefault();
      });
    }
  }

  onCurrent(() => { if (!box.hidden) fill(); });
  isDark.addEventListener("change", () => { version = null; if (!box.hidden) fill(); });
  return {
    fill,
    async show(scan, key) {
      await fill();
      [row, branch] = [scan, null];
      const rank = rankOf.get(key) ?? null;
      drawn?.change({ selected: rank });
      fillChosen();
      // The place of one scan is marked while it is looked for.
      const at = scan === null ? -1 : contents.rows.indexOf(scan);
      drawn?.change({ marked: at >= 0 && contents.scans.vertices[at] >= 0 ? contents.scans.vertices[at] : null });
      sheet.querySelector("canvas")?.scrollIntoView({ block: "center" });
    },
  };
})();

function showInFigures(row, key) {
  openView("figures");
  figuresView.show(row, key);
}
