// Dark and light: the system's, until someone chooses; paper is light.
import {button} from './dom.js';

const root = document.documentElement;
const system = matchMedia('(prefers-color-scheme: dark)');
const listeners = [];
let chosen = null;

// Figures on a canvas draw themselves again.
export const onTheme = listener => listeners.push(listener);

export const color = name => getComputedStyle(root).getPropertyValue(`--${name}`).trim();

function show(theme) {
  if (root.dataset.theme === theme) return;
  root.dataset.theme = theme;
  for (const listener of listeners) listener();
}

const current = () => chosen || (system.matches ? 'dark' : 'light');

export function startTheme() {
  show(current());
  system.addEventListener('change', () => show(current()));
  addEventListener('beforeprint', () => show('light'));
  addEventListener('afterprint', () => show(current()));
}

export function themeButton() {
  const flip = () => {
    chosen = current() === 'dark' ? 'light' : 'dark';
    show(chosen);
  };
  const made = button('◐', 'Dark or light', flip);
  made.setAttribute('aria-label', 'Dark or light');
  made.classList.add('theme');
  return made;
}
