// The one box that tells the values of what is pointed at.
import {el} from './dom.js';

const box = el('.tooltip', {role: 'status', hidden: true});

export function startTooltip() {
  document.body.append(box);
  addEventListener('scroll', hideTooltip, {passive: true});
}

// rows: [[name, value, colour]]; (x, y) in the window.
export function showTooltip(x, y, title, rows) {
  const lines = rows.map(([name, value, color]) => {
    const mark = el('span.swatch');
    mark.style.background = color ? `var(--${color})` : 'none';
    return el('tr', {}, el('th', {}, mark, name), el('td', {}, value));
  });
  box.replaceChildren(el('strong', {}, title), el('table', {}, el('tbody', {}, lines)));
  box.hidden = false;
  const {width, height} = box.getBoundingClientRect();
  const left = x + 16 + width > innerWidth ? x - 16 - width : x + 16;
  const top = y + 16 + height > innerHeight ? y - 16 - height : y + 16;
  box.style.left = `${Math.max(4, left)}px`;
  box.style.top = `${Math.max(4, top)}px`;
}

export function hideTooltip() {
  box.hidden = true;
}
