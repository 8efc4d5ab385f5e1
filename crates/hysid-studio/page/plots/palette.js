// Colours of curves and axes, the same as in Hysid's reports, for a light and a dark page.

const LIGHT = {
  page: "#ffffff", text: "#1b1f24", axis: "#57606a", grid: "#e3e6ea",
  data: "#3f6d9e", measured: "#a3afbb", simulated: "#0a5fd1", input: "#1a7f4b", error: "#c2410c", faint: "#b6bdc6",
  band: "#0a5fd12e", mark: "#c2410c",
  series: ["#0a5fd1", "#c2410c", "#1a7f4b", "#7d3fb0", "#a16207", "#0e7490"],
};
const DARK = {
  page: "#14171c", text: "#e3e7ec", axis: "#9aa4af", grid: "#2a3037",
  data: "#8fb8e6", measured: "#74808d", simulated: "#62a8ff", input: "#4cc38a", error: "#ff8a5c", faint: "#5b6470",
  band: "#62a8ff3d", mark: "#ff8a5c",
  series: ["#62a8ff", "#ff8a5c", "#4cc38a", "#c49bf0", "#e0b04a", "#5cc5d6"],
};
const dark = matchMedia("(prefers-color-scheme: dark)");

/** The colours of the page as it is now. */
export const palette = () => (dark.matches ? DARK : LIGHT);

/** The colours of saved pictures. */
export const lightPalette = LIGHT;

/**
 * The colour of a role (`measured`, `simulated` ...) or of the n-th series (`series 2`).
 * @param {string} role
 * @param {typeof LIGHT} colours
 */
export function colour(role, colours) {
  if (role.startsWith("series")) return colours.series[Number(role.split(" ")[1]) % colours.series.length];
  return colours[role];
}

/** Calls the function when the page turns dark or light. */
export function whenColoursChange(listener) {
  dark.addEventListener("change", listener);
  return () => dark.removeEventListener("change", listener);
}
