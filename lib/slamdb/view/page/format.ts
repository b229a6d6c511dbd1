// Numbers as people read them; the same grouping as the command's.

/** 14061 -> "14,061" */
export function grouped(value: number): string {
  const text = String(Math.round(Math.abs(value)));
  const sign = value < -0.5 ? "-" : "";
  return sign + text.replace(/\B(?=(\d{3})+$)/g, ",");
}

export const counted = (count: number, one: string, many = `${one}s`): string => `${grouped(count)} ${count === 1 ? one : many}`;

/** Four significant digits, without an exponent where one is not needed: 30.23, 0.0123, 12,345. */
export function rounded(value: number, digits = 4): string {
  if (!Number.isFinite(value)) return "unknown";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 10 ** digits && size < 1e15) return grouped(value);
  if (size >= 1e15 || size < 1e-6) return value.toExponential(digits - 1);
  return String(Number(value.toPrecision(digits)));
}

/** What was stored in steps, without the digits that a step does not tell: 30.2345 in steps of 0.05 -> 30.2. */
export function measured(value: number, step: number): number {
  if (!(step > 0)) return value;
  const place = Math.ceil(Math.log10(step));
  return place < 0 ? Number(value.toFixed(Math.min(100, -place))) : Math.round(value / 10 ** place) * 10 ** place;
}

export const lengthText = (value: number, unit: string): string => `${rounded(value)} ${unit}`;

/** 17.9 s, 1 min 15 s, 11 h 6 min: rounded before it is split, as DurationText of base/detail/amounts.h does. */
export function durationText(seconds: number): string {
  if (!Number.isFinite(seconds)) return "unknown";
  if (seconds < 59.95) return `${rounded(seconds, 3)} s`;
  const whole = Math.round(seconds);
  if (whole < 3600) return `${Math.floor(whole / 60)} min ${whole % 60} s`;
  return `${grouped(Math.floor(whole / 3600))} h ${Math.floor((whole % 3600) / 60)} min`;
}

/** The largest of 1, 2, 5 times a power of ten that is not above `value`. */
export function roundStep(value: number): number {
  if (!(value > 0) || !Number.isFinite(value)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  const lead = value / power;
  return (lead >= 5 ? 5 : lead >= 2 ? 2 : 1) * power;
}

/** A length of `roundStep` with its unit, small ones in cm and mm where the unit is the metre. */
export function stepText(step: number, unit: string): string {
  if (unit !== "m") return `${rounded(step)} ${unit}`;
  if (step >= 1000) return `${rounded(step / 1000)} km`;
  if (step >= 1) return `${rounded(step)} m`;
  return step >= 0.01 ? `${rounded(step * 100)} cm` : `${rounded(step * 1000)} mm`;
}
