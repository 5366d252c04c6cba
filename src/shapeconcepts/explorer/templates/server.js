// What the page asks of the server, which holds the model.
class Refusal extends Error {}

async function asked(path, options = {}) {
  const answer = await fetch(`api/${path}`, { cache: "no-store", ...options });
  if (answer.ok) return answer;
  const { error, status } = await answer.json().catch(() => ({}));
  throw Object.assign(new Refusal(error ?? status ?? `the server answered ${answer.status}`), { status: answer.status });
}

const pause = (milliseconds) => new Promise((done) => { setTimeout(done, milliseconds); });

// The server is there before the model is read.
async function awaited(path) {
  for (;;) {
    try {
      return await (await asked(path)).json();
    } catch (refusal) {
      if (refusal.status !== 503) throw refusal;
      await pause(60);
    }
  }
}

async function posted(path, document) {
  const body = JSON.stringify(document);
  return (await asked(path, { method: "POST", headers: { "Content-Type": "application/json" }, body })).json();
}

// Another window, or another process, may change the model.
function listen(onVersion, onReach) {
  const events = new EventSource("api/events");
  events.onmessage = (event) => onVersion(Number(event.data));
  events.onopen = () => onReach(true);
  events.onerror = () => onReach(false);
}
