// All concepts at a glance: their medoids, and the ranked bars.
function overviewTile(rank) {
  const concept = concepts[rank];
  const tile = element("div", { className: "tile", style: { "--colour": conceptColour(rank) } },
    scanCanvas(concept.members[0], () => openViewer(concept.members, 0)),
    element("button", { className: "tile-name", onclick: () => toggle(rank) },
      oneLine(conceptName(rank)),
      sizeLine(concept.members[0]),
      element("span", { className: "quiet", textContent: plural(concept.size, "scan") }),
      hasLabels ? mixBar(concept) : ""));
  follows(tile, rank);
  return tile;
}

// Pointing at it highlights the concept everywhere, and it shows when the concept is highlighted.
function follows(node, rank) {
  node.addEventListener("pointerenter", (event) => { if (event.pointerType === "mouse") change({ hovered: rank }); });
  node.addEventListener("pointerleave", () => change({ hovered: null }));
  node.addEventListener("focusin", (event) => { if (event.target.matches(":focus-visible")) change({ hovered: rank }); });
  node.addEventListener("focusout", () => change({ hovered: null }));
  onChange(() => {
    node.classList.toggle("is-lit", highlighted() === rank);
    node.classList.toggle("is-dim", highlighted() !== null && highlighted() !== rank);
  });
}

function rankedBars() {
  const largest = Math.max(...concepts.map((concept) => concept.size));
  const longest = Math.max(...concepts.map(lifetime));
  const columns = concepts.map((concept, rank) => {
    const size = concept.size;
    const bar = element("button", { className: "column", onclick: () => toggle(rank),
      title: `${conceptName(rank)}: ${plural(size, "scan")}`
        + (hasLabels ? `, purity ${percent(concept.purity)}, rank score ${concept.score}` : "")
        + `, lifetime ${shownTime(lifetime(concept))}` },
    hasLabels ? mixBar(concept) : element("span", { className: "whole" }, element("span", {
      style: { height: `${Math.max(2, 100 * lifetime(concept) / longest)}%`, background: conceptColour(rank) } })),
    element("span", { className: "column-size" }, element("span", {
      style: { height: `${100 * size / largest}%`, background: conceptColour(rank) } })),
    element("span", { className: "column-number", textContent: concept.number }));
    follows(bar, rank);
    return bar;
  });
  return element("figure", {},
    element("h3", { textContent: hasLabels ? "Ranked by how pure and how large they are" : "Ranked by size and lifetime" }),
    element("div", { className: "columns", style: { "--n": concepts.length } }, ...columns),
    element("figcaption", { textContent: hasLabels
      ? "Upper bars: the labels of a concept's scans, each by its share. Lower bars: how many scans it has, "
        + `${largest} at most. The best is on the left: rank score = size / (1 − purity + 0.001), where purity is the `
        + "share of the commonest label. The labels came with the scans; nothing was learned from them."
      : `Upper bars: lifetime, the span of time through which the group stays as it is, ${shownTime(longest)} at most. Lower bars: number of scans, ${largest} at most. `
        + "No scan has a label, so concepts are ranked by size × lifetime." }));
}

function fillGlance(section) {
  if (concepts.length === 0) {
    section.append(element("h2", { textContent: "No concepts this time" }), element("p", { textContent:
      counts.places < 2
        ? `All scans with something in common lie at ${counts.places === 1 ? "one place" : "no place at all"} of the space: there is nothing to tell apart.`
        : (isBusiest ? `At no time do the scans fall into at least two groups of ${filtration.minSize} or more of which none holds more than half of them`
          : `No group of ${filtration.minSize} or more scans is left in the end`) + ". More scans, or a smaller minimum size, may change that. What was found stands below." }));
    return;
  }
  const tiles = concepts.map((_, rank) => rank).slice(0, 24).map(overviewTile);
  const grid = element("div", { className: "tiles" }, ...tiles);
  section.append(
    element("h2", { textContent: "What these objects have in common" }),
    element("p", { textContent: (isBusiest
      ? "A shape concept is a group of scans that stay together for a while as likeness is taken ever more loosely. "
      : "A shape concept is a group of scans that have much in common, with a gap to all others. ")
      + "Here is the most typical scan of each, its medoid. Turn them; point at one to find it in every "
      + "figure below, click to hold on to it." }),
    hasLabels ? legend(labels.map((label, i) => [labelColour(i), label]), "Labels of a concept’s scans:") : "",
    grid);
  if (concepts.length > 24) {
    const more = element("button", { className: "more", textContent: `Show all ${concepts.length} concepts`, onclick: () => {
      grid.append(...concepts.map((_, rank) => rank).slice(24).map(overviewTile));
      more.remove();
    } });
    section.append(more);
  }
  section.append(rankedBars());
}
