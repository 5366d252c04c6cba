// Numbers as people read them.
// Made once: `toLocaleString` makes one for each number, which takes seconds for thousands of scans.
const [WHOLE, ONE_DIGIT, UP_TO_TWO_DIGITS] = [[0, 0], [1, 1], [0, 2]].map(([least, most]) =>
  new Intl.NumberFormat("en", { minimumFractionDigits: least, maximumFractionDigits: most }));
// The unit is that of the longest side: a file in millimetres that was read as metres is seen at once.
function shownSides(sides) {
  if (sides === null) return "";
  const [unit, metres] = sides[0] < 0.01 ? ["mm", 0.001] : sides[0] < 1 ? ["cm", 0.01] : ["m", 1];
  const number = (side) => {
    const value = side / metres;
    return (value < 0.95 ? UP_TO_TWO_DIGITS : value < 9.95 ? ONE_DIGIT : WHOLE).format(value);
  };
  return `${sides.map(number).join(" × ")}\u00a0${unit}`;
}
const plural = (n, one, many = one + "s") => `${WHOLE.format(n)} ${n === 1 ? one : many}`;
const percent = (share) => `${Math.round(100 * share)} %`;
