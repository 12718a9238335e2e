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

// header: [{text, title, number}]; rows: [[text or element]]. A row may have the class `row.mark`.
export function table(header, rows, caption) {
  const cell = (content, i, tag) => {
    const at = i === 0 && tag === 'td' ? 'th' : tag;
    const attributes = tag === 'th' ? {scope: 'col', title: header[i].title} : at === 'th' ? {scope: 'row'} : {};
    return el(header[i].number ? `${at}.number` : at, attributes, content);
  };
  return el('.tabled', {}, el('p.caption', {}, caption), el('.table', {tabindex: '0', role: 'region', 'aria-label': caption},
      el('table', {},
          el('thead', {}, el('tr', {}, header.map((h, i) => cell(h.text, i, 'th')))),
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

// A method's name with its colour.
export function swatch(color, text) {
  const mark = el('span.swatch', {'aria-hidden': 'true'});
  mark.style.background = `var(--${color})`;
  return el('span.named', {}, mark, text);
}
