// Numbers as text: significant digits, a true minus sign, bytes and durations.

/**
 * A number with so many significant digits; nothing for a missing one.
 * @param {number | null | undefined} value
 * @param {number} [digits]
 */
export function written(value, digits = 4) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "";
  if (value === 0) return "0";
  const exponent = Math.floor(Math.log10(Math.abs(value)));
  const rounded = Number(value.toPrecision(digits));
  const text = exponent < -4 || exponent >= Math.max(6, digits) ? rounded.toExponential() : String(rounded);
  return text.replaceAll("-", "\u2212");
}

/** An error in percent: two decimals below 1, else three digits. */
export function percent(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "\u2013";
  return `${written(value, Math.abs(value) < 1 ? 2 : 3)}\u202f%`;
}

/** A whole number with thin spaces between thousands. */
export function counted(value) {
  return Math.round(value).toString().replace(/\B(?=(\d{3})+(?!\d))/g, "\u202f");
}

/** A size of a file. */
export function bytes(value) {
  if (value < 1000) return `${value} B`;
  const power = Math.min(Math.floor(Math.log10(value) / 3), 3);
  return `${written(value / 1000 ** power, 3)} ${["", "kB", "MB", "GB"][power]}`;
}

/** A duration in seconds, or in minutes and seconds. */
export function duration(seconds) {
  if (seconds === null || seconds === undefined) return "";
  if (seconds < 60) return `${written(seconds, 2)} s`;
  const whole = Math.round(seconds);
  return `${Math.floor(whole / 60)} min ${whole % 60} s`;
}

/** The texts of the ticks of an axis with this step between them. */
export function tickTexts(values, step) {
  const largest = Math.max(...values.map(Math.abs));
  const plain = step >= 1e-4 && largest < 1e6;
  // As many decimals as the step has: 2 for 0.25.
  let decimals = Math.min(Math.max(Math.ceil(-Math.log10(step) - 1e-9), 0), 12);
  if (Math.abs(step * 10 ** decimals - Math.round(step * 10 ** decimals)) > 1e-6) decimals += 1;
  return values.map((value) => {
    const shown = Math.abs(value) < 1e-9 * step ? 0 : value;
    return plain ? shown.toFixed(decimals).replace("-", "\u2212") : written(shown, 4);
  });
}

/** Words as a sentence. */
export const sentence = (words) => `${words[0].toUpperCase()}${words.slice(1)}.`;
