// The page of gliss view.
import './page.css';
import './view.css';
import {Box3, Vector3} from 'three';
import {button, el, select, swatch, uniqueId} from './dom.js';
import {count, number} from './format.js';
import {methodColor, methodTitle} from './methods.js';
import {startTheme, themeButton} from './theme.js';
import {startTooltip} from './tooltip.js';
import {Hand} from './view_hand.js';
import {Link} from './view_link.js';
import {methods, Plots} from './view_plots.js';
import {Sound} from './view_sound.js';
import {kinds, Stage} from './view_stage.js';

const guards = ['starts', 'runs', 'holds', 'fades', 'is safe: the hand comes out, and feels again'];

const page = {state: null, hello: null, stage: null, hand: null, plots: new Plots(), sound: new Sound()};
const canvas = el('canvas.stage', {tabindex: '0', role: 'img'});
const status = el('p.status', {role: 'status'}, 'Connecting');
const title = el('h1', {}, 'Gliss view'), about = el('p.aside');
const cells = methods.map(() => ({force: el('td.number'), depth: el('td.number'), step: el('td.number'), contact: el('td')}));

function readout() {
  const head = ['', 'Force, N', 'Depth, mm', 'Largest step in 10 s, N', ''];
  return el('table.readout', {}, el('thead', {}, el('tr', {}, head.map(text => el('th.number', {scope: 'col'}, text)))),
      el('tbody', {}, methods.map((method, m) => el('tr', {'data-method': method}, el('th', {scope: 'row'}, swatch(methodColor(method), methodTitle(method))),
          cells[m].force, cells[m].depth, cells[m].step, cells[m].contact))));
}

// A slider on a scale of its own: to(share) gives the value, from(value) the share. Told with `text(value)`.
function slider(label, {to, from, text, change}) {
  const id = uniqueId(), input = el('input', {id, type: 'range', min: 0, max: 1000, step: 1});
  const told = el('output', {for: id});
  const show = value => (input.value = Math.round(1000 * from(value)), told.textContent = text(value));
  input.addEventListener('input', () => (told.textContent = text(to(input.value / 1000)), change(to(input.value / 1000))));
  return {show, input, element: el('span.choice', {}, el('label', {for: id}, label), input, told)};
}

const stiffness = slider('Stiffness', {to: share => Math.round(50 * (page.hello.max_stiffness / 50) ** share), from: k => Math.log(k / 50) / Math.log(page.hello.max_stiffness / 50),
  text: k => `${number(k / 1e3)} N/mm`, change: k => tune({stiffness: k})});
const friction = slider('Friction', {to: share => Math.round(150 * share) / 100, from: mu => mu / 1.5,
  text: mu => number(mu, 2), change: mu => tune({friction: [mu, Math.round(80 * mu) / 100]})});
const settle = slider('Settle', {to: share => Math.round(50 * share) / 1e3, from: s => s / 0.05,
  text: s => `${number(1e3 * s)} ms`, change: s => tune({settle: s})});
const press = slider('Press', {to: share => page.hand.least * (page.hand.most / page.hand.least) ** share, from: m => Math.log(m / page.hand.least) / Math.log(page.hand.most / page.hand.least),
  text: m => `${number(1e3 * m)} mm`, change: m => (page.hand.press = m)});
const cut = slider('Cut', {to: share => share, from: share => share, text: share => share < 1 ? `${Math.round(100 * share)} %` : 'none', change: share => page.stage?.cutAt(page.cutAxis ?? 0, share)});

function tune(change) {
  if (!page.state) return;
  const {method, stiffness: k, friction: mu, settle: s} = {...page.state, ...change};
  Object.assign(page.state, change);
  page.link.send({tune: {method, stiffness: k, friction: mu, settle: s}});
}

const methodButtons = methods.map(method => {
  const made = button('', `The hand feels ${methodTitle(method)} (M: the next)`, () => tune({method}));
  made.append(swatch(methodColor(method), methodTitle(method)));
  made.dataset.method = method;
  return made;
});
const pauseButton = button('Pause', 'Hold the plots (P)', () => {
  page.plots.paused = !page.plots.paused;
  pauseButton.textContent = page.plots.paused ? 'Go on' : 'Pause';
});
const recordButton = button('Record', 'Record each tick to a file of the server’s folder (R)', () => page.link.send({record: !page.state.recording}));
const shotButton = button('Screenshot', 'The picture as a file (G)', screenshot);
const copyButton = button('Copy command', 'The command that shows the same (C)', copyCommand);
const touchButton = button('Touch', 'Press in where the pointer is, and lift again (space)', () => hold(!page.hand?.held));
const soundChoice = select('Sound of steps', [['', 'off'], ...methods.map((method, m) => [String(m), methodTitle(method)])], '',
    value => page.sound.choose(value === '' ? null : Number(value)));
const cutAxis = select('across', [['0', 'x'], ['1', 'y'], ['2', 'z']], '0', value => (page.cutAxis = Number(value), page.stage?.cutAt(page.cutAxis, cut.input.value / 1000)));
const legend = el('p.legend');
const note = el('p.notice', {role: 'status'});

function paint(by) {
  const most = page.stage?.paint(by);
  if (by === 'kind') legend.replaceChildren(...kinds.map(([name, text]) => {
    const mark = el('span.swatch');
    mark.style.background = text;
    return el('span.named', {}, mark, name);
  }));
  else legend.textContent = by === 'height' && most ? `blue below, red above the polygons, by up to ${number(1e3 * most)} mm` : '';
}

function screenshot() {
  page.stage.draw();
  canvas.toBlob(blob => {
    const link = el('a', {href: URL.createObjectURL(blob), download: 'gliss-view.png'});
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  });
}

async function copyCommand() {
  try {
    await navigator.clipboard.writeText(page.state.command);
    note.textContent = 'Copied.';
  } catch {  // the browser does not permit it
    note.textContent = page.state.command;
  }
}

function hold(held) {
  if (!page.hand) return;
  if (held && !page.hand.pointer) page.hand.move(0, 0);
  page.hand.held = held;
  touchButton.textContent = held ? 'Lift' : 'Touch';
}

function deeper(factor) {
  page.hand?.deeper(factor);
  if (page.hand) press.show(page.hand.press);
}

// The left button on an object touches it; beside it, with shift, or another button, the camera turns.
function listen() {
  const place = event => [event.offsetX, event.offsetY];
  const touches = event => event.button === 0 && !event.shiftKey && page.hand.isOver(...place(event));
  page.stage.orbit.listen(canvas, event => event.type === 'wheel' ? !page.hand.held : !touches(event));
  canvas.addEventListener('pointerdown', event => {
    if (!touches(event)) return;
    canvas.focus({preventScroll: true});
    canvas.setPointerCapture(event.pointerId);
    page.finger = event.pointerId;
    page.hand.point(...place(event));
    hold(true);
  });
  canvas.addEventListener('pointermove', event => {
    if (page.finger === event.pointerId || page.finger === undefined && !event.buttons) page.hand.point(...place(event));
  });
  for (const end of ['pointerup', 'pointercancel', 'lostpointercapture']) {
    canvas.addEventListener(end, event => {
      if (page.finger !== event.pointerId) return;
      page.finger = undefined;
      hold(false);
    });
  }
  canvas.addEventListener('wheel', event => {
    if (!page.hand.held) return;
    event.preventDefault();
    deeper(Math.exp(-event.deltaY * 0.001));
  }, {passive: false});
}

const keys = {
  ' ': () => hold(!page.hand.held),
  a: step => page.hand.move(-step, 0), d: step => page.hand.move(step, 0), w: step => page.hand.move(0, -step), s: step => page.hand.move(0, step),
  e: () => deeper(1.15), q: () => deeper(1 / 1.15),
  m: () => tune({method: methods[(methods.indexOf(page.state.method) + 1) % 3]}),
  p: () => pauseButton.click(), r: () => recordButton.click(), g: screenshot, c: copyCommand,
};

addEventListener('keydown', event => {
  const {target} = event;
  if (!page.hand || event.ctrlKey || event.metaKey || event.altKey || /^(INPUT|SELECT|TEXTAREA)$/.test(target.tagName)) return;
  if (event.key === ' ' && target.tagName === 'BUTTON') return;
  const act = keys[event.key.toLowerCase()];
  if (act) act(event.shiftKey ? 1 : 6);
  else if (target === document.body) page.stage.orbit.press(event, canvas);
  else return;
  if (act) event.preventDefault();
});
addEventListener('blur', () => hold(false));

function greet(hello) {
  const first = !page.stage;
  page.hello = hello;
  document.title = `${hello.title} – Gliss view`;
  title.textContent = hello.title;
  about.textContent = `${hello.objects.map(o => `${count(o.faces)} polygons, ${o.surface}`).join('; ')}; gliss ${hello.version}`;
  if (!first) return;
  page.stage = new Stage(canvas, new Box3(new Vector3(...hello.min), new Vector3(...hello.max)));
  const {size} = page.stage, rest = hello.max.map((x, i) => x + 0.1 * (x - hello.min[i]));
  page.hand = new Hand(page.stage, rest, Math.min(0.0053, 0.05 * size));
  press.show(page.hand.press);
  cut.show(1);
  listen();
}

function showState(state) {
  page.state = state;
  for (const made of methodButtons) made.setAttribute('aria-pressed', String(made.dataset.method === state.method));
  if (document.activeElement !== stiffness.input) stiffness.show(state.stiffness);
  if (document.activeElement !== friction.input) friction.show(state.friction[0]);
  if (document.activeElement !== settle.input) settle.show(state.settle);
  recordButton.textContent = state.recording ? 'Stop recording' : 'Record';
  note.textContent = state.failure ? `Not recorded: ${state.failure}` : state.recording ? `Records to ${state.recording}` : state.recorded.length ? `Recorded ${state.recorded.at(-1)}` : '';
}

function showStatus() {
  const {link} = page;
  document.body.dataset.steers = String(Boolean(link?.steers));
  status.textContent = !page.connected ? 'The server is gone; trying again' : link.steers ? `The loop ${guards[page.guard] ?? 'waits'}` : 'Another page steers; this one watches';
}

function showFrame(frame) {
  const steps = page.plots.add(frame, page.hello.period), tick = frame.at(frame.count - 1);
  page.sound.play(steps, page.hello.period);
  page.ticks = (page.ticks ?? 0) + frame.count;
  page.tick = tick;
  page.hand?.at.fromArray(tick.hip);
  if (page.hand) page.hand.isSafe = tick.guard === 4;
  const method = methods.indexOf(page.state.method);
  page.stage?.place(tick, method, methodColor(page.state.method));
  if (page.guard !== tick.guard) (page.guard = tick.guard, showStatus());
}

// Numbers and plots, less often than frames come: nobody reads them quicker.
setInterval(() => {
  if (!page.tick || page.plots.paused) return;
  const largest = page.plots.largestSteps();
  page.tick.felt.forEach((felt, m) => {
    cells[m].force.textContent = Math.hypot(...felt.force).toFixed(3);
    cells[m].depth.textContent = (1e3 * felt.depth).toFixed(3);
    cells[m].step.textContent = number(largest[m]);
    cells[m].contact.textContent = ['free', 'touches', 'slips'][felt.contact];
  });
  page.plots.draw();
}, 80);

function start() {
  startTheme();
  startTooltip();
  document.getElementById('page').append(
      el('header.top', {}, el('div', {}, title, about), status, themeButton()),
      el('div.bench', {},
          el('div', {}, canvas,
              el('.controls', {}, el('span.methods', {role: 'group', 'aria-label': 'The hand feels'}, methodButtons), touchButton, press.element),
              el('.controls', {}, stiffness.element, friction.element, settle.element),
              el('.controls', {},
                  select('Show', [['both', 'surface and edges'], ['surface', 'surface'], ['polygons', 'polygons'], ['edges', 'edges']], 'both', value => page.stage?.show(value)),
                  select('Colour', [['clay', 'one'], ['kind', 'by kind of patch'], ['height', 'by height over the polygon']], 'clay', paint),
                  cut.element, cutAxis, button('Reset view', 'All of the objects (0)', () => page.stage?.orbit.reset())),
              legend,
              el('.controls', {}, recordButton, shotButton, copyButton, soundChoice), note,
              el('p.notice', {}, 'Drag on an object to touch it, the wheel presses deeper; drag beside it to turn, shift-drag to move, the wheel zooms. Keys: space touches, W A S D move the hand, E and Q press more and less, M the next method, P pause, R record, G screenshot, C copy; arrows turn.')),
          el('div', {}, readout(), el('.controls', {}, pauseButton), page.plots.element)));
  page.link = new Link({
    open() {
      page.connected = true;
      showStatus();
    },
    lost() {
      page.connected = false;
      hold(false);
      showStatus();
    },
    text(message) {
      if (message.hello) greet(message.hello);
      if (message.state) showState(message.state);
      showStatus();
    },
    frame: showFrame,
    geometry(geometry) {
      page.stage.add(geometry);
      document.documentElement.dataset.ready = 'true';
    },
  }, () => page.hand?.target());
}

start();
