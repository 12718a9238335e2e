// Rows of a comparison: what they are called, and which of them belong together.

const keys = ['surface', 'precision', 'solver', 'backend'];

export const rowName = row => [row.surface ?? '?', row.precision, row.solver, row.backend].filter(Boolean).join(', ');

export const sameRow = (row, other) => keys.every(key => row[key] === other?.[key]);

// What tells rows from each other, and what they share.
export function variedKeys(rows) {
  const varied = keys.filter(key => rows.some(row => row[key] !== rows[0][key]));
  return varied.length ? varied : keys.slice(0, 1);
}
export const sharedKeys = rows => keys.filter(key => !variedKeys(rows).includes(key));

// What tells a row from the others.
export const shortName = (row, rows) => variedKeys(rows).map(key => row[key] ?? '–').join(', ');

// Constructions and baselines, in the order in which figures show them; each has a colour in page.css.
const groups = {
  fair: ['Fair patches', 'gregory'],
  paper: ['Paper’s patches', 'papers'],
  patches: ['Gregory patches', 'gregory'],
  shaded: ['Force shading', 'shaded'],
  flat: ['Flat polygons', 'flat'],
};

export const groupOf = row => [row.construction, row.surface].find(name => name in groups) ?? 'patches';
export const groupTitle = group => groups[group]?.[0] ?? group;
export const groupColor = group => groups[group]?.[1] ?? 'neutral';

// [[group, its rows]], those without rows left out.
export function grouped(rows) {
  return Object.keys(groups).map(group => [group, rows.filter(row => groupOf(row) === group)]).filter(([, of]) => of.length);
}

// A group's own surface, where it was measured, or the first of it.
export const chiefRow = rows => rows.find(({surface}) => ['fair', 'paper', 'exact'].includes(surface)) ?? rows[0];
