// Sizes of concepts after each update, on a line of time for each identity.
const EVENT_WORDS = { born: "born", split: "split", merged: "joined", dissolved: "gone" };

function historyCell(concept, at, largest) {
  const size = concept.sizes[at], event = concept.events[at];
  const others = event === null ? "" : event.others.map((key) => `key ${key}`).join(", ");
  const word = event === null ? "" : EVENT_WORDS[event.kind] || "";
  return element("td", { title: word ? `${word} ${others}`.trim() : "" },
    element("span", { className: "history-bar", style: { width: `${100 * size / largest}%` } }),
    element("span", { textContent: size ? size.toLocaleString("en") : word === "" ? "" : "–" }),
    word ? element("span", { className: "history-event", textContent: others && event.kind !== "born" ? `${word} ${others}` : word }) : "");
}

function fillHistory(section) {
  const { scans: counts, concepts: identities } = contents.history;
  if (counts.length === 0) return;
  const largest = Math.max(1, ...identities.flatMap((concept) => concept.sizes));
  const head = counts.map((count, at) => element("th", { scope: "col", textContent: at === 0 ? `${count.toLocaleString("en")} scans` : `${count.toLocaleString("en")}` }));
  const rows = identities.map((concept) => element("tr", {},
    element("th", { scope: "row" }, named(concept.name || `key ${concept.key}`)),
    ...counts.map((_, at) => historyCell(concept, at, largest))));
  section.append(
    element("h2", { textContent: "How it grew" }),
    element("p", { textContent: `The model has learned on ${counts.length === 2 ? "once" : `${counts.length - 1} times`} here. Each line is a concept by the key that it keeps, `
      + "each column the number of scans after an update; bars are how many of them the concept had." }),
    element("div", { className: "card history" }, element("table", {}, element("tr", {}, element("th", {}), ...head), ...rows)));
}
