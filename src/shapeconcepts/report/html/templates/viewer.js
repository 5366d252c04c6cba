// One scan, large: drag or arrow keys turn it, Page Up and Page Down leaf through its group.
const viewer = document.getElementById("viewer");

function openViewer(group, at) {
  const scan = group[at];
  const rank = rankOfScan[scan];
  const canvas = element("canvas", { className: "scan", tabIndex: 0 });
  canvas.yaw = canvas.pitch = 0;
  canvas.redraw = () => drawScan(canvas, scan, canvas.yaw, canvas.pitch);
  const label = scans.labels[scan] < 0 ? "" : `labelled “${labels[scans.labels[scan]]}”`;
  const where = rank < 0 ? "in no concept" : `in ${conceptName(rank)}`;
  const step = (by) => openViewer(group, (at + by + group.length) % group.length);
  viewer.replaceChildren(
    element("button", { className: "close", textContent: "×", ariaLabel: "Close", onclick: () => viewer.close() }),
    canvas,
    element("p", {}, named(scans.names[scan], "scan-name")),
    element("p", { className: "quiet", textContent: [where, label, shownSize(scan)].filter(Boolean).join(" · ") }),
    group.length > 1 ? element("p", { className: "steps" },
      element("button", { textContent: "‹ previous", onclick: () => step(-1) }),
      element("span", { className: "quiet", textContent: `${at + 1} of ${group.length}${isSample ? " shown" : ""}` }),
      element("button", { textContent: "next ›", onclick: () => step(1) })) : "",
    element("p", { className: "quiet small", textContent: "Drag or use the arrow keys to turn it. One colour is one surface." }),
  );
  viewer.onkeydown = (event) => {
    const turns = { ArrowLeft: [-20, 0], ArrowRight: [20, 0], ArrowUp: [0, -20], ArrowDown: [0, 20] };
    if (event.key in turns) turnBy(canvas, ...turns[event.key]);
    else if (event.key === "PageDown") step(1);
    else if (event.key === "PageUp") step(-1);
    else return;
    event.preventDefault();
  };
  if (!viewer.open) viewer.showModal();
  if (scans.previews[scan] !== null) {
    turnable(canvas, null);
    canvas.redraw();
  }
  canvas.focus();
}
viewer.addEventListener("click", (event) => { if (event.target === viewer) viewer.close(); });

// A little card beside the pointer: which scan a dot is.
const tip = document.getElementById("tip");
let tipScan = null;
function showTip(scan, clientX, clientY, note) {
  if (scan === null) { tip.hidden = true; tipScan = null; return; }
  if (scan !== tipScan) {
    const rank = rankOfScan[scan];
    const canvas = element("canvas", { className: "scan" });
    const label = scans.labels[scan] < 0 ? "" : ` · ${labels[scans.labels[scan]]}`;
    tip.hidden = false;
    tip.replaceChildren(
      scans.previews[scan] === null ? "" : canvas,
      element("div", {}, named(scans.names[scan], "scan-name"),
        element("div", { className: "quiet" },
          element("span", { className: "key", style: { background: conceptColour(rank) } }),
          (rank < 0 ? "no concept" : conceptName(rank)) + label),
        element("div", { className: "quiet", textContent: shownSize(scan) }),
        element("div", { className: "quiet", textContent: note })));
    if (scans.previews[scan] !== null) drawScan(canvas, scan, 0, 0);
    tipScan = scan;
  }
  const box = tip.getBoundingClientRect();
  const left = clientX + 16 + box.width > window.innerWidth ? clientX - 16 - box.width : clientX + 16;
  tip.style.left = `${Math.max(4, left)}px`;
  // On a narrow window it would cover what it is about.
  const middle = window.innerWidth < 600 ? clientY - box.height / 2 - 24 : clientY;
  tip.style.top = `${Math.max(4, Math.min(middle - box.height / 2, window.innerHeight - box.height - 4))}px`;
}
window.addEventListener("scroll", () => showTip(null), { passive: true });
