// From the first answer of the server on.
window.addEventListener("hashchange", () => { passing = null; if (current !== null) { showPlace(); } });
onCurrent(() => { if (passing === null) showPlace(); });
// Of which version of the model it is, and how many edits are in force, for who looks on from outside.
onCurrent(() => {
  document.body.dataset.model = known.modelVersion;
  document.body.dataset.edits = current.journal.filter((edit) => !edit.undone).length;
});
onCurrent(() => { if (current.trouble) refused(current.trouble); });

// Until what was announced is here: more may be announced meanwhile.
let announced = 0, isAsking = false;
async function follow(version) {
  announced = Math.max(announced, version);
  if (isAsking) return;
  isAsking = true;
  try {
    while (current.version < announced) {
      const state = await awaited("state");
      // Another process learned on: the scans are others, too.
      if (state.modelVersion !== current.modelVersion) takeModel(await awaited("model"));
      takeState(state);
    }
  } finally {
    isAsking = false;
  }
}

async function start() {
  let model, state;
  // More may be known by the time of the second answer.
  do [model, state] = await Promise.all([awaited("model"), awaited("state")]); while (model.modelVersion !== state.modelVersion);
  takeModel(model);
  document.title = `${known.title} · shapeconcepts`;
  document.getElementById("reading").remove();
  document.getElementById("views").classList.add("is-read");
  takeState(state);
  gallery.focus();
  requestAnimationFrame(() => requestAnimationFrame(() => { document.documentElement.dataset.ready = Math.round(performance.now()); }));
  listen(follow, (isThere) => {
    document.body.classList.toggle("is-alone", !isThere);
    if (!isThere) refused("The server does not answer. What you see stays, but nothing can be changed until it is back.");
    else if (!trouble.hidden) trouble.hidden = true;
  });
}
start().catch((failure) => { document.getElementById("reading").textContent = failure.message; });
