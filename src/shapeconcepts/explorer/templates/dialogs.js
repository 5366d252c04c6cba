// One dialog at a time; Escape leaves it, and the keyboard goes back to where it was.
const dialog = document.getElementById("dialog");

function openDialog(title, ...children) {
  const back = document.activeElement;
  dialog.onclose = () => { if (back?.isConnected && back !== document.body) back.focus({ preventScroll: true }); else gallery.focus(); };
  dialog.setAttribute("aria-labelledby", "dialog-title");
  dialog.replaceChildren(
    element("h2", { id: "dialog-title", textContent: title }),
    element("button", { className: "close", type: "button", ariaLabel: "Close", textContent: "×", onclick: () => dialog.close() }),
    ...children);
  if (!dialog.open) dialog.showModal();
  (dialog.querySelector("[data-first]") ?? dialog.querySelector("input, select, button:not(.close)"))?.focus();
}
// At once: the browser's own way lets the next key pass by before it has closed.
dialog.addEventListener("keydown", (event) => {
  if (event.key !== "Escape") return;
  event.preventDefault();
  event.stopPropagation();
  dialog.close();
});
dialog.addEventListener("click", (event) => { if (event.target === dialog) dialog.close(); });

// A form of a dialog: `act` may refuse, which is said in the dialog.
function dialogForm(act, submit, ...children) {
  const refusal = element("p", { className: "refusal", role: "alert" });
  const form = element("form", { method: "dialog" }, ...children, refusal, element("p", { className: "dialog-end" },
    element("button", { type: "button", textContent: "Cancel", onclick: () => dialog.close() }), submit));
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    refusal.textContent = "";
    submit.disabled = true;
    try {
      if (await act() !== false) dialog.close();
    } catch (failure) {
      refusal.textContent = failure.message;
    }
    submit.disabled = false;
  });
  return form;
}
const submitButton = (textContent) => element("button", { className: "primary", type: "submit", textContent });
const field = (label, input, note = "") => element("label", { className: "field" }, element("span", { textContent: label }), input,
  note ? element("span", { className: "quiet small", textContent: note }) : "");

// Said for a while, below everything; `again` offers to undo.
const said = document.getElementById("said");
let saidTimer = null;
function say(text, canUndo = false) {
  clearTimeout(saidTimer);
  said.hidden = false;
  said.replaceChildren(element("bdi", { textContent: text }),
    canUndo ? element("button", { type: "button", textContent: "Undo", title: "Ctrl-Z", onclick: () => edit({ kind: "undo" }) }) : "");
  saidTimer = setTimeout(() => { said.hidden = true; }, 7000);
}
