// Elements of the page, and names in them.
// Text is only ever set as text: names come from files.
function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name === "style") for (const [key, v] of Object.entries(value)) made.style.setProperty(key, v);
    else if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (name in made && name !== "list") made[name] = value;
    else made.setAttribute(name, value);
  }
  made.append(...children.filter((child) => child !== null && child !== undefined && child !== ""));
  return made;
}
const named = (text, className = "") => element("bdi", { className, textContent: text, title: text });
// A name on one line, whose middle is left out where it is too long: folders differ at the begin and files at the end.
const oneLine = (text) => {
  const made = named(text, "one-line");
  placesOfNames.observe(made);
  return made;
};
const ruler = document.createElement("canvas").getContext("2d");
const placesOfNames = new ResizeObserver((places) => {
  for (const { target, contentRect } of places) {
    ruler.font = getComputedStyle(target).font;
    const fits = (most) => ruler.measureText(shortened(target.title, most)).width <= contentRect.width + 0.5;
    let [least, most] = [1, target.title.length];
    if (fits(most)) least = most;
    while (least < most) {
      const middle = (least + most + 1) >> 1;
      if (fits(middle)) least = middle; else most = middle - 1;
    }
    target.textContent = shortened(target.title, least);
  }
});
function shortened(text, most) {
  // Accents, which a Mac writes apart, stay with their letters. In little room the end has more: "031.npy" says which.
  const letters = text.match(/.\p{M}*/gsu) ?? [], nLast = Math.max((most - 1) >> 1, Math.min(8, most - 4));
  return letters.length <= most ? text
    : `${letters.slice(0, most - 1 - nLast).join("")}…${letters.slice(letters.length - nLast).join("")}`;
}

function legend(entries, text = "") {
  return element("p", { className: "legend" }, text, ...entries.map(([colour, text]) => element("span", {},
    element("span", { className: "key", style: { background: colour } }), oneLine(text))));
}
