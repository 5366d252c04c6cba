// The colours of concepts, labels and drawings.
// Categorical colours that colour-blind readers tell apart too (P. Tol's "muted"; Okabe and Ito's, and what lies
// farthest from those in CIELAB under normal and simulated red- and green-blind vision).
// Numbers say what colours cannot where there are more concepts than colours.
const CONCEPT_COLOURS = ["#332288", "#cc6677", "#117733", "#ddaa33", "#88ccee", "#882255", "#44aa99", "#999933", "#aa4499", "#3f78c9"];
const LABEL_COLOURS = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#554400", "#bbcc66",
  "#ee1155", "#112299", "#ffbb99", "#990088", "#662222", "#88ccb0", "#7700cc", "#7f8794",
  "#660044", "#aa66ff", "#99ddee", "#0000ff", "#dddd55", "#884466", "#007733", "#ff2244"];
const NONE_COLOUR = "#b9bcc4";

// Drawings have the colours of the page's style, which may be light or dark.
const theme = {};
function readTheme() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ["ink", "quiet", "accent", "card", "faint", "joined", "ring", "coarse", "past", "future"]) {
    theme[name] = style.getPropertyValue(`--${name}`).trim();
  }
}
readTheme();

// A canvas as sharp as the screen; returns its context in CSS pixels.
function sharpContext(canvas, width, height) {
  const ratio = Math.min(window.devicePixelRatio || 1, 2);
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return context;
}
