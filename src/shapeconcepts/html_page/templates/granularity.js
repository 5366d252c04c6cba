// The tree of concepts: from the left, where all scans are one group, each split until nothing splits any more.
const groups = contents.groups;

function svg(tag, attributes, text) {
  const made = document.createElementNS(document.getElementById("svg").namespaceURI, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  if (text !== undefined) made.textContent = text;
  return made;
}

function granularityFigure() {
  const width = 1000, top = 26, bottom = 40;
  const { isLeaf, nLeaves, room, heights, tops, first, along } = treeBands(groups, (n) => {
    const all = Math.min(22 * n + 60, 640);
    return [all, Math.min(13, all / n / 2)];
  });
  const x = (share) => along(share) * width;
  const figure = svg("svg", { viewBox: `0 0 ${width} ${room + top + bottom}`, class: "granularity", role: "group",
    "aria-label": `Tree of ${nLeaves} groups at the finest granularity` });
  const bars = [];
  groups.forEach((group, i) => {
    const left = x(group.from), wide = Math.max((isLeaf[i] ? width : x(group.to)) - left, 0);
    if (wide < 0.5) return;
    const bar = svg("g", { class: group.rank < 0 ? "coarse" : "" });
    bar.append(svg("rect", { x: left + 0.5, y: top + tops[i] + 0.5, width: Math.max(wide - 1, 0.5), height: Math.max(heights[i] - 1, 0.5), rx: 2,
      fill: group.rank < 0 ? theme.coarse : conceptColour(group.rank), "fill-opacity": group.rank < 0 || group.isConcept ? 1 : 0.45 }));
    const name = group.isConcept ? conceptName(group.rank) : "";
    const said = (most) => [shortened(name, most), plural(group.size, "scan"),
      group.label >= 0 ? `mostly ${shortened(labels[group.label], most)}` : ""].filter(Boolean).join(", ");
    bar.append(svg("title", {}, said(Infinity)));
    const shown = [Infinity, 30, 20, 12].map(said).find((text) => wide > 7 * text.length)
      ?? (wide > 7 * String(group.size).length + 8 ? String(group.size) : "");
    if (shown && heights[i] >= 11) {
      bar.append(svg("text", { x: left + 6, y: top + tops[i] + heights[i] / 2, "dominant-baseline": "central",
        fill: group.rank < 0 || !group.isConcept ? theme.ink : textColour(conceptColour(group.rank)) }, shown));
    }
    if (group.rank >= 0) {
      bar.style.cursor = "pointer";
      bar.addEventListener("click", () => toggle(group.rank));
      bar.addEventListener("focus", () => change({ hovered: group.rank }));
      bar.addEventListener("blur", () => change({ hovered: null }));
      bar.addEventListener("pointerenter", () => change({ hovered: group.rank }));
      bar.addEventListener("pointerleave", () => change({ hovered: null }));
      onChange(() => { bar.style.opacity = highlighted() === null || highlighted() === group.rank ? "1" : "0.35"; });
    }
    // Whoever shows the scans of a branch listens to this.
    bar.addEventListener("click", () => bar.dispatchEvent(new CustomEvent("branch", { bubbles: true, detail: i })));
    bar.setAttribute("role", "button");
    bar.setAttribute("tabindex", -1);
    bar.setAttribute("aria-label", said(Infinity));
    bars.push(bar);
    figure.append(bar);
  });
  walkable(figure, bars);
  const base = room + top;
  for (const share of [0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1].filter((one) => one > first)) {
    figure.append(svg("line", { x1: x(share), x2: x(share), y1: base, y2: base + 5, stroke: theme.quiet }),
      svg("text", { x: x(share), y: base + 16, "text-anchor": share === 1 ? "end" : "middle", fill: theme.quiet }, `${Number((100 * share).toPrecision(2))} %`));
  }
  figure.append(svg("text", { x: width / 2, y: base + 34, "text-anchor": "middle", fill: theme.quiet }, "what two groups have in common where they split"));
  const now = x(filtration.granularity);
  figure.append(svg("line", { x1: now, x2: now, y1: top - 8, y2: base, stroke: theme.accent, "stroke-width": 2 }),
    svg("text", { x: now, y: 12, "text-anchor": now > width / 2 ? "end" : "start", fill: theme.accent, "font-weight": 600 },
      `granularity ${filtration.granularity.toFixed(3)}: ${plural(concepts.length, "concept")}`));
  return element("figure", {}, element("h3", { textContent: "From coarse to fine: the tree of concepts" }), figure,
    element("figcaption", { textContent: "On the left all scans are one group, as high as it is large. Where a bar ends, its scans fall into two groups, "
      + "between which there is a gap that chance does not explain; the less both have in common, the farther left. The orange line is the "
      + "granularity: the bars that it crosses are the concepts, in their colours; paler bars are what they fall into at a finer one." }));
}

// One stop of the Tab key; arrows walk, Enter clicks. From coarse to fine: the last bars are the coarsest.
function walkable(figure, bars) {
  bars.at(-1)?.setAttribute("tabindex", 0);
  figure.addEventListener("keydown", (event) => {
    const at = bars.indexOf(event.target), by = { ArrowRight: -1, ArrowDown: -1, ArrowLeft: 1, ArrowUp: 1 }[event.key];
    if (at < 0) return;
    if (event.key === "Enter" || event.key === " ") event.target.dispatchEvent(new MouseEvent("click", { bubbles: true }));
    else if (by !== undefined && bars[at + by]) { bars[at].setAttribute("tabindex", -1); bars[at + by].setAttribute("tabindex", 0); bars[at + by].focus(); } else return;
    event.preventDefault();
  });
}

function textColour(hexadecimal) {
  const [r, g, b] = [1, 3, 5].map((k) => parseInt(hexadecimal.slice(k, k + 2), 16));
  return 0.3 * r + 0.59 * g + 0.11 * b > 150 ? "#1c2333" : "#ffffff";
}
