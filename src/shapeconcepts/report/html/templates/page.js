// The page from top to bottom.
function fact(number, text) {
  return element("div", { className: "fact" }, element("strong", { textContent: WHOLE.format(number) }), element("span", { textContent: text }));
}

function fillHeader(header) {
  const nScans = counts.scans, nSkipped = contents.skipped.length, nUnread = contents.unread.length;
  header.append(
    element("p", { className: "kicker", textContent: "shapeconcepts" }),
    element("h1", {}, named(contents.title)),
    element("p", { className: "lead", textContent: concepts.length
      ? `${plural(nScans, "scan")} went in, no label was looked at, and these shapes turned out to belong together.`
      : `${plural(nScans + nUnread, "scan")}, and no group among them that holds its own.` }),
    element("div", { className: "facts" },
      fact(nScans + nUnread, nScans + nUnread === 1 ? "scan" : "scans"),
      fact(concepts.length, concepts.length === 1 ? "concept" : "concepts"),
      fact(counts.inConcepts, "in a concept"),
      fact(nUsed - counts.inConcepts, "in none"),
      fact(nSkipped + nUnread, "left out")),
    isSample ? element("p", { id: "sample", textContent: `Shown are ${WHOLE.format(nShown)} of ${plural(nUsed, "scan")}, drawn `
      + (concepts.length ? "in proportion from each concept, and more from small ones. " : "at random. ") + "All numbers are those of all scans." }) : "");
}

function fillHow(section) {
  if (nVertices < 2) return;
  section.append(
    element("div", { className: "narrow" }, element("h2", { textContent: concepts.length ? "How they came about" : "How the scans hang together" }),
      element("p", { textContent: "What each scan is made of becomes a vector of stimuli, and scans with like stimuli are neighbours. "
        + (filtration.heatKind === "geodesic"
          ? "Then time runs: from the coldest twigs to the hot middle, neighbours join, and the larger group annexes the smaller. "
          : "Then time runs: neighbouring groups join, those first whose scans diverge least on average, and the larger annexes the smaller. ")
        + (isBusiest ? "At time 0 every scan is alone, at time 1 all are one; concepts lie in between. Pull the time and watch."
          : "Groups with a gap between them that chance does not explain, and little in common, stay apart; what is left at time 1 are the concepts. Pull the time and watch.") })),
    ...figures());
}

function table(title, rows) {
  return element("div", { className: "card" }, element("h3", { textContent: title }), element("table", {},
    ...rows.map(([name, text]) => element("tr", {}, element("th", { scope: "row" }, named(name)), element("td", {}, element("bdi", { textContent: text }))))));
}

function fillLeftOut(section) {
  if (contents.skipped.length + contents.unread.length === 0) return;
  section.append(element("h2", { textContent: "Left out" }));
  if (contents.unread.length) section.append(table(`${plural(contents.unread.length, "file")} could not be read`, contents.unread));
  if (contents.skipped.length) section.append(table(`${plural(contents.skipped.length, "scan")} could not be cut into surfaces`, contents.skipped));
}

function fillMade(section) {
  section.append(element("h2", { textContent: "How this was made" }),
    contents.reading.length ? table("Options for reading the scans", contents.reading) : "",
    table(`shapeconcepts ${contents.version}, with these parameters`, contents.parameters),
    element("p", { className: "quiet", textContent: "The method is that of C. A. Mueller and A. Birk, Conceptualization of Object "
      + "Compositions Using Persistent Homology, IROS 2018. This file needs no network." }));
}

function followSelection(bar) {
  onChange(() => {
    const rank = state.selected;
    bar.hidden = rank === null;
    if (rank === null) return;
    const go = (id) => () => document.getElementById(id).scrollIntoView({ behavior: "smooth" });
    bar.replaceChildren(element("span", { className: "key", style: { background: conceptColour(rank) } }), oneLine(conceptName(rank)),
      element("span", { className: "quiet", textContent: plural(concepts[rank].size, "scan") }),
      element("button", { textContent: "figures", onclick: go("how") }),
      element("button", { textContent: "its scans", onclick: go(`concept-${rank}`) }),
      element("button", { textContent: "×", ariaLabel: "Let go of this concept", onclick: () => change({ selected: null }) }));
  });
  document.addEventListener("keydown", (event) => { if (event.key === "Escape" && !viewer.open) change({ selected: null }); });
}

fillHeader(document.getElementById("top"));
fillGlance(document.getElementById("glance"));
fillHow(document.getElementById("how"));
fillConcepts(document.getElementById("concepts"));
fillOutside(document.getElementById("outside"));
fillHistory(document.getElementById("history"));
fillLeftOut(document.getElementById("left-out"));
fillMade(document.getElementById("made"));
followSelection(document.getElementById("selection"));
// Two frames on, what is in sight has been drawn; the milliseconds since the file was opened are kept.
requestAnimationFrame(() => requestAnimationFrame(() => {
  document.documentElement.dataset.ready = Math.round(performance.now());
}));
