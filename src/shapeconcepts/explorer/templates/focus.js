// Fills an element anew, and leaves the keyboard where it was in it.
function refilled(box, ...children) {
  const stops = () => [...box.querySelectorAll("a, button, input, select, [tabindex]")];
  const at = stops().indexOf(document.activeElement), { id } = document.activeElement ?? {};
  box.replaceChildren(...children);
  if (at < 0) return;
  const now = stops(), same = id ? now.find((stop) => stop.id === id) : undefined;
  (same ?? now[Math.min(at, now.length - 1)])?.focus({ preventScroll: true });
}
