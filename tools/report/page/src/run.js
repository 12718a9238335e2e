// What gliss run left: how late its ticks woke and how long they took, the force over time, the guards.
import {Chart, steps} from './chart.js';
import {el, figure, table} from './dom.js';
import {count, millimetres, number, percent} from './format.js';

const perDecade = 12;

// [[longest_us, count]] in bins of 0.8 %, together in wider ones: [upper edges, shares in %].
function binned(list) {
  const total = list.reduce((all, [, n]) => all + n, 0) || 1;
  const bins = new Map();
  for (const [longest, n] of list) {
    const bin = Math.ceil(perDecade * Math.log10(Math.max(longest, 1e-2)) - 1e-6);
    bins.set(bin, (bins.get(bin) || 0) + n);
  }
  const first = Math.min(...bins.keys()) - 1, last = Math.max(...bins.keys()) + 1;
  const numbers = Array.from({length: last - first + 1}, (_, i) => first + i);
  return [numbers.map(bin => 10 ** (bin / perDecade)), numbers.map(bin => 100 * (bins.get(bin) || 0) / total)];
}

function timing(name, label, list, figures) {
  if (list.every(([longest]) => longest === 0))
    return el('.view', {}, el('h4', {}, label), el('p.notice', {}, list.length ? 'None: the loop ran without a clock.' : 'No ticks.'));
  const [edges, shares] = binned(list);
  const least = 10 ** Math.floor(Math.log10(Math.min(...shares.filter(share => share > 0)))) / 2;
  const chart = new Chart({
    label: `Distribution: ${label}`,
    height: 220,
    x: {label: 'µs', log: true, range: [edges[0] / 1.2, edges.at(-1) * 1.2], size: 40},
    y: {label: '% of ticks', log: true, range: [least, 150]},
    series: [{color: name, fill: `${name}-wash`, paths: steps}],
    data: [edges, shares.map(share => Math.max(share, least))],
    tell: i => [`${number(edges[i - 1] ?? 0)} to ${number(edges[i])} µs`, [[label, `${number(shares[i])} %`, name]]],
  });
  const f = figures || {};
  return el('.view', {}, el('h4', {}, label, el('span.aside', {},
      `p50 ${number(f.p50_us)}, p99 ${number(f.p99_us)}, p99.9 ${number(f.p999_us)}, most ${number(f.max_us)} µs`)), chart.element);
}

function facts(figures) {
  const known = [
    ['Ticks', count(figures.ticks)], ['Missed', count(figures.missed)],
    ['Success', percent(figures.success_rate, 5)],
    ['In contact', count(figures.in_contact)], ['Entries', count(figures.entries)],
    ['Largest force sent', `${number(figures.largest_sent_force)} N`],
    ['Largest step rendered', `${number(figures.largest_force_step)} N`],
    ['Jumps rendered /100k', number(figures.jumps_per_100k)], ['Lost rendered /100k', number(figures.lost_per_100k)],
    ['Largest step sent', `${number(figures.largest_sent_step)} N`],
    ['Jumps sent /100k', number(figures.sent_jumps_per_100k)], ['Lost sent /100k', number(figures.sent_lost_per_100k)],
    ['Unsound steps', count(figures.unsound)],
    ['Deepest contact', figures.deepest_m === null || figures.deepest_m === undefined ? null : millimetres(figures.deepest_m)],
    ['Device', figures.device], ['Scheduling', figures.scheduling], ['End', figures.end],
  ];
  return el('dl.facts', {}, known.filter(([, value]) => value !== undefined && value !== null)
                                .map(([name, value]) => el('.fact', {}, el('dt', {}, name), el('dd', {}, String(value)))));
}

function guards(figures) {
  const acted = Object.entries(figures.guards || {}).filter(([, times]) => times > 0);
  if (!figures.guards) return null;
  if (!acted.length) return el('p.notice', {}, 'No guard acted.');
  return table([{text: 'Guard'}, {text: 'Times', number: true}], acted.map(([name, times]) => [name, count(times)]), 'Guards that acted');
}

// What is known of the timing without its distributions.
function quantiles({wake, compute}) {
  const keys = [['p50', 'p50_us'], ['p99', 'p99_us'], ['p99.9', 'p999_us'], ['Most', 'max_us']];
  const line = (text, found) => [text, ...keys.map(([, key]) => number(found?.[key]))];
  return table([{text: 'µs'}, ...keys.map(([text]) => ({text, number: true}))],
      [line('Lateness of the wake', wake), line('Computing', compute)], 'Timing; its distributions are in gliss run --report');
}

function timings(figures) {
  if (!figures.histograms) return quantiles(figures);
  const {wake, compute} = figures.histograms;
  return figure('How late the ticks woke, and how long each took to compute. Both axes are logarithmic: what matters is how far the tail reaches to the right, against the period of 1 000 µs.',
      el('.views', {}, timing('neutral', 'Lateness of the wake', wake, figures.wake),
          timing('gregory', 'Computing', compute, figures.compute)));
}

// The force over time, of a recording.
function forces({time, rendered, sent, shown, figures}) {
  const most = Math.max(1e-9, ...[rendered, sent].map(list => list.reduce((a, b) => b > a ? b : a, 0)));
  const chart = new Chart({
    label: 'Force over time',
    height: 260,
    x: {label: 'time, s', range: [time[0] ?? 0, Math.max(time.at(-1) ?? 1, (time[0] ?? 0) + 1e-6)], size: 40},
    y: {label: 'N', range: [0, 1.06 * most]},
    series: [{color: 'rendered', width: 1.5}, {color: 'sent', width: 1.5}],
    data: [time, rendered, sent],
    tell: i => [`${number(time[i], 6)} s`, [['rendered', `${number(rendered[i])} N`, 'rendered'], ['sent', `${number(sent[i])} N`, 'sent']]],
  });
  const thinned = shown < figures.ticks ? ` ${count(shown)} of ${count(figures.ticks)} ticks are drawn, the least and the largest of each stretch.` : '';
  return [
    el('.key', {}, el('span.named', {}, el('span.swatch.rendered'), 'rendered'), el('span.named', {}, el('span.swatch.sent'), 'sent')),
    figure(`The force as rendered, and as the guards let it through to the device.${thinned} Drag to zoom, double-click to see all.`, chart.element),
  ];
}

const titles = {run: 'A loop and its timing', recording: 'A recording of the loop', session: 'A loop, its timing and its recording'};

// The figures of a run and its recording, which say the same command line, are one result: figures are the run's where
// both have them.
export function together(results) {
  const partner = {run: 'recording', recording: 'run'}, made = [];
  for (const result of results) {
    const line = result.origin.command_line;
    const at = made.findIndex(other => other.kind === partner[result.kind] && line && other.origin.command_line === line);
    if (at < 0) {
      made.push(result);
      continue;
    }
    const [run, recording] = result.kind === 'run' ? [result, made[at]] : [made[at], result];
    made[at] = {...recording, kind: 'session', file: `${run.file}, ${recording.file}`,
      origin: {...recording.origin, ...run.origin}, figures: {...recording.figures, ...run.figures}};
  }
  return made;
}

export function loopSection(result) {
  const {kind, figures} = result;
  return {title: titles[kind], content: [facts(figures), ...(result.time ? forces(result) : []), timings(figures), guards(figures)].filter(Boolean)};
}
