// The gallery: only the tiles in sight exist, however many scans there are.
const GAP = 10, HEADER = 44, CAPTION = 44;

const gallery = (() => {
  const headers = element("div", { className: "gallery-headers" });
  const list = element("div", { className: "gallery-list", role: "listbox", tabIndex: 0, ariaLabel: "Scans", ariaMultiSelectable: "true" });
  const content = element("div", { className: "gallery-content" }, headers, list);
  const scroller = element("div", { className: "gallery-scroller" }, content);
  const empty = element("p", { className: "gallery-empty quiet", hidden: true });
  const root = element("div", { className: "gallery-root" }, scroller, empty);

  // Scans in the order in which they are shown, and the lines that show them: headers, and rows of tiles.
  let items = [], lines = [], columns = 1, side = 120, sections = [], isMixed = false;
  // While scans are picked one by one, walking on leaves them be; else the one that is walked to is chosen.
  let active = -1, anchor = -1, isPicking = false;
  const chosen = new Set(), tiles = new Map(), shownHeaders = new Map(), spare = [];
  const selectionFollowers = [];

  // As the browser last said: asking anew would make it lay out the page in the midst of changes.
  let room = { width: 0, height: 0 };
  function lay() {
    const width = room.width - 2 * GAP;
    if (width <= 0) return;
    const least = width < 500 ? 96 : 132;
    columns = Math.max(2, Math.floor((width + GAP) / (least + GAP)));
    side = Math.floor((width - GAP * (columns - 1)) / columns);
    items = [];
    lines = [];
    let top = GAP;
    for (const section of sections) {
      if (section.heading !== null) { lines.push({ top, height: HEADER, section }); top += HEADER; }
      const n = section.isOneLine ? Math.min(columns, section.rows.length) : section.rows.length;
      for (let first = 0; first < n; first += columns) {
        const after = Math.min(first + columns, n);
        lines.push({ top, height: side + CAPTION + GAP, first: items.length, n: after - first });
        for (let k = first; k < after; k++) items.push(section.rows[k]);
        top += side + CAPTION + GAP;
      }
    }
    content.style.height = `${top + GAP}px`;
    for (const tile of tiles.values()) retire(tile);
    tiles.clear();
    for (const header of shownHeaders.values()) header.remove();
    shownHeaders.clear();
    draw();
  }

  let scrolled = 0;
  function scrollTo(top) { scroller.scrollTop = top; scrolled = top; }

  const lineAt = (y) => {
    let [first, after] = [0, lines.length];
    while (after - first > 1) {
      const middle = (first + after) >> 1;
      if (lines[middle].top <= y) first = middle; else after = middle;
    }
    return first;
  };
  const lineOf = (item) => lines.findIndex((line) => line.first !== undefined && item >= line.first && item < line.first + line.n);

  function draw() {
    if (!lines.length) return;
    const from = scrolled - side, to = scrolled + room.height + side;
    const wanted = new Set(), wantedHeaders = new Set();
    for (let at = lineAt(from); at < lines.length && lines[at].top < to; at++) {
      const line = lines[at];
      if (line.section) wantedHeaders.add(line);
      else for (let k = 0; k < line.n; k++) wanted.add(line.first + k);
    }
    for (const [item, tile] of tiles) if (!wanted.has(item)) { tiles.delete(item); retire(tile); }
    for (const [line, header] of shownHeaders) if (!wantedHeaders.has(line)) { shownHeaders.delete(line); header.remove(); }
    for (const line of wantedHeaders) if (!shownHeaders.has(line)) { const made = headerOf(line); shownHeaders.set(line, made); headers.append(made); }
    for (let at = lineAt(from); at < lines.length && lines[at].top < to; at++) {
      const line = lines[at];
      if (line.section) continue;
      for (let k = 0; k < line.n; k++) {
        const item = line.first + k;
        if (tiles.has(item)) continue;
        const tile = spare.pop() ?? newTile();
        tiles.set(item, tile);
        tile.node.style.transform = `translate(${GAP + k * (side + GAP)}px, ${line.top}px)`;
        tile.node.style.width = `${side}px`;
        if (!tile.node.isConnected) list.append(tile.node);
        font ??= getComputedStyle(tile.name).font;
        fill(tile, item);
      }
    }
    list.setAttribute("aria-activedescendant", tiles.has(active) ? tiles.get(active).node.id : "");
  }

  // Names on one line, whose middle is left out. Letters are measured once: measuring names takes too long while it scrolls.
  const letterWidths = new Map();
  let font = null;
  function widthOf(text) {
    let width = 0;
    for (const letter of text) {
      if (!letterWidths.has(letter)) { ruler.font = font; letterWidths.set(letter, ruler.measureText(letter).width); }
      width += letterWidths.get(letter);
    }
    return width;
  }
  function fitted(name, width) {
    const wide = widthOf(name);
    if (wide <= width) return name;
    let most = Math.floor(name.length * width / wide) + 2;
    while (most > 3 && widthOf(shortened(name, most)) > width) most--;
    return shortened(name, most);
  }

  let nTiles = 0;
  function newTile() {
    const canvas = element("canvas", {}), none = element("span", { className: "tile-none", textContent: "no picture" });
    const mark = element("span", { className: "tile-mark" }), badge = element("span", { className: "tile-badge" });
    const name = element("bdi", { className: "tile-name" }), note = element("span", { className: "tile-note" });
    const node = element("div", { className: "tile", role: "option", id: `tile-${nTiles++}` },
      element("div", { className: "tile-picture" }, canvas, none), mark, badge, element("div", { className: "tile-caption" }, name, note));
    return { node, canvas, none, mark, badge, name, note };
  }
  function retire(tile) {
    forgetPreview(tile.canvas);
    tile.row = tile.item = -1;
    // Kept in the page, out of sight: taking nodes out and in costs more than moving them.
    tile.node.style.transform = "translate(-9999px, 0)";
    tile.node.setAttribute("aria-hidden", "true");
    spare.push(tile);
  }

  function fill(tile, item) {
    const row = items[item];
    tile.row = row;
    tile.item = item;
    if (tile.node.hasAttribute("aria-hidden")) tile.node.removeAttribute("aria-hidden");
    tile.node.ariaSetSize = items.length;
    tile.node.ariaPosInSet = item + 1;
    describe(tile);
    tile.none.hidden = true;
    showPreview(tile.canvas, row, side, (isThere, drawn) => { if (tile.row === drawn) { tile.none.hidden = isThere; describe(tile); } });
  }

  function describe(tile) {
    const { row } = tile, key = conceptOf(row), name = nameOfScan(row), isChosen = chosen.has(row);
    const isMedoid = byKey.get(key)?.medoid === row;
    const badges = [isMedoid ? "medoid" : "", foreign.has(row) ? "foreign" : "", isSkipped.has(row) ? "left out" : "", isDoubtful(row) ? "? doubtful" : ""].filter(Boolean);
    tile.node.style.setProperty("--colour", colourOfKey(key));
    tile.node.classList.toggle("is-chosen", isChosen);
    tile.node.classList.toggle("is-active", tile.item === active);
    tile.node.setAttribute("aria-selected", isChosen);
    tile.node.title = name;
    tile.mark.textContent = isChosen ? "✓" : "";
    tile.badge.textContent = badges[0] ?? "";
    tile.badge.classList.toggle("is-doubt", badges[0] === "? doubtful");
    tile.name.textContent = fitted(name, side - 16);
    const size = shownSides(sidesOf(row));
    tile.note.textContent = isMixed ? nameOfKey(key) : size;
    tile.node.ariaLabel = [name, nameOfKey(key), size, ...badges].filter(Boolean).join(", ");
  }

  function headerOf({ top, section }) {
    const link = section.link ? element("a", { href: section.link }, named(section.heading)) : named(section.heading);
    return element("h3", { className: "gallery-header", style: { top: `${top}px`, "--colour": section.colour ?? colourOfKey(section.key ?? -1) } },
      element("span", { className: "swatch" }), link,
      element("span", { className: "quiet", textContent: section.note ?? plural(section.rows.length, "scan") }));
  }

  function moveTo(item, { extend = false, toggle = false, keep = false } = {}) {
    if (!items.length) return;
    active = Math.max(0, Math.min(items.length - 1, item));
    const row = items[active];
    if (extend && anchor >= 0) {
      chosen.clear();
      for (let k = Math.min(anchor, active); k <= Math.max(anchor, active); k++) chosen.add(items[k]);
    } else {
      anchor = active;
      if (toggle) { if (!chosen.delete(row)) chosen.add(row); } else if (!keep) { chosen.clear(); chosen.add(row); }
      if (!keep) isPicking = toggle && chosen.size > 0;
    }
    reveal(active);
    changed();
  }

  function reveal(item) {
    const line = lines[lineOf(item)];
    if (!line) return;
    const first = lineOf(item) === 1 || lines[lineOf(item) - 1]?.section ? HEADER : 0;
    if (line.top - first < scrolled) scrollTo(Math.max(0, line.top - first - GAP));
    else if (line.top + line.height > scrolled + room.height) scrollTo(line.top + line.height - room.height);
    draw();
  }

  let chosenInOrder = [];
  function changed() {
    chosenInOrder = chosen.size ? items.filter((row) => chosen.has(row)) : [];
    for (const tile of tiles.values()) describe(tile);
    list.setAttribute("aria-activedescendant", tiles.has(active) ? tiles.get(active).node.id : "");
    for (const follower of selectionFollowers) follower();
  }

  // Up and down go to the tile nearest in the line before or after, of whichever section.
  function vertical(by) {
    let at = lineOf(active);
    const column = active - lines[at].first;
    do at += Math.sign(by); while (lines[at]?.section);
    return lines[at] ? lines[at].first + Math.min(column, lines[at].n - 1) : active;
  }

  list.addEventListener("keydown", (event) => {
    if (!items.length || event.altKey) return;
    const at = Math.max(active, 0), command = event.ctrlKey || event.metaKey;
    const page = Math.max(1, Math.floor(room.height / (side + CAPTION + GAP)));
    const pages = (by) => { for (let k = 0; k < page; k++) active = vertical(by); return active; };
    if (command && event.key === "a") { items.forEach((row) => chosen.add(row)); changed(); }
    else if (event.key === " ") { if (isPicking || place.isChoosing || !chosen.has(items[at])) moveTo(at, { toggle: true }); else isPicking = true; }
    else {
      if (active < 0) active = 0;
      const to = { ArrowRight: () => at + 1, ArrowLeft: () => at - 1, ArrowDown: () => vertical(1), ArrowUp: () => vertical(-1),
        Home: () => 0, End: () => items.length - 1, PageDown: () => pages(1), PageUp: () => pages(-1) }[event.key];
      if (!to) return;
      moveTo(to(), { extend: event.shiftKey, keep: command || place.isChoosing || isPicking });
    }
    event.preventDefault();
    event.stopPropagation();
  });
  list.addEventListener("click", (event) => {
    const node = event.target.closest(".tile");
    const tile = node && [...tiles.values()].find((one) => one.node === node);
    if (!tile) return;
    const isMark = event.target.closest(".tile-mark") !== null;
    moveTo(tile.item, { extend: event.shiftKey, toggle: !event.shiftKey && (isMark || event.ctrlKey || event.metaKey || place.isChoosing) });
    list.focus({ preventScroll: true });
    if (!isMark && !event.shiftKey && !event.ctrlKey && !event.metaKey && !place.isChoosing) openScanSheet();
  });
  list.addEventListener("dblclick", () => { if (active >= 0) openScanSheet(); });
  list.addEventListener("focus", () => { if (active < 0 && items.length && list.matches(":focus-visible")) moveTo(0, { keep: true }); });

  // The heading that was followed is gone in a moment: the keyboard stays in the gallery.
  headers.addEventListener("click", (event) => {
    const link = event.target.closest("a");
    if (!link) return;
    event.preventDefault();
    go(link.getAttribute("href"));
    list.focus({ preventScroll: true });
  });

  onOtherScans(() => { chosen.clear(); active = anchor = -1; });

  let isScrolling = false;
  scroller.addEventListener("scroll", () => {
    if (isScrolling) return;
    isScrolling = true;
    requestAnimationFrame(() => { isScrolling = false; scrolled = scroller.scrollTop; draw(); });
  }, { passive: true });
  new ResizeObserver(([{ contentRect }]) => { room = contentRect; lay(); }).observe(scroller);

  return {
    root, list,
    show(newSections, { mixed = false, isNew = true, message = "No scans here." } = {}) {
      const row = items[active];
      sections = newSections;
      isMixed = mixed;
      if (isNew) { scrollTo(0); active = anchor = -1; chosen.clear(); isPicking = false; }
      lay();
      if (!isNew) {
        const there = new Set(sections.flatMap((section) => section.rows));
        for (const one of chosen) if (!there.has(one)) chosen.delete(one);
        active = items.indexOf(row) >= 0 ? items.indexOf(row) : Math.min(active, items.length - 1);
        anchor = active;
      }
      empty.hidden = items.length > 0;
      empty.textContent = message;
      changed();
    },
    clear() { chosen.clear(); isPicking = false; changed(); },
    focus() { list.focus({ preventScroll: true }); },
    reveal(row) { const item = items.indexOf(row); if (item >= 0) moveTo(item); },
    step(by) { moveTo(Math.max(active, 0) + by); },
    chosen: () => chosenInOrder,
    active: () => (active >= 0 ? items[active] ?? null : null),
    nItems: () => items.length,
    onSelection(follower) { selectionFollowers.push(follower); },
    redraw: () => changed(),
  };
})();
