// The tree of concepts: from the left, where all scans are one group, each split until nothing splits any more.
const groups = contents.groups;

function svg(tag, attributes, text) {
  const made = document.createElementNS(document.getElementById("svg").namespaceURI, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  if (text !== undefined) made.textContent = text;
  return made;
}

function granularityFigure() {
  const width = 1000, top = 26, bottom = 40, isLeaf = groups.map((_, i) => groups.every((other) => other.parent !== i));
  const nLeaves = isLeaf.filter(Boolean).length, nScans = groups.reduce((sum, group, i) => sum + (isLeaf[i] ? group.size : 0), 0);
  const room = Math.min(22 * nLeaves + 60, 640), least = Math.min(13, room / nLeaves / 2);
  // Bands are as high as groups are large, but for a least height that can be read.
  const band = (group) => least + (room - least * nLeaves) * group.size / nScans;
  const heights = groups.map(() => 0), tops = groups.map(() => 0);
  groups.forEach((group, i) => { if (isLeaf[i]) heights[i] = band(group); if (group.parent >= 0) heights[group.parent] += heights[i]; });
  const free = new Map([[-1, top]]);
  for (let i = groups.length - 1; i >= 0; i--) {
    const parent = groups[i].parent;
    tops[i] = free.get(parent);
    free.set(parent, tops[i] + heights[i]);
    free.set(i, tops[i]);
  }
  const shares = groups.flatMap((group) => [group.from, group.to]).filter((share) => share > 0 && share < 1);
  const first = Math.max(Math.min(0.02, ...shares) / 2, 1e-4);
  const x = (share) => Math.max(Math.log(Math.max(share, first) / first) / Math.log(1 / first), 0) * width;
  const figure = svg("svg", { viewBox: `0 0 ${width} ${room + top + bottom}`, class: "granularity", role: "img",
    "aria-label": `Tree of ${nLeaves} groups at the finest granularity` });
  groups.forEach((group, i) => {
    const left = x(group.from), wide = Math.max((isLeaf[i] ? width : x(group.to)) - left, 0);
    if (wide < 0.5) return;
    const bar = svg("g", { class: group.rank < 0 ? "coarse" : "" });
    bar.append(svg("rect", { x: left + 0.5, y: tops[i] + 0.5, width: Math.max(wide - 1, 0.5), height: Math.max(heights[i] - 1, 0.5), rx: 2,
      fill: group.rank < 0 ? "#d9dce4" : conceptColour(group.rank), "fill-opacity": group.rank < 0 || group.isConcept ? 1 : 0.45 }));
    const name = group.isConcept ? conceptName(group.rank) : "";
    const said = (most) => [shortened(name, most), plural(group.size, "scan"),
      group.label >= 0 ? `mostly ${shortened(labels[group.label], most)}` : ""].filter(Boolean).join(", ");
    bar.append(svg("title", {}, said(Infinity)));
    const shown = [Infinity, 30, 20, 12].map(said).find((text) => wide > 7 * text.length)
      ?? (wide > 7 * String(group.size).length + 8 ? String(group.size) : "");
    if (shown && heights[i] >= 11) {
      bar.append(svg("text", { x: left + 6, y: tops[i] + heights[i] / 2, "dominant-baseline": "central",
        fill: group.rank < 0 || !group.isConcept ? "#1c2333" : textColour(conceptColour(group.rank)) }, shown));
    }
    if (group.rank >= 0) {
      bar.style.cursor = "pointer";
      bar.addEventListener("click", () => toggle(group.rank));
      bar.addEventListener("pointerenter", () => change({ hovered: group.rank }));
      bar.addEventListener("pointerleave", () => change({ hovered: null }));
      onChange(() => { bar.style.opacity = highlighted() === null || highlighted() === group.rank ? "1" : "0.35"; });
    }
    figure.append(bar);
  });
  const base = room + top;
  for (const share of [0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1].filter((one) => one > first)) {
    figure.append(svg("line", { x1: x(share), x2: x(share), y1: base, y2: base + 5, stroke: "#5b6070" }),
      svg("text", { x: x(share), y: base + 16, "text-anchor": share === 1 ? "end" : "middle", fill: "#5b6070" }, `${Number((100 * share).toPrecision(2))} %`));
  }
  figure.append(svg("text", { x: width / 2, y: base + 34, "text-anchor": "middle", fill: "#5b6070" }, "what two groups have in common where they split"));
  const now = x(filtration.granularity);
  figure.append(svg("line", { x1: now, x2: now, y1: top - 8, y2: base, stroke: ACCENT, "stroke-width": 2 }),
    svg("text", { x: now, y: 12, "text-anchor": now > width / 2 ? "end" : "start", fill: ACCENT, "font-weight": 600 },
      `granularity ${filtration.granularity.toFixed(3)}: ${plural(concepts.length, "concept")}`));
  return element("figure", {}, element("h3", { textContent: "From coarse to fine: the tree of concepts" }), figure,
    element("figcaption", { textContent: "On the left all scans are one group, as high as it is large. Where a bar ends, its scans fall into two groups, "
      + "between which there is a gap that chance does not explain; the less both have in common, the farther left. The orange line is the "
      + "granularity: the bars that it crosses are the concepts, in their colours; paler bars are what they fall into at a finer one." }));
}

function textColour(hexadecimal) {
  const [r, g, b] = [1, 3, 5].map((k) => parseInt(hexadecimal.slice(k, k + 2), 16));
  return 0.3 * r + 0.59 * g + 0.11 * b > 150 ? "#1c2333" : "#ffffff";
}
