// Chooses a concept by typing some of its name: a field with a list below, of which the arrow keys choose.
// `choices`: text -> [{ label, key | null, note }]; `choose` is called with the one that was taken.
function conceptPicker(label, choices) {
  const list = element("ul", { id: "picker-list", className: "picker", role: "listbox", ariaLabel: label });
  const input = element("input", { type: "text", autocomplete: "off", role: "combobox", ariaExpanded: "true", maxLength: 200 });
  input.setAttribute("aria-controls", "picker-list");
  input.dataset.first = "";
  let shown = [], at = 0;
  const update = () => {
    [...list.children].forEach((one, k) => one.setAttribute("aria-selected", k === at));
    input.setAttribute("aria-activedescendant", shown.length ? `choice-${at}` : "");
    list.children[at]?.scrollIntoView({ block: "nearest" });
  };
  const fillList = () => {
    shown = choices(input.value.trim());
    at = 0;
    list.replaceChildren(...shown.map((choice, k) => {
      const canvas = element("canvas", { className: "picker-picture" });
      if (choice.key !== null) showPreview(canvas, byKey.get(choice.key).medoid, 36);
      return element("li", { id: `choice-${k}`, role: "option", style: { "--colour": choice.key === null ? "transparent" : colourOfKey(choice.key) },
        onclick: () => { at = k; update(); input.form.requestSubmit(); } },
      choice.key === null ? element("span", { className: "picker-picture picker-new", textContent: "+" }) : canvas,
      named(choice.label), element("span", { className: "quiet", textContent: choice.note }));
    }));
    update();
  };
  input.addEventListener("input", fillList);
  input.addEventListener("keydown", (event) => {
    const by = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (by === undefined || !shown.length) return;
    event.preventDefault();
    at = (at + by + shown.length) % shown.length;
    update();
  });
  fillList();
  return { node: element("div", {}, field(label, input), list), input, taken: () => shown[at] ?? null };
}

// Concepts whose names hold what was typed, the nearest to some scan first where that is known.
function conceptsLike(text, without = []) {
  const wanted = text.toLowerCase();
  return current.concepts.filter(({ key }) => !without.includes(key) && nameOfKey(key).toLowerCase().includes(wanted))
    .map(({ key, size }) => ({ key, label: nameOfKey(key), note: plural(size, "scan") }))
    .sort((a, b) => Number(b.label.toLowerCase().startsWith(wanted)) - Number(a.label.toLowerCase().startsWith(wanted)));
}
