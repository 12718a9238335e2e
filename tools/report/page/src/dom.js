// Elements, briefly: el('td.number', {title: 'x'}, 'text', child).

let unique = 0;
export const uniqueId = () => `id${++unique}`;

export function el(name, attributes, ...children) {
  const [tag, ...classes] = name.split('.');
  const element = document.createElement(tag || 'div');
  if (classes.length) element.className = classes.join(' ');
  for (const [key, value] of Object.entries(attributes || {})) {
    if (key.startsWith('on')) {
      element.addEventListener(key.slice(2), value);
    } else if (value !== undefined && value !== false) {
      element.setAttribute(key, value === true ? '' : value);
    }
  }
  element.append(...children.flat().filter(child => child !== null && child !== undefined));
  return element;
}

const wide = 6;  // columns that a page has room for

// The columns after the first that have one text in all rows of a wide table: they need no place in it.
function constantColumns(header, rows) {
  const isConstant = i => i > 0 && typeof rows[0][i] === 'string' && rows.every(row => row[i] === rows[0][i]);
  return rows.length > 1 && header.length > wide ? header.map((_, i) => i).filter(isConstant) : [];
}

// A row above the heads, for columns that stand together.
function groupRow(header) {
  const groups = [];
  for (const {group} of header) {
    if (groups.length && groups.at(-1).group === group) groups.at(-1).colspan++;
    else groups.push({group, colspan: 1});
  }
  return el('tr.groups', {}, groups.map(
      ({group, colspan}) => group ? el('th', {colspan, scope: 'colgroup'}, group) : el('td', {colspan})));
}

// header: [{text, title, number, group}]; rows: [[text or element]]. A row may have the class `row.mark`. Of wide tables,
// columns that are constant go into the caption.
export function table(allHeads, allRows, title) {
  const constant = constantColumns(allHeads, allRows);
  const rest = list => list.filter((_, i) => !constant.includes(i));
  const header = rest(allHeads), rows = allRows.map(row => Object.assign(rest(row), {mark: row.mark}));
  const same = constant.map(i => [allHeads[i].group, `${allHeads[i].text} ${allRows[0][i]}`].filter(Boolean).join(': '));
  const caption = same.length ? `${title.replace(/\.$/, '')}. In all rows: ${same.join('; ')}` : title;
  const cell = (content, i, tag) => {
    const at = i === 0 && tag === 'td' ? 'th' : tag;
    const attributes = tag === 'th' ? {scope: 'col', title: header[i].title} : at === 'th' ? {scope: 'row'} : {};
    return el(header[i].number ? `${at}.number` : at, attributes, content);
  };
  return el('.tabled', {}, el('p.caption', {}, caption), el('.table', {tabindex: '0', role: 'region', 'aria-label': caption},
      el('table', {},
          el('thead', {}, header.some(h => h.group) ? groupRow(header) : null, el('tr', {}, header.map((h, i) => cell(h.text, i, 'th')))),
          el('tbody', {}, rows.map(row => el(row.mark ? `tr.${row.mark}` : 'tr', {},
              row.map((content, i) => cell(content, i, 'td'))))))));
}

export function figure(caption, ...children) {
  return el('figure', {}, ...children, el('figcaption', {}, caption));
}

export function button(text, title, action) {
  return el('button', {type: 'button', title, onclick: action}, text);
}

// choices: [[value, text]].
export function select(label, choices, chosen, action) {
  const id = uniqueId();
  const list = el('select', {id, onchange: event => action(event.target.value)},
      choices.map(([value, text]) => el('option', {value, selected: value === chosen}, text)));
  return el('span.choice', {}, el('label', {for: id}, label), list);
}

// Makes a function that draws once before the next picture, however often it is called.
export function beforeNextPicture(draw) {
  let asked = false;
  return () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      draw();
    });
  };
}

// A method's name with its colour.
export function swatch(color, text) {
  const mark = el('span.swatch', {'aria-hidden': 'true'});
  mark.style.background = `var(--${color})`;
  return el('span.named', {}, mark, text);
}
