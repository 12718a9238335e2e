// Numbers as people read them.

// Three digits that count, without an exponent where that stays short.
export function number(value, digits = 3) {
  if (value === null || value === undefined || Number.isNaN(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-3) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split('e');
    return `${mantissa}·10${superscript(Number(exponent))}`;
  }
  const places = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return value.toFixed(places).replace('-', '−');
}

export function superscript(exponent) {
  return [...String(exponent)].map(c => c === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[c]).join('');
}

export function count(value) {
  if (value === null || value === undefined) return '–';
  return Math.round(value).toLocaleString('en-US').replaceAll(',', '\u202f');
}

export function bytes(value) {
  if (value === null || value === undefined) return '–';
  const units = ['B', 'KiB', 'MiB', 'GiB'];
  let unit = 0;
  for (; value >= 1024 && unit < units.length - 1; unit++) value /= 1024;
  return `${unit ? number(value) : value} ${units[unit]}`;
}

export function percent(share, digits = 3) {
  return share === null || share === undefined ? '–' : `${number(100 * share, digits)} %`;
}

export function vector(values, digits = 4) {
  return Array.from(values, v => number(v, digits)).join(', ');
}

export const millimetres = metres => `${number(1e3 * metres)} mm`;

export const capital = text => text[0].toUpperCase() + text.slice(1);

// A rate: "4.00 M".
export function rate(value) {
  if (value === null || value === undefined) return '–';
  const [size, letter] = [[1e9, ' G'], [1e6, ' M'], [1e3, ' k'], [0, '']].find(([least]) => value >= least);
  return number(value / (size || 1)) + letter;
}

// The label of a mark on a logarithmic axis.
export function power(value) {
  const exponent = Math.floor(Math.log10(value) + 1e-9);
  const digit = Math.round(value / 10 ** exponent);
  if (exponent >= -2 && exponent <= 3) return String(Number(value.toPrecision(3)));
  return `${digit > 1 ? `${digit}·` : ''}10${superscript(exponent)}`;
}
