// The one box that tells the values of what is pointed at.
import {el} from './dom.js';

const box = el('.tooltip', {role: 'status', hidden: true});

export function startTooltip() {
  document.body.append(box);
  addEventListener('scroll', hideTooltip, {passive: true});
}

// Where a box of that size begins beside a point: after it, before it where there is no room, and within the bounds of
// what it belongs to, or of the window where those are too narrow.
function beside(at, size, from, to, most) {
  const bounds = [Math.max(4, from), Math.min(most - 4, to)];
  const [first, last] = bounds[1] - bounds[0] < size ? [4, most - 4] : bounds;
  const begin = at + 16 + size > last ? at - 16 - size : at + 16;
  return Math.max(first, Math.min(begin, last - size));
}

// rows: [[name, value, colour]]; (x, y) in the window, on a chart or a picture.
export function showTooltip(element, x, y, title, rows) {
  const lines = rows.map(([name, value, color]) => {
    const mark = el('span.swatch');
    mark.style.background = color ? `var(--${color})` : 'none';
    return el('tr', {}, el('th', {}, mark, name), el('td', {}, value));
  });
  box.replaceChildren(el('strong', {}, title), el('table', {}, el('tbody', {}, lines)));
  box.hidden = false;
  const {width, height} = box.getBoundingClientRect();
  const within = element.getBoundingClientRect(), {clientWidth, clientHeight} = document.documentElement;
  box.style.left = `${beside(x, width, within.left, within.right, clientWidth)}px`;
  box.style.top = `${beside(y, height, within.top, within.bottom, clientHeight)}px`;
}

export function hideTooltip() {
  box.hidden = true;
}
