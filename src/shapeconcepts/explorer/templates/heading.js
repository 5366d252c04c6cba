// Above the gallery: what it shows, and what can be done with it.
(() => {
  const middle = document.getElementById("middle");
  const name = element("div", { className: "place-name" }), tools = element("div", { className: "tools", role: "toolbar", ariaLabel: "Actions" });
  const extra = element("div", {});
  const orders = element("select", { ariaLabel: "Order", onchange: () => { setOrder(orders.value); } },
    ...ORDERS.map(([value, textContent]) => element("option", { value, textContent })));
  middle.append(element("div", { className: "place" }, element("div", { className: "place-title" }, name, orders), tools, extra), gallery.root);

  function setOrder(value) {
    order = value;
    showPlace();
    if (value === "size") measure(place.sections.flatMap((section) => section.rows));
  }
  // Sizes come with the previews: those that are not here yet are asked for, and put in their places.
  async function measure(rows) {
    const unknown = rows.filter((row) => !records.has(row)).slice(0, 2000);
    for (let at = 0; at < unknown.length && order === "size"; at += BATCH) await fetchBatch(unknown.slice(at, at + BATCH));
    if (order === "size" && unknown.length) { place = passing ?? placeAt(location.hash); showGallery(false); }
  }

  function fillTools() {
    const n = gallery.chosen().length, ids = ACTIONS.filter(({ on }) => (on === "concept" && place.key !== undefined) || (on === "scans" && n > 0))
      .filter(({ id, isRare, can }) => (isRare ? can() : id !== "name" || place.kind === "concept")).map(({ id }) => id);
    refilled(tools, ...ids.filter((id) => actionOf.get(id).on === "concept").map(actionButton),
      n ? element("span", { className: "chosen", textContent: `${WHOLE.format(n)} chosen` }) : "",
      ...ids.filter((id) => actionOf.get(id).on === "scans").map(actionButton));
    orders.hidden = place.kind === "question" || place.kind === "uncertain";
  }
  let questionShown = null;
  function fillExtra() {
    if (place.kind !== "question") { questionShown = null; extra.replaceChildren(); return; }
    // What was typed stays while others change the model.
    if (place.question.kind === "name" && questionShown === place.question) return;
    questionShown = place.question;
    const isFocused = extra.contains(document.activeElement);
    extra.replaceChildren(questionBar());
    if (place.question.kind === "name") document.getElementById("answer").focus();
    else if (isFocused) gallery.focus();
  }

  const total = () => place.sections.reduce((sum, section) => sum + section.rows.length, 0);
  function fillTitle() {
    const concept = byKey.get(place.key);
    const note = [place.note, plural(total(), "scan"), concept && place.kind === "concept" && concept.suggested ? concept.suggested : ""].filter(Boolean).join(" · ");
    name.replaceChildren(
      element("h2", { style: { "--colour": concept ? colourOfKey(place.key) : "transparent" } }, concept && place.kind === "concept" ? element("span", { className: "swatch" }) : "", named(place.title)),
      element("span", { className: "quiet place-note", textContent: note }));
    orders.value = order;
  }

  let shownKey = null;
  function showGallery(isNew) {
    gallery.show(place.sections, { mixed: Boolean(place.isMixed), isNew, message: emptyText() });
  }
  const emptyText = () => ({ uncertain: current.isThinking ? "Still reckoning which scans are uncertain …" : "No scan is near to another concept.",
    none: "Every scan is in a concept.", foreign: "No scan is marked as foreign.", search: "No name, path or concept has these words.",
    question: "All of these have been decided." }[place.kind] ?? "No scans here.");
  onPlace(() => {
    const key = passing ? "passing" : `${location.hash} ${order} ${place.question ? `${place.question.kind}${place.question.scans}` : ""}`;
    fillTitle();
    showGallery(key !== shownKey);
    shownKey = key;
    fillTools();
    fillExtra();
  });
  gallery.onSelection(() => { fillTools(); if (place.isChoosing) fillExtra(); });
})();
