// Each concept with all its scans that are shown, and those in none.
const FIRST = 16;

// Of the scans of a group, `size` in all, those that are shown.
function gallery(group, size, firstNote) {
  const grid = element("div", { className: "gallery" });
  const figure = (scan, at) => {
    const label = scans.labels[scan];
    const made = element("figure", { tabIndex: at === 0 ? 0 : -1, role: "button", 
      ariaLabel: [scans.names[scan], shownSize(scan)].filter(Boolean).join(", ") },
      scans.previews[scan] === null ? element("div", { className: "scan missing", textContent: "no picture" })
        : scanCanvas(scan, () => openViewer(group, at)),
      element("figcaption", {},
        label < 0 ? "" : element("span", { className: "key", title: labels[label], style: { background: labelColour(label) } }),
        oneLine(scans.names[scan]), sizeLine(scan)));
    if (at === 0 && firstNote) made.append(element("span", { className: "badge", textContent: firstNote }));
    return made;
  };
  // One stop of the Tab key; arrows walk, Enter opens.
  grid.addEventListener("keydown", (event) => {
    const all = [...grid.children], at = all.indexOf(event.target);
    const to = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: all.length - 1 }[event.key];
    if (event.key === "Enter" && at >= 0) openViewer(group, at);
    else if (to !== undefined && all[to]) { event.target.tabIndex = -1; all[to].tabIndex = 0; all[to].focus(); } else return;
    event.preventDefault();
  });
  grid.append(...group.slice(0, FIRST).map(figure));
  if (group.length <= FIRST + 2) {
    grid.append(...group.slice(FIRST).map((scan, i) => figure(scan, FIRST + i)));
    return element("div", {}, howManyShown(group, size), grid);
  }
  const more = element("button", { className: "more", textContent: `Show all ${WHOLE.format(group.length)}`, onclick: () => {
    grid.append(...group.slice(FIRST).map((scan, i) => figure(scan, FIRST + i)));
    grid.children[FIRST].focus({ preventScroll: true });
    more.remove();
  } });
  return element("div", {}, howManyShown(group, size), grid, more);
}

const howManyShown = (group, size) => (group.length === size ? ""
  : element("p", { className: "quiet", textContent: `${WHOLE.format(group.length)} of ${WHOLE.format(size)} shown` }));

function lifetimeBar(rank) {
  const concept = concepts[rank], birth = position(concept.birth), death = position(concept.death ?? 1);
  return element("span", { className: "life", title: `The strip is time${isOdds ? ", as below the barcode" : " from 0 to 1"}; `
    + `the bar is this concept's lifetime${isBusiest ? `, the mark the time of the concepts, ${shownTime(filtration.conceptTime)}` : ""}.` },
    element("span", { className: "life-bar", style: { left: `${100 * birth}%`,
      width: `${Math.max(1, 100 * (death - birth))}%`, background: conceptColour(rank) } }),
    isBusiest ? element("span", { className: "life-mark", style: { left: `${100 * position(filtration.conceptTime)}%` } }) : "");
}

function conceptCard(rank) {
  const concept = concepts[rank];
  const mix = concept.mix.slice(0, 5).map(([label, n]) => `${WHOLE.format(n)} ${labels[label]}`).join(", ") + (concept.mix.length > 5 ? " …" : "");
  const death = concept.death === null ? "never dies" : `joins the next at ${shownTime(concept.death)}`;
  const card = element("article", { id: `concept-${rank}`, className: "card", style: { "--colour": conceptColour(rank) } },
    element("header", {},
      element("h3", {}, element("span", { className: "number", textContent: concept.number }), named(conceptName(rank))),
      element("button", { className: "find", textContent: "find it in the figures", onclick: () => {
        change({ selected: rank });
        document.getElementById("how").scrollIntoView({ behavior: "smooth" });
      } })),
    element("dl", {},
      element("div", {}, element("dt", { textContent: "scans" }), element("dd", { textContent: WHOLE.format(concept.size) })),
      element("div", {}, element("dt", { textContent: "lifetime" }), element("dd", {}, lifetimeBar(rank),
        element("span", { className: "quiet", textContent: `born at ${shownTime(concept.birth)}, ${death}` }))),
      hasLabels ? element("div", {}, element("dt", { textContent: "labels" }), element("dd", {}, mixBar(concept),
        element("span", { className: "quiet", textContent: concept.mix.length ? `${mix} · purity ${percent(concept.purity)}` : "none" }))) : ""),
    gallery(concept.members, concept.size, "medoid"));
  onChange(() => card.classList.toggle("is-lit", state.selected === rank));
  return card;
}

function fillConcepts(section) {
  if (concepts.length === 0) return;
  section.append(element("h2", { textContent: "The concepts, one by one" }),
    element("p", { textContent: `${hasLabels ? "The best rank score" : "The largest size × lifetime"} first. In each, the medoid leads and the others `
      + "follow by how much they are like it, so the odd ones out stand last. One colour is one surface that the scan "
      + "was cut into. Below each scan stand its name and its size along three axes of its own. Drag to turn, click to enlarge." }),
  ...concepts.map((_, rank) => conceptCard(rank)));
}

function fillOutside(section) {
  const skipped = new Set(scans.skipped);
  const all = Array.from({ length: nShown }, (_, scan) => scan).filter((scan) => rankOfScan[scan] < 0 && !skipped.has(scan));
  const loners = all.filter((scan) => scans.vertices[scan] >= 0).sort((a, b) => joinTimes[scans.vertices[a]] - joinTimes[scans.vertices[b]]);
  const mute = all.filter((scan) => scans.vertices[scan] < 0);
  if (counts.loners) {
    section.append(element("h2", { textContent: "In no concept" }),
      element("p", { textContent: concepts.length
        ? (isBusiest ? `${plural(counts.loners, "scan")} had not joined ${filtration.minSize - 1} others or more by time ${shownTime(filtration.conceptTime)}. `
          : `${plural(counts.loners, "scan")} found fewer than ${filtration.minSize - 1} others. `) + "Their shapes are rare here, "
          + "in between, or were seen badly." + (isBusiest ? " Those that join another the soonest come first." : "")
        : "There are no concepts, so all scans are here." }),
      element("div", { className: "card" }, gallery(loners, counts.loners)));
  }
  if (counts.mute) {
    section.append(element("h2", { textContent: "Without a place" }),
      element("p", { textContent: `${plural(counts.mute, "scan")} share no motif with any other scan: nothing to compare, so no place in the tree.` }),
      element("div", { className: "card" }, gallery(mute, counts.mute)));
  }
}
