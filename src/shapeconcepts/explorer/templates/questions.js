// What the page asks for: the names and the checks that decide most scans. One question is kept until it is answered.
let answering = null;

function placeOfQuestion() {
  if (answering === null || !byKey.has(answering.key)) answering = current.question;
  const { kind, key, scans } = answering, name = nameOfKey(key);
  return {
    kind: "question", key, question: answering, isChoosing: kind === "check",
    title: kind === "name" ? "What are these?" : `Which of these are not “${name}”?`,
    sections: [{ heading: null, rows: scans.filter((row) => conceptOf(row) === key) }],
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
  const rest = place.sections[0].rows.filter((row) => !gallery.chosen().includes(row));
  if (gallery.chosen().length) moveDialog(gallery.chosen(), () => gallery.focus());
  else if (rest.length) answered({ kind: "confirm", scans: rest });
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
    element("p", { className: "quiet", textContent: `These ${place.sections[0].rows.length} stand for ${plural(membersOf(key).length, "scan")}.${decides}` }));
    return form;
  }
  const n = gallery.chosen().length;
  return element("div", { className: "question" },
    element("button", { className: "primary", type: "button", onclick: confirmRest },
      n ? `Say what the ${n === 1 ? "chosen one is" : `${n} chosen are`} ` : "All of these are right ", element("kbd", { textContent: "Enter" })),
    element("p", { className: "quiet", textContent: `Choose those that are something else, by clicking or with the space bar, and say what they are; then say that the rest is right.${decides}` }));
}
