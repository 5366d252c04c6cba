// The spanning tree and the filtration graph F.
function mapFigure(heading, text, canvasLabel, options) {
  const canvas = element("canvas", { className: "map", role: "img", ariaLabel: canvasLabel });
  const figure = element("figure", {}, element("h3", { textContent: heading }), canvas,
    element("figcaption", { textContent: text }));
  new DotMap(canvas, options);
  return figure;
}

function treeFigure() {
  const xs = filtration.tree.map(([x]) => x), ys = filtration.tree.map(([, y]) => y);
  const [spanX, spanY] = [xs, ys].map((values) => values.reduce((m, v) => Math.max(m, Math.abs(v)), 0.5) * 2);
  const place = (width, height) => {
    // A tall window gets the tree upright.
    const upright = height > width * 1.05 && spanX > spanY;
    const scale = Math.min((width - 40) / (upright ? spanY : spanX), (height - 48) / (upright ? spanX : spanY), 60);
    return (vertex) => {
      const [x, y] = filtration.tree[vertex];
      return upright ? [width / 2 + y * scale, height / 2 - x * scale] : [width / 2 + x * scale, height / 2 - y * scale];
    };
  };
  return mapFigure("The spanning tree",
    (isSample ? "Every dot is one of the scans shown, and stands for those that join it first; " : "Every dot is a scan; ")
    + "a line joins it to the one most like it, so that all hang together with the least "
    + "difference in total. Only the pattern of the lines counts, not their length. " + (filtration.heatKind === "geodesic"
      ? "A scan is cold where it is many lines away from the rest: the tips of the twigs. The middle, near to all, is hot, "
        + "and there unlike things meet."
      : "Dark lines have joined by now. Coloured by divergence, a dot is the more orange, the later it joins its first "
        + "neighbour: such a scan stands apart.")
      + (nBetween ? " Orange bars are between concepts." : ""),
    `Spanning tree of ${nVertices} places`, { pairs: filtration.edges, walls: filtration.edgesBetween, place });
}

// As in time_scale.py.
const radius = (time) => 0.06 + 0.94 * (isOdds ? 1 - position(time) : Math.sqrt(1 - time));

function graphFigure() {
  const disc = (width, height) => [width / 2, height / 2, Math.min(width, height) / 2 - 24];
  const place = (width, height) => {
    const [cx, cy, r] = disc(width, height);
    return (vertex) => [cx + r * filtration.graph[vertex][0], cy - r * filtration.graph[vertex][1]];
  };
  const backdrop = (context, width, height) => {
    const [cx, cy, r] = disc(width, height);
    const ring = (time, colour, line) => {
      context.beginPath();
      context.arc(cx, cy, r * radius(time), 0, 2 * Math.PI);
      context.strokeStyle = colour;
      context.lineWidth = line;
      context.stroke();
    };
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.font = "11px system-ui, sans-serif";
    for (const [time, text] of isOdds ? [[0, "time 0"], ...ticks(0.13).filter(([at]) => position(at) > 0.08)] : [[0, "time 0"], [0.25, "0.25"], [0.5, "0.5"], [0.75, "0.75"]]) {
      if (time === 1) continue;
      ring(time, theme.ring, 1);
      context.fillStyle = theme.quiet;
      context.fillText(text, cx, cy + r * radius(time) + 8);
    }
    if (isBusiest && filtration.conceptTime !== null) {
      context.setLineDash([5, 5]);
      ring(filtration.conceptTime, theme.accent, 1.2);
      context.setLineDash([]);
    }
    ring(state.time, theme.accent, 2.2);
  };
  return mapFigure("The filtration graph F: who annexed whom",
    "The same dots, now by the time at which each was annexed: early at the rim, late towards the middle, where "
    + (nBetween ? "those are left that were never annexed. A line" : "the one is left that outlives all. A line")
    + " leads to the class that did it. The orange circle is now: every dot outside of it "
    + "has been annexed, and the dots that hang on the same one inside are a group.",
    `Filtration graph F with ${filtration.annexations.length} annexations`,
    { pairs: filtration.annexations, place, backdrop });
}

// Groups at a time: how many classes, how many large enough, and the largest.
function groupsAt(time) {
  const { times, classes, groups, largest } = filtration.classCounts;
  let [first, after] = [0, times.length];
  while (after - first > 1) {
    const middle = (first + after) >> 1;
    if (times[middle] <= time) first = middle; else after = middle;
  }
  return { classes: classes[first], groups: groups[first], largest: largest[first] };
}
