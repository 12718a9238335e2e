// The page of gliss view.
import './page.css';
import './view.css';
import {Box3, Vector3} from 'three';
import {button, el, select, swatch} from './dom.js';
import {count, number} from './format.js';
import {methodColor, methodTitle} from './methods.js';
import {startTheme, themeButton} from './theme.js';
import {startTooltip} from './tooltip.js';
import {Pad} from './view_gamepad.js';
import {Hand} from './view_hand.js';
import {Link} from './view_link.js';
import {methods, Plots} from './view_plots.js';
import {Sound} from './view_sound.js';
import {kinds, Stage} from './view_stage.js';
import {slider, Tuning} from './view_tuning.js';
import {WorkLoop} from './view_work.js';

const guards = ['starts', 'runs', 'holds', 'fades', 'is safe: the hand comes out, and feels again'];

const mostEdged = 30000;  // polygons; the edges of more would cover them, and take long to draw

const page = {state: null, hello: null, stage: null, hand: null, plots: new Plots(), sound: new Sound(), work: new WorkLoop()};
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

const tuning = new Tuning(message => page.link.send(message), () => page.hello?.max_stiffness ?? 2000);
const press = slider('Press', {to: share => page.hand.least * (page.hand.most / page.hand.least) ** share, from: m => Math.log(m / page.hand.least) / Math.log(page.hand.most / page.hand.least),
  text: m => `${number(1e3 * m)} mm`, change: m => pressTo(m)});
const cut = slider('Cut', {to: share => share, from: share => share, text: share => share < 1 ? `${Math.round(100 * share)} %` : 'none', change: share => page.stage.cutAt(page.cutAxis ?? 0, share)});

const pauseButton = button('Pause', 'Hold the plots (P)', () => {
  page.plots.paused = !page.plots.paused;
  pauseButton.textContent = page.plots.paused ? 'Go on' : 'Pause';
});
const recordButton = button('Record', 'Record each tick to a file of the server’s folder (R)', () => page.link.send({record: !page.state.recording}));
const replayButton = button('Replay', 'Move the hand along the last recording (Y)', () => page.link.send({replay: !page.state.replaying}));
const saveButton = button('Save scene', 'Write a scene that feels the same (V)', () => page.link.send({save: true}));
const loopButton = button('Measure a loop', 'The net work of a way from a place back to it (L)', () => {
  loopButton.textContent = page.work.toggle(page.tick) ? 'End the loop' : 'Measure a loop';
});
const shotButton = button('Screenshot', 'The picture as a file (G)', screenshot);
const copyButton = button('Copy command', 'The command that shows the same (C)', copyCommand);
const touchButton = button('Touch', 'Press in where the pointer is, and lift again (space)', () => hold(!page.hand?.held));
const soundChoice = select('Sound of steps', [['', 'off'], ...methods.map((method, m) => [String(m), methodTitle(method)])], '',
    value => page.sound.choose(value === '' ? null : Number(value)));
const cutAxis = select('across', [['0', 'x'], ['1', 'y'], ['2', 'z']], '0', value => (page.cutAxis = Number(value), page.stage.cutAt(page.cutAxis, cut.input.value / 1000)));
const showChoice = select('Show', [['both', 'surface and edges'], ['surface', 'surface'], ['polygons', 'polygons'], ['edges', 'edges']], 'both', value => page.stage.show(value));
const objectBoxes = el('span.methods');
const legend = el('p.legend');
const note = el('p.notice', {role: 'status'});

function paint(by) {
  const most = page.stage.paint(by, page.hand?.press);
  if (by === 'kind') legend.replaceChildren(...kinds.map(([name, text]) => {
    const mark = el('span.swatch');
    mark.style.background = text;
    return el('span.named', {}, mark, name);
  }));
  else legend.textContent = by === 'height' && most ? `blue below, red above the polygons, by up to ${number(1e3 * most)} mm`
                          : by === 'curvature' ? `red: a radius of curvature is no more than the press of ${number(1e3 * page.hand.press)} mm, and a nearest point may leap` : '';
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

function pressTo(depth) {
  page.hand.press = depth;
  if (page.stage.by === 'curvature') paint('curvature');
}

function deeper(factor) {
  if (!page.hand) return;
  page.hand.deeper(factor);
  pressTo(page.hand.press);
  press.show(page.hand.press);
}

// A box for each of several objects that shows it or hides it.
function boxes(objects) {
  if (objects.length < 2) return [];
  return objects.map(({name}, i) => el('label.choice', {}, el('input', {type: 'checkbox', checked: !page.stage.hidden.has(i), onchange: event => page.stage.hide(i, !event.target.checked)}), name));
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
  m: () => tuning.nextMethod(),
  y: () => replayButton.click(), v: () => saveButton.click(), l: () => loopButton.click(),
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
  const first = !page.hello;
  page.hello = hello;
  document.title = `${hello.title} – Gliss view`;
  title.textContent = hello.title;
  about.textContent = `${hello.objects.map(o => `${count(o.faces)} polygons, ${o.surface}`).join('; ')}; gliss ${hello.version}`;
  document.body.dataset.device = hello.device;
  page.work.clear();
  page.plots.clear();  // another loop's time
  if (!first) {
    page.stage.keep(hello.objects.length);
    return objectBoxes.replaceChildren(...boxes(hello.objects));
  }
  page.stage.frame(new Box3(new Vector3(...hello.min), new Vector3(...hello.max)));
  const {size} = page.stage, rest = hello.max.map((x, i) => x + 0.1 * (x - hello.min[i]));
  page.hand = new Hand(page.stage, rest, Math.min(0.0053, 0.05 * size));
  objectBoxes.replaceChildren(...boxes(hello.objects));
  if (hello.objects.reduce((sum, o) => sum + o.faces, 0) > mostEdged) showChoice.querySelector('select').value = page.stage.view = 'surface';
  press.show(page.hand.press);
  cut.show(1);
  listen();
  page.pad = new Pad({
    move: (dx, dy) => page.hand.move(dx * canvas.clientWidth, dy * canvas.clientHeight),
    turn: (dx, dy) => page.stage.orbit.turn(dx, dy),
    hold, deeper,
  });
}

function newsOf(state) {
  if (state.failure) return state.failure;
  if (state.opening) return 'Builds the surface again';
  if (state.recording) return `Records to ${state.recording}`;
  if (state.saved && state.saved !== page.saved) return `Saved ${page.saved = state.saved}`;
  return state.recorded.length ? `Recorded ${state.recorded.at(-1)}` : '';
}

function showState(state) {
  page.state = state;
  tuning.show(state);
  recordButton.textContent = state.recording ? 'Stop recording' : 'Record';
  replayButton.textContent = state.replaying ? 'Stop the replay' : 'Replay';
  note.textContent = newsOf(state);
}

const whose = () => page.state?.replaying ? '; a recording moves the hand' : page.hello?.device ? `; ${page.hello.device} moves the hand` : '';

function statusText() {
  if (!page.connected) return 'The server is gone; trying again';
  if (!page.hello) return `Opens ${page.opens}`;
  return page.link.steers ? `The loop ${guards[page.guard] ?? 'waits'}${whose()}` : 'Another page steers; this one watches';
}

function showStatus() {
  document.body.dataset.steers = String(Boolean(page.link?.steers));
  status.textContent = statusText();
}

function showFrame(frame) {
  const steps = page.plots.add(frame, page.hello.period), tick = frame.at(frame.count - 1);
  page.sound.play(steps, page.hello.period);
  page.ticks = (page.ticks ?? 0) + frame.count;
  page.tick = tick;
  page.hand?.at.fromArray(tick.hip);
  if (page.hand) page.hand.isSafe = tick.guard === 4;
  const method = methods.indexOf(page.state.method);
  page.pad?.feel(steps.reduce((most, own) => Math.max(most, own[method]), 0));
  page.stage.place(tick, method, methodColor(page.state.method));
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
              el('.controls', {}, tuning.methods, touchButton, press.element),
              tuning.rows,
              el('.controls', {},
                  showChoice,
                  select('Colour', [['clay', 'one'], ['kind', 'by kind of patch'], ['height', 'by departure from the polygons'], ['curvature', 'by curvature against the press']], 'clay', paint),
                  cut.element, cutAxis, button('Reset view', 'All of the objects (0)', () => page.stage.orbit?.reset()), objectBoxes),
              legend,
              el('.controls', {}, recordButton, replayButton, saveButton, copyButton, shotButton, soundChoice), note,
              el('p.notice', {}, 'Drag on an object to touch it, the wheel presses deeper; drag beside it to turn, shift-drag to move, the wheel zooms. Keys: space touches, W A S D move the hand, E and Q press more and less, M the next method, P pause, L begin and end a loop, R record, Y replay, V save, G screenshot, C copy; arrows turn.')),
          el('div', {}, readout(), el('.controls', {}, pauseButton, loopButton, page.work.told), page.plots.element)));
  try {
    page.stage = new Stage(canvas);
  } catch (error) {
    status.textContent = `This browser draws no WebGL: ${error.message}`;
    return;
  }
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
      if (message.opens) page.opens = message.opens;
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
