// At the left: the lists, and the concepts. The arrow keys walk through them.
(() => {
  const left = document.getElementById("left");
  const lists = element("ul", { className: "lists" }), concepts = element("ul", { className: "concepts" });
  const slider = element("div", { id: "slider" });
  left.append(lists, slider, element("h2", { className: "left-title", textContent: "Concepts" }), concepts);

  const entries = () => [["#", "All concepts", current.concepts.length], ["#uncertain", "Uncertain", current.isThinking ? "…" : uncertain().length],
    ["#none", "In no concept", withoutConcept().length], ["#foreign", "Foreign", foreign.size], ["#all", "All scans", nScans()]];

  const drawn = new Map();
  function conceptEntry(key) {
    if (!drawn.has(key)) {
      const canvas = element("canvas", { className: "concept-picture" });
      const name = element("span", { className: "concept-name" }), note = element("span", { className: "concept-note" });
      const node = element("li", {}, element("a", { href: `#concept/${key}` }, canvas, element("span", { className: "concept-text" }, name, note)));
      drawn.set(key, { node, canvas, name, note, medoid: -1 });
    }
    return drawn.get(key);
  }
  onOtherScans(() => drawn.clear());
  const inSight = new IntersectionObserver((all) => {
    for (const { target, isIntersecting } of all) {
      if (isIntersecting) { if (target.shown !== target.row) showPreview(target, target.row, 48, (_, row) => { target.shown = row; }); }
      else forgetPreview(target);
    }
  }, { root: left, rootMargin: "200px" });

  function fill() {
    const focused = document.activeElement?.closest?.("#left a")?.getAttribute("href");
    lists.replaceChildren(...entries().map(([href, text, n]) => element("li", {}, element("a", { href, className: href === "#uncertain" && n ? "has-doubts" : "" },
      element("span", { textContent: text }), element("span", { className: "count", textContent: typeof n === "number" ? WHOLE.format(n) : n })))));
    for (const [key, { node }] of drawn) if (!byKey.has(key)) { node.remove(); drawn.delete(key); }
    concepts.replaceChildren(...current.concepts.map(({ key, size, medoid, suggested, name: own }) => {
      const { node, canvas, name, note } = conceptEntry(key), doubts = membersOf(key).filter(isDoubtful).length;
      canvas.row = medoid;
      if (canvas.shown !== medoid) { inSight.unobserve(canvas); inSight.observe(canvas); }
      node.style.setProperty("--colour", colourOfKey(key));
      name.replaceChildren(named(nameOfKey(key)));
      note.replaceChildren(plural(size, "scan"), doubts ? element("span", { className: "doubts", textContent: `? ${doubts}`, title: `${plural(doubts, "scan")} nearer to another concept` }) : "",
        own || !suggested ? "" : element("span", { className: "suggested", textContent: suggested, title: suggested }));
      return node;
    }));
    mark();
    if (focused) left.querySelector(`a[href="${CSS.escape(focused)}"]`)?.focus({ preventScroll: true });
  }
  function mark() {
    const here = place === null ? "" : place.kind === "concept" ? `#concept/${place.key}` : place.kind === "overview" ? "#" : `#${place.kind}`;
    for (const link of left.querySelectorAll("a")) {
      if (link.getAttribute("href") === here) link.setAttribute("aria-current", "page"); else link.removeAttribute("aria-current");
    }
    left.querySelector("[aria-current]")?.scrollIntoView({ block: "nearest" });
  }
  left.addEventListener("keydown", (event) => {
    const by = { ArrowDown: 1, ArrowUp: -1 }[event.key], links = [...left.querySelectorAll("a")], at = links.indexOf(event.target);
    if (by === undefined || at < 0) return;
    event.preventDefault();
    links[Math.max(0, Math.min(links.length - 1, at + by))].focus();
  });
  left.addEventListener("click", (event) => {
    const link = event.target.closest("a");
    if (!link) return;
    event.preventDefault();
    closeSheets();
    go(link.getAttribute("href"));
    if (event.detail === 0) gallery.focus();
  });
  onCurrent(fill);
  onPlace(mark);
  isDark.addEventListener("change", () => { readTheme(); fill(); gallery.redraw(); });
})();
