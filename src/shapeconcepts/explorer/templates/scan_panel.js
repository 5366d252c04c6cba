// At the right: one scan, large; why it is where it is, and what is like it.
(() => {
  const right = document.getElementById("right");
  const canvas = element("canvas", { className: "scan", tabIndex: 0, role: "img" });
  const body = element("div", { className: "scan-body" });
  const title = element("h2", { className: "scan-title" });
  const none = element("p", { className: "missing", hidden: true });
  right.append(element("button", { className: "close sheet-close", type: "button", ariaLabel: "Close", textContent: "×", onclick: () => { closeSheets(); gallery.focus(); } }),
    canvas, none, title, body);
  const answers = new Map();
  let shown = null, elements = null, lit = null, timer = null, abort = null;

  canvas.yaw = canvas.pitch = 0;
  canvas.redraw = () => {
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (!width) return;
    const context = sharpContext(canvas, width, height);
    if (elements !== null) drawElements(context, width, height, elements, canvas.yaw, canvas.pitch, lit);
  };
  turnable(canvas, null);
  new ResizeObserver(() => canvas.redraw()).observe(canvas);
  canvas.addEventListener("keydown", (event) => {
    const turns = { ArrowLeft: [-20, 0], ArrowRight: [20, 0], ArrowUp: [0, -20], ArrowDown: [0, 20] };
    if (event.key in turns) turnBy(canvas, ...turns[event.key]);
    else if (event.key === "PageDown") gallery.step(1);
    else if (event.key === "PageUp") gallery.step(-1);
    else return;
    event.preventDefault();
  });

  function show(row) {
    if (row === shown) return;
    shown = row;
    lit = null;
    canvas.yaw = canvas.pitch = 0;
    clearTimeout(timer);
    abort?.abort();
    right.classList.toggle("is-empty", row === null);
    if (row === null) { title.replaceChildren(); body.replaceChildren(element("p", { className: "quiet", textContent: "Choose a scan to see it here." })); elements = null; canvas.redraw(); return; }
    const record = records.get(row);
    elements = record ? decodedElements(record.bytes, record.extent, record.spacing) : null;
    canvas.redraw();
    fill(answers.get(row) ?? null);
    // While one walks, only what one stops at is asked for.
    if (!answers.has(row)) timer = setTimeout(() => ask(row), 90);
  }

  async function ask(row) {
    abort = new AbortController();
    try {
      const answer = await (await asked(`scan?row=${row}`, { signal: abort.signal })).json();
      answers.set(row, answer);
      if (answers.size > 40) answers.delete(answers.keys().next().value);
      if (row === shown) fill(answer);
    } catch (failure) {
      if (failure.name !== "AbortError" && row === shown) body.append(element("p", { className: "refusal", textContent: failure.message }));
    }
  }

  const pair = (term, ...children) => element("div", {}, element("dt", { textContent: term }), element("dd", {}, ...children));
  const scanButton = (row, side, note) => {
    const picture = element("canvas", { className: "small-picture" });
    showPreview(picture, row, side);
    return element("button", { type: "button", className: "small-scan", title: `${nameOfScan(row)}, in ${nameOfKey(conceptOf(row))}`, ariaLabel: `${nameOfScan(row)}, in ${nameOfKey(conceptOf(row))}`,
      style: { "--colour": colourOfKey(conceptOf(row)) }, onclick: () => goToScan(row) }, picture, element("span", { textContent: note }));
  };

  function fill(answer) {
    const row = shown, key = conceptOf(row), name = nameOfScan(row), doubt = doubtOf(row);
    const p = answer?.pValue ?? current.pValues?.[row] ?? null, sides = answer?.sides ?? sidesOf(row), label = known.scans.labels[row];
    canvas.ariaLabel = `${name}, which the arrow keys turn`;
    title.replaceChildren(oneLine(name));
    if (answer?.preview) {
      elements = decodedElements(bytesOf(answer.preview), answer.extent, answer.spacing);
      canvas.redraw();
    }
    none.hidden = answer === null || Boolean(answer.preview) || elements !== null;
    none.textContent = answer?.reason || "no picture";
    refilled(body,
      element("dl", {},
        pair("concept", key < 0 ? (foreign.has(row) ? "foreign" : "none") : element("a", { href: `#concept/${key}`, className: "in-concept", style: { "--colour": colourOfKey(key) } }, element("span", { className: "swatch" }), named(nameOfKey(key)))),
        sides ? pair("size", shownSides(sides)) : "",
        answer?.preview ? pair("surfaces", String(answer.segments)) : "",
        p === null ? "" : pair("p-value", p < 0.01 ? "under 0.01" : Number(p).toFixed(2)),
        doubt === null || key < 0 ? "" : pair("doubt", `${doubt.toFixed(2)}: ${doubt > 0.5 ? "another is nearer" : doubt >= current.doubtfulFrom ? "its own is nearest, another not much farther" : "its own is nearest by far"}`),
        label >= 0 ? pair("label", element("bdi", { textContent: known.labelNames[label] })) : "",
        answer?.path ? pair("file", element("bdi", { className: "path", textContent: answer.path })) : ""),
      element("p", { className: "row" },
        element("button", { type: "button", textContent: "Show in the figures", onclick: () => showInFigures(row, key) })),
      ...(answer === null ? [element("p", { className: "quiet", textContent: "…" })] : [responses(answer, row), motifs(answer), nearest(answer)]));
  }

  // As small a divergence as possible: a long bar is a good fit.
  function responses(answer, row) {
    const fits = answer.responses.filter(([key]) => byKey.has(key)).sort((a, b) => a[1] - b[1]).slice(0, 4);
    if (!fits.length) return "";
    return element("div", {}, element("h3", { textContent: "How well it fits" }), element("ul", { className: "fits" }, ...fits.map(([key, value]) => element("li", { style: { "--colour": colourOfKey(key) } },
      element("a", { href: `#concept/${key}` }, named(nameOfKey(key))),
      element("span", { className: "fit", title: `divergence ${value.toFixed(3)}` }, element("span", { style: { width: `${Math.max(1, 100 * (1 - value))}%` } })),
      element("span", { className: "quiet small", textContent: value.toFixed(2) }),
      key === conceptOf(row) ? element("span", { className: "quiet small", textContent: "here" })
        : element("button", { type: "button", textContent: "move", ariaLabel: `Move it to ${nameOfKey(key)}`, onclick: () => tried({ kind: "move", scans: [row], key }) })))));
  }

  function motifs(answer) {
    if (!answer.motifs.length) return "";
    const light = (segments) => { lit = segments && new Set(segments.map((segment) => segment % (shades.length - 1))); canvas.redraw(); };
    return element("div", {}, element("h3", { textContent: "Motifs that fired" }),
      element("p", { className: "quiet small", textContent: "Point at one to see of which surfaces it is; beside it what it reminds of." }),
      element("ol", { className: "motifs" }, ...answer.motifs.slice(0, 8).map((motif) => element("li", { tabIndex: 0,
        onpointerenter: () => light(motif.segments), onpointerleave: () => light(null), onfocusin: () => light(motif.segments), onfocusout: () => light(null) },
      element("span", { className: "motif-name" },
        element("span", { className: "motif-keys" }, ...motif.segments.map((segment) => element("span", { className: "key", style: { background: shades[segment % (shades.length - 1)][14] } }))),
        element("span", { className: "small", textContent: plural(motif.segments.length, "surface") }),
        element("span", { className: "fit" }, element("span", { style: { width: `${Math.max(1, 100 * motif.stimulus)}%` } })),
        element("span", { className: "quiet small", textContent: motif.stimulus >= 0.01 ? motif.stimulus.toFixed(2) : motif.stimulus.toExponential(0) })),
      element("span", { className: "small-scans" }, ...motif.reminds.filter((one) => one.row !== shown).slice(0, 3).map(({ row, divergence }) => scanButton(row, 44, divergence.toFixed(2))))))));
  }

  const nearest = (answer) => (answer.nearest.length === 0 ? "" : element("div", {}, element("h3", { textContent: "Nearest scans" }),
    element("div", { className: "small-scans wide-scans" }, ...answer.nearest.slice(0, 12).map(([row, divergence]) => scanButton(row, 64, divergence.toFixed(2))))));

  gallery.onSelection(() => show(gallery.active()));
  onCurrent(() => { answers.clear(); if (shown !== null) { const row = shown; shown = undefined; const { yaw, pitch } = canvas; show(row); Object.assign(canvas, { yaw, pitch }); canvas.redraw(); } });
  onOtherScans(() => show(null));
  show(null);
})();

// To a scan among those that are shown, or else in its concept.
function goToScan(row) {
  openView("scans");
  if (!place.sections.some((section) => section.rows.includes(row)) || place.sections[0]?.isOneLine) {
    const key = conceptOf(row);
    passing = null;
    history.pushState(null, "", key >= 0 ? `#concept/${key}` : foreign.has(row) ? "#foreign" : isSkipped.has(row) ? "#all" : "#none");
    showPlace();
  }
  gallery.reveal(row);
}

// On narrow windows the sides are sheets above the gallery.
const isNarrow = matchMedia("(max-width: 1179px)");
function openScanSheet() { if (isNarrow.matches) document.getElementById("right").classList.add("is-open"); }
function openListSheet() { document.getElementById("left").classList.add("is-open"); document.querySelector("#left a")?.focus(); }
function closeSheets() {
  const open = document.querySelectorAll(".is-open");
  open.forEach((sheet) => sheet.classList.remove("is-open"));
  return open.length > 0;
}
