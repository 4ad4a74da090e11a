// SPDX-License-Identifier: MIT
// How numbers are written: true minus signs, powers of ten as superscripts, narrow spaces between
// thousands, and as many digits as the quantity deserves.

const kMinus = "\u2212";
const kNarrowSpace = "\u202f";
const kNone = "\u2013";

// 1234567 as "1 234 567".
function grouped(digits) {
  return digits.replace(/\B(?=(\d{3})+$)/g, kNarrowSpace);
}

function count(n) {
  if (n === null || n === undefined || !isFinite(n)) return kNone;
  return (n < 0 ? kMinus : "") + grouped(String(Math.abs(Math.round(n))));
}

// "1 point", "2 points".
function counted(n, noun) {
  return count(n) + " " + noun + (n === 1 ? "" : "s");
}

function superscript(text) {
  const digits = "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079";
  return String(text).replace(/-/g, "\u207b").replace(/\d/g, (d) => digits[Number(d)]);
}

function scientific(value, digits) {
  const [mantissa, exponent] = Math.abs(value).toExponential(digits - 1).split("e");
  const power = "10" + superscript(Number(exponent));
  const sign = value < 0 ? kMinus : "";
  return sign + (mantissa === "1" ? power : mantissa + "\u2009\u00d7\u2009" + power);
}

// With a fixed number of decimals.
function fixed(value, decimals) {
  const text = Math.abs(value).toFixed(decimals);
  const [whole, part] = text.split(".");
  const sign = value < 0 && Number(text) !== 0 ? kMinus : "";
  return sign + grouped(whole) + (part === undefined ? "" : "." + part);
}

// With `digits` significant digits, trailing zeros kept.
function significant(value, digits = 3) {
  if (value === null || value === undefined || !isFinite(value)) return kNone;
  if (value === 0) return "0";
  const rounded = Number(Math.abs(value).toPrecision(digits));
  const magnitude = Math.floor(Math.log10(rounded) + 1e-12);
  if (magnitude < -4 || magnitude >= 7) return scientific(value, digits);
  return fixed(value, Math.max(0, digits - 1 - magnitude));
}

// Without needless zeros, for ticks and for numbers that people chose.
function plain(value) {
  if (value === null || value === undefined || !isFinite(value)) return kNone;
  if (value === 0) return "0";
  const rounded = Number(value.toPrecision(6));
  const size = Math.abs(rounded);
  if (size < 1e-4 || size >= 1e7) {
    const digits = size.toExponential().split("e")[0].replace(".", "").length;
    return scientific(rounded, digits);
  }
  const decimals = (String(size).split(".")[1] || "").length;
  return fixed(rounded, decimals);
}

// Writes lengths of one quantity so that they line up: decimals chosen once, from its largest value.
class Scale {
  constructor(largest, unit, digits = 3) {
    this.unit = unit;
    this.exponent = largest > 0 && isFinite(largest) ? Math.floor(Math.log10(largest)) : 0;
    this.decimals = Math.max(0, digits - 1 - this.exponent);
    this.usesPowers = this.exponent < -5 || this.exponent > 6;
    this.digits = digits;
  }

  // `value` without its unit. What would read as zero is given its own digits.
  number(value) {
    if (value === null || value === undefined || !isFinite(value)) return kNone;
    if (value === 0) return "0";
    if (this.usesPowers) return scientific(value, this.digits);
    const least = 0.5 * Math.pow(10, -this.decimals);
    return Math.abs(value) < least ? significant(value, 2) : fixed(value, this.decimals);
  }

  signed(value) {
    return (value > 0 ? "+" : "") + this.number(value);
  }

  text(value) {
    const written = this.number(value);
    return written === kNone || !this.unit ? written : written + kNarrowSpace + this.unit;
  }

  signedText(value) {
    return (value > 0 ? "+" : "") + this.text(value);
  }
}

// Ticks at 1, 2 or 5 times a power of ten inside [low, high], about `wanted` of them.
function niceTicks(low, high, wanted) {
  const span = high - low;
  if (!(span > 0) || !isFinite(span)) return [low];
  const raw = span / Math.max(1, wanted);
  const power = Math.pow(10, Math.floor(Math.log10(raw)));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= raw * 0.999);
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i <= Math.floor(high / step + 1e-9); ++i) {
    ticks.push(Number((i * step).toPrecision(12)));
  }
  return ticks;
}

// Writes ticks alike: with the decimals of their step, or all as powers of ten.
function tickText(ticks, signed = false) {
  const step = ticks.length > 1 ? ticks[1] - ticks[0] : ticks[0] || 1;
  const most = Math.max(...ticks.map(Math.abs), 0);
  const decimals = Math.max(0, -Math.floor(Math.log10(Math.abs(step)) + 1e-9));
  const powers = decimals > 6 || most >= 1e7;
  return (v) => {
    const sign = signed && v > 0 ? "+" : "";
    return sign + (v === 0 ? "0" : powers ? plain(v) : fixed(v, decimals));
  };
}

// The 1, 2 or 5 times a power of ten next below a positive number.
function niceBelow(value) {
  const power = Math.pow(10, Math.floor(Math.log10(value)));
  return [5, 2, 1].map((m) => m * power).find((s) => s <= value * 1.0001) || power;
}

function seconds(value) {
  if (value === null || value === undefined || !isFinite(value)) return kNone;
  if (value < 0.0005) return "0" + kNarrowSpace + "s";
  if (value >= 120) {
    const whole = Math.round(value);
    return Math.floor(whole / 60) + kNarrowSpace + "min " + (whole % 60) + kNarrowSpace + "s";
  }
  return (value < 10 ? fixed(value, value < 1 ? 3 : 2) : fixed(value, 1)) + kNarrowSpace + "s";
}

function percent(fraction) {
  if (fraction === null || fraction === undefined || !isFinite(fraction)) return kNone;
  if (fraction === 0 || fraction === 1) return 100 * fraction + kNarrowSpace + "%";
  // Never round to all or to none.
  const value = Math.min(99.99, Math.max(0.01, 100 * fraction));
  return fixed(value, value > 99 || value < 1 ? 2 : 1) + kNarrowSpace + "%";
}
