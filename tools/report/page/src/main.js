// The page: a head, and a section for each result.
import './page.css';
import {compareSection} from './compare.js';
import {readResults} from './data.js';
import {el} from './dom.js';
import {number} from './format.js';
import {loopSection, together} from './run.js';
import {sweepSection} from './sweep.js';
import {startTheme, themeButton} from './theme.js';
import {startTooltip} from './tooltip.js';
import {traceSection} from './trace.js';

const kinds = {
  trace: traceSection,
  sweep: sweepSection,
  compare: compareSection,
  run: loopSection,
  recording: loopSection,
  session: loopSection,
};

const all = texts => [...new Set(texts)].join(', ');

// Where a result comes from, as far as its file says; facts: [[term, text]], what else its kind says.
function provenance({origin, faces}, facts) {
  const objects = origin.objects ?? [{mesh: origin.surface, stiffness_N_per_m: origin.stiffness_N_per_m}];
  const stiffness = objects.map(o => o.stiffness_N_per_m).filter(k => Number.isFinite(k)).map(k => `${number(k / 1e3)} N/mm`);
  const known = [['Mesh', all(objects.map(o => o.mesh).filter(Boolean))], ['Polygons', faces], ['Scene', origin.scene],
    ['Device', origin.device], ['Unit', origin.unit], ['Stiffness', all(stiffness)], ...facts, ['Precision', origin.precision], ['Mesh hash', origin.mesh_hash]]
      .filter(([, value]) => value);
  const command = origin.command_line;
  return el('.origin', {},
      known.length ? el('dl', {}, known.map(([term, value]) => el('div', {}, el('dt', {}, term), el('dd', {}, String(value))))) : null,
      command ? el('code', {}, command) : known.length ? null : el('p', {}, 'The file does not say which command made it.'));
}

function section(result, index) {
  const made = kinds[result.kind](result);
  const id = `result-${index + 1}`;
  return {id, title: made.title, file: result.file, element: el('section', {id, 'aria-labelledby': `${id}-title`},
      el('header', {}, el('p.kind', {}, made.title), el('h2', {id: `${id}-title`}, result.file), provenance(result, made.facts ?? [])),
      ...made.content.flat())};
}

function start() {
  startTheme();
  startTooltip();
  const {version, results: read} = readResults(), results = together(read);
  document.title = `${results.map(r => r.file).join(', ')} – Gliss report`;
  const page = document.getElementById('page');
  const sections = results.map(section);
  const links = sections.map(s => el('li', {}, el('a', {href: `#${s.id}`}, s.file), el('span.aside', {}, s.title.toLowerCase())));
  page.append(
      el('header.top', {}, el('div', {}, el('h1', {}, 'Gliss report'), el('p.aside', {}, `gliss ${version}`)), themeButton()),
      sections.length > 1 ? el('nav', {'aria-label': 'Results'}, el('ol', {}, links)) : '',
      ...sections.map(s => s.element));
  document.documentElement.dataset.ready = 'true';
}

start();
