// What the page asks for: the names and the checks that decide most scans. One question is kept until it is answered.
let answering = null, keysAsked = new Map();

function placeOfQuestion() {
  const isOld = answering === null || (answering.kind === "name" && !byKey.has(answering.key));
  if (isOld) {
    answering = current.question;
    keysAsked = new Map(answering.scans.map((row) => [row, conceptOf(row)]));
  }
  const { kind, key, scans } = answering;
  // What has been said to be something else is decided.
  const rows = scans.filter((row) => conceptOf(row) === keysAsked.get(row) && !foreign.has(row));
  if (kind === "name") return { kind: "question", key, question: answering, title: "What are these?", sections: [{ heading: null, rows }] };
  const keys = [...new Set(rows.map(conceptOf))].sort((a, b) => a - b);
  return {
    kind: "question", question: answering, isChoosing: true, title: "Which of these are something else?",
    sections: keys.map((of) => ({ key: of, heading: of < 0 ? "In no concept: what are they?" : nameOfKey(of), rows: rows.filter((row) => conceptOf(row) === of) })),
  };
}

function nextQuestion() {
  answering = null;
  if (current.question === null) { say("Nothing is left to ask: what is unsure has been decided."); if (place.kind === "question") go("#"); return; }
  if (place.kind === "question") showPlace(); else go("#question");
}

async function answered(document) {
  if (await tried(document) !== null) nextQuestion();
}

// The rest of the scans that were shown are what they are said to be.
function confirmRest() {
  const rows = place.sections.flatMap((section) => section.rows), rest = rows.filter((row) => conceptOf(row) >= 0);
  if (gallery.chosen().length) moveDialog(gallery.chosen(), () => gallery.focus());
  else if (rest.length) answered({ kind: "confirm", scans: rest });
  else if (rows.length) refused("These are in no concept: choose some, and say what they are (V) or that they are foreign (X).");
  else nextQuestion();
}

// Below the title of the gallery.
function questionBar() {
  const { question, key } = place, decides = question.decides ? ` It decides ${plural(question.decides, "scan")}.` : "";
  if (question.kind === "name") {
    const input = element("input", { type: "text", id: "answer", autocomplete: "off", maxLength: 200, placeholder: "a name", ariaLabel: "What are these?" });
    const twin = () => current.concepts.find((other) => other.key !== key && other.name && other.name === input.value.trim());
    const submit = element("button", { className: "primary", type: "submit", textContent: "Name them" });
    const update = () => { submit.textContent = twin() ? `The same as “${twin().name}”: merge` : "Name them"; };
    input.addEventListener("input", update);
    const form = element("form", { className: "question", onsubmit: (event) => {
      event.preventDefault();
      const name = input.value.trim();
      if (name) answered(twin() ? { kind: "merge", keys: [twin().key, key], name } : { kind: "rename", key, name });
    } }, input, submit, element("button", { type: "button", textContent: "Foreign", title: "They belong to nothing here",
      onclick: () => answered({ kind: "foreign", scans: membersOf(key) }) }),
    suggestedNames(key, (name) => { input.value = name; update(); input.focus(); }),
    element("p", { className: "quiet", textContent: `These ${keysAsked.size} stand for ${plural(membersOf(key).length, "scan")}.${decides}` }));
    return form;
  }
  const n = gallery.chosen().length;
  return element("div", { className: "question" },
    element("button", { className: "primary", type: "button", onclick: confirmRest },
      n ? `Say what the ${n === 1 ? "chosen one is" : `${n} chosen are`} ` : "All of these are right ", element("kbd", { textContent: "Enter" })),
    element("p", { className: "quiet", textContent: `Choose those that are something else, by clicking or with the space bar, and say what they are; then say that the rest is right.${decides}` }));
}
