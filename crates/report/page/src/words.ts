// Numbers and units as readers want them.

const PREFIXES: [number, string][] = [
  [1, ""],
  [1e-3, "m"],
  [1e-6, "µ"],
  [1e-9, "n"],
];

/** A unit with a prefix that suits the largest value. */
export interface Unit {
  name: string;
  /** Of the basic unit. */
  factor: number;
}

export function unitFor(largest: number, basic: string): Unit {
  const fit = PREFIXES.find(([factor]) => largest >= factor) ?? PREFIXES[0];
  const [factor, prefix] = largest > 0 && fit ? fit : [1, ""];
  return { name: prefix + basic, factor };
}

/** A number to some digits, with a power of ten where it is very large or small. */
export function show(value: number | null | undefined, digits = 5): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e-3 && size < 1e6) return String(Number(value.toPrecision(digits)));
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
  const power = `10${raised(Number(exponent))}`;
  return Number(mantissa) === 1 ? power : `${Number(mantissa)} · ${power}`;
}

function raised(exponent: number): string {
  const digits = "⁰¹²³⁴⁵⁶⁷⁸⁹";
  return String(exponent).replace(/\d/g, (digit) => digits[Number(digit)] ?? "").replace("-", "⁻");
}

export function withUnit(value: number | null | undefined, basic: string, digits = 5): string {
  if (value === null || value === undefined) return "–";
  const unit = unitFor(Math.abs(value), basic);
  return `${show(value / unit.factor, digits)} ${unit.name}`;
}

/** The place of a point on the axis, with its unit. */
export function place(value: number, parameter: { name: string; unit: string }): string {
  return `${show(value, 7)} ${parameter.unit}`.trim();
}

export function largest(values: Iterable<number | null>): number {
  let most = 0;
  for (const value of values) if (value !== null && Math.abs(value) > most) most = Math.abs(value);
  return most;
}
