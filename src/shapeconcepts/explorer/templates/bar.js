// At the top: the views, the search, and what concerns the whole model.
const VIEWS = [["scans", "Scans"], ["figures", "Figures"], ["journal", "Journal"]];
const openedView = () => VIEWS.find(([id]) => !document.getElementById(id).hidden)[0];
let fillBar = () => {};

function openView(view) {
  closeSheets();
  for (const [id] of VIEWS) document.getElementById(id).hidden = id !== view;
  document.getElementById("tip").hidden = true;
  fillBar();
  if (view === "figures") figuresView.fill();
  if (view === "scans") gallery.focus();
}

(() => {
  const bar = document.getElementById("bar");
  const views = element("nav", { className: "views", ariaLabel: "Views" });
  const search = element("input", { type: "search", id: "search", placeholder: "Search  /", ariaLabel: "Search names, paths and concepts", autocomplete: "off", spellcheck: false });
  const title = element("span", { className: "model-title" }), tools = element("div", { className: "bar-tools" });
  bar.append(element("button", { type: "button", className: "open-lists", textContent: "☰", ariaLabel: "Concepts and lists", onclick: openListSheet }),
    element("span", { className: "brand" }, element("span", { className: "kicker", textContent: "shapeconcepts" }), title), views, search, tools);

  let before = "#";
  search.addEventListener("input", () => {
    const text = search.value.trim(), isSearch = location.hash.startsWith("#search/");
    if (!isSearch) before = location.hash || "#";
    passing = null;
    // One step back leaves the search, however much was typed.
    if (!text) history.replaceState(null, "", before);
    else history[isSearch ? "replaceState" : "pushState"](null, "", `#search/${encodeURIComponent(text)}`);
    if (openedView() !== "scans") { openView("scans"); search.focus(); }
    showPlace();
  });
  search.addEventListener("keydown", (event) => {
    if (event.key === "Enter" || event.key === "ArrowDown") { event.preventDefault(); gallery.focus(); }
    else if (event.key === "Escape") { event.preventDefault(); event.stopPropagation(); search.value = ""; if (location.hash.startsWith("#search/")) go(before); gallery.focus(); }
  });
  onPlace(() => { if (place.kind !== "search" && document.activeElement !== search) search.value = ""; });

  fillBar = () => {
    if (current === null) return;
    const misfits = unfit().length;
    title.replaceChildren(oneLine(known.title));
    refilled(views, ...VIEWS.map(([id, text]) => {
      const button = element("button", { type: "button", id: `view-${id}`, onclick: () => openView(id) }, text,
        id === "journal" && current.nEdits ? element("span", { className: "count", textContent: WHOLE.format(current.nEdits) }) : "",
        id === "journal" && misfits ? element("span", { className: "warning", textContent: `⚠ ${misfits}`, title: `${plural(misfits, "edit")} no longer fit` }) : "");
      if (openedView() === id) button.setAttribute("aria-current", "page");
      return button;
    }));
    refilled(tools, ...["undo", "redo", "question", "propagate", "export", "help"].map(actionButton));
    document.getElementById("do-question").classList.toggle("primary", current.question !== null);
  };
  onCurrent(fillBar);
})();
