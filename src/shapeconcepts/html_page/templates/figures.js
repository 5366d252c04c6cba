// All figures of the filtration, and what moves them.
function colouringChoice() {
  const choices = [["concept", "concept"], ...(hasLabels ? [["label", "label"]] : []), ["heat", heatName]];
  const key = element("span", {});
  const fillKey = () => {
    if (state.colouring === "heat") {
      key.replaceChildren(element("span", { className: "legend" }, filtration.heatKind === "geodesic" ? "cold" : "joins early",
        element("span", { className: "ramp", style: { background: `linear-gradient(to right, ${[0, 0.5, 1].map(heatColour).join(",")})` } }), filtration.heatKind === "geodesic" ? "hot" : "stands apart"));
    } else if (state.colouring === "label") {
      key.replaceChildren(legend(labels.map((label, i) => [labelColour(i), label])));
    } else key.replaceChildren(element("span", { className: "quiet small", textContent: "grey: in no concept" }));
  };
  onChange(fillKey);
  fillKey();
  return element("fieldset", {}, element("legend", { textContent: "Colour by" }), ...choices.map(([value, text]) => element("label", {},
    element("input", { type: "radio", name: "colouring", value, checked: value === state.colouring,
      onchange: () => change({ colouring: value }) }), text)), key);
}

function timeControl() {
  const slider = element("input", { type: "range", min: 0, max: 1, step: 0.001, ariaLabel: "Time of the filtration",
    oninput: () => { stop(); change({ time: timeAt(Number(slider.value)) }); } });
  const note = element("output", {});
  let playing = null;
  const stop = () => { cancelAnimationFrame(playing); playing = null; play.textContent = "▶ play"; };
  const play = element("button", { textContent: "▶ play", onclick: () => {
    if (playing !== null) { stop(); return; }
    play.textContent = "❚❚ pause";
    const start = performance.now(), from = state.time >= 1 || state.time === filtration.conceptTime ? 0 : position(state.time);
    const advance = (now) => {
      const at = Math.min(1, from + (now - start) / 9000);
      change({ time: timeAt(at) });
      if (at >= 1) stop();
      else playing = requestAnimationFrame(advance);
    };
    playing = requestAnimationFrame(advance);
  } });
  const back = filtration.conceptTime === null ? "" : element("button", { textContent: isBusiest ? "to ε_max" : "to the concepts",
    onclick: () => { stop(); change({ time: filtration.conceptTime }); } });
  const update = () => {
    const { classes, groups, largest } = groupsAt(state.time);
    slider.value = position(state.time);
    slider.setAttribute("aria-valuetext", `time ${shownTime(state.time)}`);
    note.textContent = `time ${shownTime(state.time)}: ${plural(classes, "class", "classes")}, of which ${WHOLE.format(groups)} `
      + `${groups === 1 ? "has" : "have"} at least ${filtration.minSize} scans; the largest has ${WHOLE.format(largest)}`;
  };
  onChange(update);
  update();
  return element("div", { className: "time" }, play, slider, back, note);
}

const figures = () => [
  element("div", { className: "controls" }, timeControl(), colouringChoice()),
  element("div", { className: "pair" }, treeFigure(), graphFigure()),
  timelineFigure(),
  groups.length > 1 ? granularityFigure() : "",
];
