// What a page changes of objects: how they feel, and how their surfaces are built.
import {button, el, select, swatch, uniqueId} from './dom.js';
import {number} from './format.js';
import {methodColor, methodTitle} from './methods.js';
import {methods} from './view_plots.js';

// A slider on a scale of its own: to(share) gives the value, from(value) the share. Told with `text(value)`.
export function slider(label, {to, from, text, change}) {
  const id = uniqueId(), input = el('input', {id, type: 'range', min: 0, max: 1000, step: 1});
  const told = el('output', {for: id});
  const show = value => {
    if (document.activeElement === input) return;
    input.value = Math.round(1000 * from(value));
    told.textContent = text(value);
  };
  input.addEventListener('input', () => (told.textContent = text(to(input.value / 1000)), change(to(input.value / 1000))));
  return {show, input, element: el('span.choice', {}, el('label', {for: id}, label), input, told)};
}

// A scale from `least` to `most` of equal ratios; `most` may be a function.
const ratios = (least, most) => {
  const all = () => (typeof most === 'function' ? most() : most) / least;
  return {to: share => least * all() ** share, from: value => Math.log(Math.max(value, least) / least) / Math.log(all())};
};
const rounded = (scale, step) => ({...scale, to: share => step * Math.round(scale.to(share) / step)});

const steepest = 0.2;  // height of a relief over its period; steeper ones are refused
const usualTexture = {kind: 'none', height: 5e-5, period: 2e-3};
const usualTurn = 75;  // degrees

export class Tuning {
  // send(message); limit() gives the largest stiffness, N/m.
  constructor(send, limit) {
    [this.send, this.state, this.texture] = [send, null, {...usualTexture}];
    this.methodButtons = methods.map(method => {
      const made = button('', `The hand feels ${methodTitle(method)} (M: the next)`, () => this.tune({method}));
      made.append(swatch(methodColor(method), methodTitle(method)));
      made.dataset.method = method;
      return made;
    });
    this.stiffness = slider('Stiffness', {...rounded(ratios(50, limit), 1), text: k => `${number(k / 1e3)} N/mm`, change: k => this.tune({stiffness: k})});
    this.friction = slider('Friction', {to: share => Math.round(150 * share) / 100, from: mu => mu / 1.5,
      text: mu => number(mu, 2), change: mu => this.tune({friction: [mu, Math.round(80 * mu) / 100]})});
    this.settle = slider('Settle', {to: share => Math.round(50 * share) / 1e3, from: s => s / 0.05, text: s => `${number(1e3 * s)} ms`, change: s => this.tune({settle: s})});
    this.relief = select('Texture', [['none', 'none'], ['grating', 'grating'], ['noise', 'noise']], 'none', kind => this.setTexture({kind}));
    this.height = slider('of', {...rounded(ratios(5e-6, 5e-4), 1e-6), text: h => `${number(1e6 * h)} µm`, change: height => this.setTexture({height})});
    this.period = slider('every', {...rounded(ratios(2e-4, 2e-2), 1e-5), text: p => `${number(1e3 * p)} mm`, change: period => this.setTexture({period})});
    this.level = select('Level', ['exact', 'ribbon', 'bezier', 'table'].map(name => [name, name]), 'exact', level => this.build({level}));
    this.construction = select('Construction', ['fair', 'paper'].map(name => [name, name]), 'fair', construction => this.build({construction}));
    this.crease = select('Creases', [['usual', 'as opened'], ['none', 'none'], ['angle', 'above']], 'usual', kind => this.build({crease: kind === 'usual' ? null : kind === 'none' ? 180 : Number(this.turn.value)}));
    this.turn = el('input', {type: 'number', min: 1, max: 179, step: 1, value: usualTurn, 'aria-label': 'degrees of a crease', onchange: () => this.list(this.crease).value === 'angle' && this.turn.reportValidity() && this.build({crease: Number(this.turn.value)})});
    this.show(null);
  }

  list(choice) { return choice.querySelector('select'); }

  get methods() { return el('span.methods', {role: 'group', 'aria-label': 'The hand feels'}, this.methodButtons); }

  get rows() {
    return [
      el('.controls', {}, this.stiffness.element, this.friction.element, this.settle.element),
      el('.controls', {}, this.relief, this.height.element, this.period.element),
      el('.controls', {}, this.level, this.construction, this.crease, el('span.choice', {}, this.turn, '°')),
    ];
  }

  tune(change) {
    if (!this.state) return;
    Object.assign(this.state, change);
    const {method, stiffness, friction, settle, texture} = this.state;
    this.send({tune: {method, stiffness, friction, settle, texture}});
  }

  setTexture(change) {
    Object.assign(this.texture, change);
    this.texture.height = Math.min(this.texture.height, steepest * this.texture.period);
    this.tune({texture: {...this.texture}});
  }

  build(change) {
    if (!this.state) return;
    const {level, construction, crease} = {...this.state, ...change};
    this.send({build: {level, construction, crease}});
  }

  nextMethod() { this.tune({method: methods[(methods.indexOf(this.state.method) + 1) % methods.length]}); }

  // As the server has it.
  show(state) {
    this.state = state;
    if (!state) return;
    for (const made of this.methodButtons) made.setAttribute('aria-pressed', String(made.dataset.method === state.method));
    this.stiffness.show(state.stiffness);
    this.friction.show(state.friction[0]);
    this.settle.show(state.settle);
    this.texture.kind = state.texture.kind;
    if (state.texture.kind !== 'none') Object.assign(this.texture, state.texture);
    this.height.show(this.texture.height);
    this.period.show(this.texture.period);
    for (const part of [this.height, this.period]) part.element.hidden = this.texture.kind === 'none';
    this.list(this.relief).value = this.texture.kind;
    this.list(this.level).value = state.level;
    this.list(this.construction).value = state.construction;
    this.list(this.crease).value = state.crease === null ? 'usual' : state.crease === 180 ? 'none' : 'angle';
    for (const part of [this.level, this.construction, this.crease]) this.list(part).disabled = state.opening;
  }
}
