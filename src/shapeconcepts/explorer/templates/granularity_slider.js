// The tree of concepts from coarse to fine, and a slider across it: the groups at another granularity, before they are taken.
(() => {
  const box = document.getElementById("slider");
  let bands = null, stops = [], bandsOf = null;

  // In between the granularities at which the groups change, and the one in use.
  function stopsOf(changes) {
    const ends = [0, ...[...new Set(changes)].sort((a, b) => a - b), 1];
    return ends.slice(1).map((end, k) => (k === 0 ? end / 2 : Math.sqrt(ends[k] * end)));
  }
  const stopOf = (granularity) => {
    const after = [...new Set(known.granularities)].sort((a, b) => a - b).findIndex((change) => change >= granularity);
    return after < 0 ? stops.length - 1 : after;
  };

  // Group of each scan in the cut, -1 for none: children come before parents.
  function cutAt(granularity) {
    const inCut = known.tree.map((group, i) => group.from < granularity && (bands.isLeaf[i] || granularity <= group.to));
    const cutOf = new Int32Array(known.tree.length).fill(-1);
    for (let i = known.tree.length - 1; i >= 0; i--) cutOf[i] = inCut[i] ? i : known.tree[i].parent >= 0 ? cutOf[known.tree[i].parent] : -1;
    const rows = new Map();
    known.treeGroupOfScan.forEach((group, row) => {
      const cut = group < 0 ? -1 : cutOf[group];
      if (cut < 0) return;
      if (!rows.has(cut)) rows.set(cut, []);
      rows.get(cut).push(row);
    });
    return [...rows].sort((a, b) => b[1].length - a[1].length);
  }

  const canvas = element("canvas", { className: "slider-tree", ariaHidden: "true" });
  const range = element("input", { type: "range", min: 0, step: 1, ariaLabel: "Granularity, from coarse to fine" });
  const note = element("output", { className: "quiet small" });
  const use = element("button", { type: "button", textContent: "Use this", onclick: async () => {
    const granularity = stops[range.value];
    passing = null;
    if (await tried({ kind: "recut", granularity }) !== null) go("#");
    else showPlace();
  } });
  const back = element("button", { type: "button", textContent: "Back", onclick: () => { reset(); passing = null; showPlace(); } });
  const buttons = element("span", { className: "slider-buttons" }, use, back);

  function shownCut(granularity) {
    const groups = cutAt(granularity);
    return {
      kind: "cut", title: `${plural(groups.length, "group")} at granularity ${granularity.toPrecision(2)}`, note: "a preview", granularity,
      sections: groups.map(([group, rows], k) => ({ heading: `group ${k + 1}`, rows: typicalFirst(rows), isOneLine: true, key: -1, link: `#branch/${group}`, colour: colourOfKey(commonest(rows)) })),
    };
  }
  // Only a line of each group is shown, so only so many are looked for: it has to follow the slider.
  function typicalFirst(rows) {
    const distance = (row) => doubtOf(row) ?? 1, first = [];
    for (const row of rows) {
      if (first.length === 16 && distance(row) >= distance(first[15])) continue;
      let at = first.length;
      while (at > 0 && distance(first[at - 1]) > distance(row)) at--;
      first.splice(at, 0, row);
      if (first.length > 16) first.pop();
    }
    const shown = new Set(first);
    return [...first, ...rows.filter((row) => !shown.has(row))];
  }
  // A group has the colour of the concept that most of its scans are in now.
  function commonest(rows) {
    const counts = new Map();
    let best = -1, most = 0;
    for (const row of rows) {
      const key = conceptOf(row), n = (counts.get(key) ?? 0) + 1;
      counts.set(key, n);
      if (n > most) { best = key; most = n; }
    }
    return best;
  }

  let isMoving = false;
  range.addEventListener("input", () => {
    describe();
    if (isMoving) return;
    isMoving = true;
    requestAnimationFrame(() => {
      isMoving = false;
      const granularity = stops[range.value];
      draw();
      if (Number(range.value) === stopOf(current.granularity)) { passing = null; showPlace(); } else pass(shownCut(granularity));
    });
  });

  function describe() {
    const granularity = stops[range.value], isNow = Number(range.value) === stopOf(current.granularity);
    const n = known.tree.filter((group, i) => group.from < granularity && (bands.isLeaf[i] || granularity <= group.to)).length;
    note.textContent = isNow ? `granularity as it is: ${plural(n, "group")}` : `${plural(n, "group")} instead of ${current.concepts.length}`;
    range.setAttribute("aria-valuetext", note.textContent);
    buttons.hidden = isNow;
  }

  function draw() {
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (!width || bands === null) return;
    const context = sharpContext(canvas, width, height), granularity = stops[range.value];
    const scale = height / bands.room;
    known.tree.forEach((group, i) => {
      const left = bands.along(group.from) * width, right = bands.isLeaf[i] ? width : bands.along(group.to) * width;
      const isCut = group.from < granularity && (bands.isLeaf[i] || granularity <= group.to);
      context.fillStyle = isCut ? colourOfKey(bands.key[i]) : theme.coarse;
      context.globalAlpha = isCut ? 1 : 0.75;
      context.fillRect(left + 0.5, bands.tops[i] * scale + 0.5, Math.max(right - left - 1, 0.5), Math.max(bands.heights[i] * scale - 1, 0.7));
    });
    context.globalAlpha = 1;
    context.fillStyle = theme.accent;
    context.fillRect(bands.along(granularity) * width - 1, 0, 2, height);
  }
  canvas.addEventListener("click", (event) => {
    const share = event.offsetX / canvas.clientWidth, y = event.offsetY / canvas.clientHeight * bands.room;
    const hit = known.tree.findIndex((group, i) => y >= bands.tops[i] && y < bands.tops[i] + bands.heights[i]
      && share >= bands.along(group.from) && share < (bands.isLeaf[i] ? 1.01 : bands.along(group.to)));
    if (hit >= 0) { closeSheets(); go(`#branch/${hit}`); }
  });
  new ResizeObserver(draw).observe(canvas);
  isDark.addEventListener("change", () => requestAnimationFrame(draw));

  function reset() {
    range.value = stopOf(current.granularity);
    describe();
    draw();
  }
  function colourBands() {
    const rows = known.tree.map(() => []);
    known.treeGroupOfScan.forEach((group, row) => { for (let at = group; at >= 0; at = known.tree[at].parent) rows[at].push(row); });
    bands.key = rows.map(commonest);
  }
  onCurrent(() => {
    if (known.tree.length < 2 || current.granularity === null) { box.hidden = true; return; }
    box.hidden = false;
    // The tree of another model, or the first one.
    if (bandsOf !== known) {
      bandsOf = known;
      bands = treeBands(known.tree, (n) => [100, Math.min(6, 100 / n / 2)]);
      stops = stopsOf(known.granularities);
      range.max = stops.length - 1;
      box.replaceChildren(element("h2", { className: "left-title", textContent: "From coarse to fine" }), canvas, range, element("div", { className: "slider-note" }, note, buttons));
    }
    colourBands();
    // Where it was moved a moment ago, what it shows comes with the next frame.
    if (isMoving) return;
    if (passing?.kind !== "cut") reset();
    else { pass(shownCut(stops[range.value])); describe(); }
  });
  onPlace(() => { if (bandsOf === known && !isMoving && passing === null && Number(range.value) !== stopOf(current.granularity)) reset(); });
})();
