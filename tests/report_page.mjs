// The page of gliss report in a browser, from a file, without a network: it draws, tells values, and complains of nothing.
// usage: node report_page.mjs GLISS PACKAGES SOURCES FOLDER; pictures of the page stay in FOLDER.
// Exit code 77, "skipped", where this machine has no Chromium or the build no report.
import assert from 'node:assert/strict';
import {execFileSync, spawnSync} from 'node:child_process';
import {existsSync, mkdirSync, rmSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const [gliss, packages, sources, folder] = process.argv.slice(2).map(path => resolve(path));

function skip(why) {
  console.log(`skipped: ${why}`);
  process.exit(77);
}

function findChromium() {
  for (const name of ['chromium', 'chromium-browser', 'google-chrome']) {
    for (const path of process.env.PATH.split(':')) {
      const file = join(path, name);
      // Ubuntu's package of that name only asks for a snap.
      if (existsSync(file) && spawnSync(file, ['--version']).status === 0) return file;
    }
  }
  return null;
}

const chromium = findChromium();
if (!chromium) skip('no Chromium in PATH');
if (!existsSync(join(packages, 'package.json'))) {
  assert.notEqual(process.env.GLISS_REQUIRE, '1', 'GLISS_REQUIRE, but this build has no report');
  skip('this build has no report');
}
const puppeteer = createRequire(join(packages, 'package.json'))('puppeteer-core');

const run = (program, ...words) => execFileSync(program, words, {cwd: folder, maxBuffer: 1 << 26});

function makeResults() {
  rmSync(folder, {recursive: true, force: true});
  mkdirSync(folder, {recursive: true});
  run(gliss, 'generate', 'knot', '-o', 'knot.obj', '--quiet');
  run(gliss, 'sweep', 'knot.obj', '--depth', '2mm,4mm', '--samples', '90000', '--unit', 'mm', '-o', 'knot.h5', '--quiet');
  writeFileSync(join(folder, 'path.csv'), run('python3', join(sources, 'tools', 'knot_path.py')));
  run(gliss, 'trace', 'knot.obj', '--path', 'path.csv', '--unit', 'mm', '-o', 'knot_forces.csv', '--quiet');
  run(gliss, 'trace', 'knot.obj', '--path', 'path.csv', '--unit', 'mm', '--friction', '0.5,0.3', '-o', 'path.h5', '--quiet');
  writeFileSync(join(folder, 'scene.toml'), `[[object]]
name = "knot"
mesh = "knot.obj"
unit = "mm"
[sim]
path = "path.csv"
interval = "1ms"
`);
  run(gliss, 'run', 'scene.toml', '--no-wait', '--seconds', '2', '--quiet', '--record', 'run.h5', '--report', 'run.json');
  writeFileSync(join(folder, 'compare.json'), JSON.stringify(comparison()));
  run(gliss, 'report', 'knot_forces.csv', 'knot.h5', 'compare.json', 'run.json', 'run.h5', 'path.h5', '-o', 'report.html', '--quiet');
  run(gliss, 'report', 'knot.h5', 'knot_forces.csv', '-o', 'knot.html', '--quiet');
  writeFileSync(join(folder, 'pictured.json'), JSON.stringify(pictured()));
  run(gliss, 'report', 'pictured.json', '-o', 'pictured.html', '--quiet');
}

// Results with little or nothing in them.
function makeOddResults() {
  const header = 'step,method,x,y,z,scp_x,scp_y,scp_z,fx,fy,fz,patch,state\n';
  writeFileSync(join(folder, 'free.csv'), `${header}0,flat,0,0,0,0,0,0,0,0,0,0,free\n`);
  writeFileSync(join(folder, 'two.csv'), header + [0, 1].map(i => `${i},new,0,0,0,0,0,0,0,0,1,0,contact\n`).join(''));
  writeFileSync(join(folder, 'none.json'), '{"mesh": null, "rows": [], "dense": [], "recommended": null}');
  writeFileSync(join(folder, 'still.json'), '{"histograms": {"wake": [], "compute": [[1, 1]]}}');
  writeFileSync(join(folder, 'none.csv'),
      'time,lateness,compute,missed,fx,fy,fz,sent_x,sent_y,sent_z,state,guard,reason\n');
  run(gliss, 'sweep', 'knot.obj', '--depth', '30mm', '--rings', '1', '--method', 'flat', '--unit', 'mm', '-o', 'deep.h5', '--quiet');
  run(gliss, 'report', 'free.csv', 'two.csv', 'none.json', 'still.json', 'none.csv', 'deep.h5', '-o', 'odd.html', '--quiet');
}

// As gliss compare --json prints it, with figures that were not measured.
function comparison() {
  const rows = [];
  for (const [l, level] of ['full', 'reduced', 'flat'].entries()) {
    for (const [p, precision] of ['double', 'float'].entries()) {
      rows.push({level, precision, solver: 'newton', backend: 'tbb', bytes_per_patch: (1400 >> p) / (l + 1),
        build_per_s: 9e4, eval_per_s: 4e6 * (l + 1) * (p + 1), track_per_s: null, max_distance: 1e-5 * (l + 0.1),
        p99_distance: 4e-6 * (l + 0.1), max_normal_gap_deg: p ? null : 3 * l, max_force_step: 0.02 + 0.2 * l,
        p99_normal_gap_deg: p ? null : 2 * l, p99_force_step: 0.01 + 0.1 * l, walk_max_force_step: 0.03 + 0.3 * l,
        jumps_per_100k: 20 * l, lost_per_100k: l, unsound: 0, p99_force_error: 0.0005 + 0.02 * l, max_force_error: 0.001 + 0.04 * l + 1e-4 * p, tick_us: 3.1 / (l + 1) + (p ? -0.1 : 0), pareto: p === 1 || l === 0});
    }
  }
  const dense = [{method: 'shaded', triangles: 184320, bytes: 22118400, max_force_step: 0.021, tick_us: 2.1, target_level: 'full',
    target_bytes: 2016000, target_tick_us: 3.1, memory_ratio: 10.97, time_ratio: 0.68, reached: true},
    {method: 'flat', triangles: 737280, bytes: 59000000, max_force_step: 0.06, tick_us: 2.6, target_level: 'full',
      target_bytes: 2016000, target_tick_us: 3.1, memory_ratio: 29.3, time_ratio: null, reached: false}];
  return {mesh: 'knot.obj', faces: 1440, rows, dense, walks: {walkers: 8, walks: 8, ticks: 2500, depth_m: 0.0005, step: 0.01, seed: 1},
    recommended: {level: 'full', precision: 'float', solver: 'newton', backend: 'tbb'}};
}

const packed = array => ({[array instanceof Float32Array ? 'f32' : 'u32']: Buffer.from(array.buffer).toString('base64')});

// `count` points spread over a ball of radius 10.
const onBall = count => Array.from({length: count}, (_, i) => {
  const [z, turn] = [1 - (2 * i + 1) / count, 2.399963 * i], r = Math.sqrt(1 - z * z);
  return [10 * r * Math.cos(turn), 10 * r * Math.sin(turn), 10 * z];
});

// A ball as gliss compare --picture tells it: smooth, and with bumps.
function picture(construction, bump) {
  const points = 3000, position = Float32Array.from(onBall(points).flat());
  const all = of => Float32Array.from({length: points}, (_, i) => of(i));
  return {construction, points, p50_curvature: 100, p99_curvature: 100 * bump, max_curvature: null,
    face: packed(Uint32Array.from({length: points}, (_, i) => i >> 2)), position: packed(position),
    normal: packed(position.map(x => x / 10)), spot: packed(all(() => 1.2)), curvature: packed(all(i => i % 7 ? 100 : 100 * bump)),
    departure: packed(all(i => i % 5 * 1e-4 * bump))};
}

// Jumps all over that ball.
const jumpsOf = step => onBall(200).map((position, face) => ({position, face, step, lost: face % 2 === 0}));

// The rows of comparison() with pictures, where a row has no jumps.
function pictured() {
  const made = comparison();
  made.rows = made.rows.map((row, i) => ({...row, construction: ['fair', 'paper', null][i >> 1],
    level: ['fair', 'exact', 'flat'][i >> 1], jumps: i < 2 ? [] : jumpsOf(i / 4)}));
  return {...made, unit: 'mm', picture: [picture('fair', 1), picture('paper', 40)]};
}

const patience = 300000;  // ms, with what takes a second

async function open(browser, name, theme, width = 1280) {
  const page = await browser.newPage();
  page.setDefaultTimeout(patience);
  const complaints = [];
  // The software renderer's own warnings are not the page's.
  page.on('console', message => {
    const ours = !/GL Driver Message|GPU stall/.test(message.text());
    if (['error', 'warn', 'warning'].includes(message.type()) && ours) complaints.push(message.text());
  });
  page.on('pageerror', error => complaints.push(String(error)));
  page.on('request', request => {
    if (!/^(file|data|blob):/.test(request.url())) complaints.push(`asks for ${request.url()}`);
  });
  await page.setOfflineMode(true);
  await page.setViewport({width, height: 960});
  await page.emulateMediaFeatures([{name: 'prefers-color-scheme', value: theme}]);
  await page.goto(pathToFileURL(join(folder, name)).href);
  await page.waitForSelector('html[data-ready]');
  await settle(page);
  return {page, complaints};
}

// Until what was asked for is drawn.
const settle = page => page.evaluate(
    () => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 50)))));

// How many colours the middle of a view has: one where nothing is drawn.
const colors = (page, selector) => page.$eval(selector, canvas => {
  const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  const seen = new Set();
  for (let i = 0; i < data.length; i += 4) seen.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2]);
  return seen.size;
});

async function center(page, selector) {
  const handle = await page.$(selector);
  assert(handle, `${selector} is not there`);
  await handle.evaluate(element => element.scrollIntoView({block: 'center', behavior: 'instant'}));
  await settle(page);
  const box = await handle.boundingBox();
  return [box.x + box.width / 2, box.y + box.height / 2];
}

async function tooltip(page) {
  await settle(page);
  return page.$eval('.tooltip', box => box.hidden ? '' : box.innerText);
}

async function checkViews(page) {
  const views = await page.$$eval('canvas[data-view]', all => all.map(canvas => canvas.dataset.view));
  assert.deepEqual(views, ['2mm', '4mm'].flatMap(d => ['flat', 'shaded', 'gregory'].map(m => `${d}/${m}`)));
  for (const view of views) {
    await center(page, `[data-view="${view}"]`);
    assert(await colors(page, `[data-view="${view}"]`) > 100, `${view} is blank`);
  }
  // Off the middle, where the knot has a hole.
  const first = '[data-view="2mm/flat"]';
  const [x, y] = await center(page, first);
  let told = '';
  for (let away = 0; away < 120 && !told; away += 12) {
    await page.mouse.move(x + away, y);
    told = await tooltip(page);
  }
  assert.match(told, /Patch \d+, 2 mm deep[^]*Flat polygons\s+[\d.]+ N, [\d.]+° off[^]*Gregory patches\s+[\d.]+ N[^]*HIP/);

  const picture = () => page.$$eval('canvas[data-view]', all => all.map(canvas => canvas.toDataURL()));
  const before = await picture();
  await page.mouse.down();
  await page.mouse.move(x + 160, y + 40, {steps: 3});
  await page.mouse.up();
  await page.mouse.move(1, 1);
  await settle(page);
  const after = await picture();
  assert(before.every((image, i) => image !== after[i]), 'turning one view turns all');
  await page.keyboard.press('0');
  await settle(page);
  const again = await picture();
  assert(again.every((image, i) => image !== after[i]), 'the key 0 resets the views');
}

async function checkBars(page) {
  const over = '[aria-label*="from tick to tick, Flat"] .u-over';
  const [x, y] = await center(page, over);
  await page.mouse.move(x, y);
  assert.match(await tooltip(page), /Tick [34]\d\d[^]*Flat polygons\s+[\d.]+ N[^]*Gregory patches\s+[\d.·⁻⁰-⁹]+ N[^]*HIP/);
  await page.mouse.down();
  await page.mouse.move(x + 80, y, {steps: 4});
  await page.mouse.up();
  await page.mouse.move(x - 100, y);
  assert.match(await tooltip(page), /Tick [34]\d\d/, 'a drag zooms in');
  const peak = await page.$eval('td button', button => (button.click(), button.title));
  const [tick] = peak.match(/\d+/);
  const [x2, y2] = await center(page, over);
  await page.mouse.move(x2, y2);
  assert.match(await tooltip(page), new RegExp(`Tick ${tick}`), 'a peak of the table leads to its tick');
  await page.focus('[aria-label*="from tick to tick, Flat"]');
  await page.mouse.move(1, 1);
  await page.keyboard.press('ArrowRight');
  assert.match(await tooltip(page), new RegExp(`Tick ${Number(tick) + 1}`), 'keys move the cursor');
}

async function checkCharts(page) {
  for (const [label, told] of [['Distribution of the step across edges, 2mm', /to [^]* N[^]*%/], ['largest error of force, share of k d over tick', /\w+, (double|float)/],
    ['Distribution: Computing', /µs[^]*%/], ['Force along the path', /Tick \d+[^]*Flat polygons\s+[\d.]+ N[^]*Gregory patches\s+[\d.]+ N/],
    ['Share of the friction cone', /Tick \d+[^]*Flat polygons\s+[\d.]+[^]*Gregory patches\s+[\d.]+/],
    ['Force over time', / s[^]*rendered[^]*sent/]]) {
    const chart = `[aria-label*="${label}"]`;
    await center(page, chart);
    await page.focus(chart);
    await page.keyboard.press('ArrowRight');
    assert.match(await tooltip(page), told, label);
  }
}

// The tip is never cut, and lies within the chart or picture that it belongs to where it has room there.
async function checkTips(page) {
  for (const chart of await page.$$('.chart')) {
    await chart.evaluate(element => element.scrollIntoView({block: 'center', behavior: 'instant'}));
    await settle(page);
    const {x, y, width, height} = await chart.boundingBox();
    for (const [across, down] of [[0.2, 0.2], [0.97, 0.2], [0.97, 0.8], [0.3, 0.8]]) {
      await page.mouse.move(x + across * width, y + down * height);
      if (!await tooltip(page)) continue;
      const tip = await page.$eval('.tooltip', box => {
        const {left, top, right, bottom} = box.getBoundingClientRect();
        return {left, top, right, bottom, whole: box.scrollWidth <= box.clientWidth,
          wide: document.documentElement.clientWidth, high: document.documentElement.clientHeight};
      });
      assert(tip.whole && tip.left >= 0 && tip.top >= 0 && tip.right <= tip.wide && tip.bottom <= tip.high, 'the tip is cut');
      if (tip.right - tip.left <= width - 8) assert(tip.left >= x - 0.5 && tip.right <= x + width + 0.5, 'the tip leaves its chart');
      if (tip.bottom - tip.top <= height) assert(tip.top >= y - 0.5 && tip.bottom <= y + height + 0.5, 'the tip leaves its chart');
    }
  }
}

const choice = (page, label) => page.evaluateHandle(
    wanted => [...document.querySelectorAll('.choice')].find(c => c.innerText.startsWith(wanted)).querySelector('select'), label);
const choose = async (page, list, value) => {
  await list.evaluate((element, chosen) => ((element.value = chosen), element.dispatchEvent(new Event('change'))), value);
  await settle(page);
};

// Rows whose figure is 0 are points as well: the comparison's rows of level full have no jumps.
async function checkZeros(page) {
  await choose(page, await choice(page, 'Upward'), 'jumps');
  const chart = '[aria-label^="jumps per"]';
  await center(page, chart);
  await page.focus(chart);
  const told = [];
  for (let i = 0; i < 6; i++) {
    await page.keyboard.press('ArrowRight');
    told.push(await tooltip(page));
  }
  for (const level of ['full', 'reduced', 'flat']) {
    for (const precision of ['double', 'float']) assert(told.some(text => text.startsWith(`${level}, ${precision}`)), `${level}, ${precision} is not drawn`);
  }
  await page.keyboard.press('Escape');
}

// What all rows share stands in the caption, and the column that names them stays when the table is scrolled.
async function checkTables(page) {
  const about = await page.evaluate(() => {
    const made = [...document.querySelectorAll('.tabled')].find(t => t.innerText.startsWith('All that was compared'));
    const scroll = made.querySelector('.table'), name = made.querySelector('tbody tr:last-child > *');
    const before = name.getBoundingClientRect().left;
    scroll.scrollLeft = 90;
    const moved = name.getBoundingClientRect().left - before, by = scroll.scrollLeft;
    scroll.scrollLeft = 0;
    return {caption: made.querySelector('.caption').innerText, heads: [...made.querySelectorAll('thead th')].map(th => th.innerText), moved, by};
  });
  assert.match(about.caption, /In all rows: Solver newton; Backend tbb/);
  assert.equal(about.heads[0], 'Surface, precision');
  assert(!about.heads.includes('Solver'));
  assert(about.by > 50 && Math.abs(about.moved) < 1, 'the first column stays');
}

// A run's figures and its recording are one section; sections name what their files say.
async function checkFacts(page) {
  const found = await page.$$eval('section', all => all.map(s => [s.querySelector('h2').innerText, s.querySelector('.origin').innerText]));
  const about = Object.fromEntries(found);
  assert.deepEqual(found.map(([file]) => file), ['knot_forces.csv', 'knot.h5', 'compare.json', 'run.json, run.h5', 'path.h5']);
  for (const file of ['knot.h5', 'run.json, run.h5', 'path.h5']) assert.match(about[file], /Mesh\s+knot.obj[^]*Stiffness\s+0\.500 N\/mm/);
  assert.match(about['knot_forces.csv'], /Depth\s+at most [\d.]+ units of the file/);
  assert.match(about['path.h5'], /Depth\s+at most 2\.\d\d mm/);
  assert.match(about['knot.h5'], /Depth\s+2 mm, 4 mm/);
}

// Surfaces, and dots where rows jump, which a choice brings and takes away.
async function checkSurfaces(page) {
  const views = await page.$$eval('canvas[data-view]', all => all.map(canvas => canvas.dataset.view));
  assert.deepEqual(views, ['surface/fair', 'surface/paper']);
  assert(await page.$$eval('.scale .mark', all => all.length) > 2, 'the scale of curvature has numbers');
  const about = () => page.$$eval('.view h4', all => all.map(h => h.innerText));
  const [fair, paper] = await about();
  assert.match(fair, /Fair patches[^]*0\.100 \/mm in the median[^]*0 jumps marked \(fair/);
  assert.match(paper, /Paper’s patches[^]*4\.00 \/mm at 99 %[^]*200 jumps marked \(exact/);
  const picture = () => page.$$eval('canvas[data-view]', all => all.map(canvas => canvas.toDataURL()));
  for (const view of views) {
    await center(page, `[data-view="${view}"]`);
    assert(await colors(page, `[data-view="${view}"]`) > 100, `${view} is blank`);
  }
  const own = await picture();
  const surface = await choice(page, 'Surface');
  await choose(page, surface, 'departure');
  const departing = await picture();
  assert(departing.every((image, i) => image !== own[i]), 'departure has colours of its own');
  assert.match(await page.$eval('.scale .aside', aside => aside.innerText), /departure[^]*16\.0 mm/);
  await choose(page, surface, 'curvature');
  assert.deepEqual(await picture(), own);
  const jumps = await choice(page, 'Jumps of');
  const marked = async value => {
    await choose(page, jumps, value);
    return picture();
  };
  const none = await marked('');
  assert(own[0] === none[0] && own[1] !== none[1], 'dots are marked where a construction jumps');
  assert((await about()).every(text => !text.includes('jumps marked')));
  const flat = await marked('4');
  assert(flat.every((image, i) => image !== none[i]), 'a row is marked in all views');

  // A dot and a face without one, somewhere on the ball.
  const wanted = [/Jump on face \d[^]*step\s+100 % of k d[^]*contact\s+(lost|kept)[^]*mm/,
    /Face \d+[^]*Fair patches\s+0\.100 \/mm, radius 10\.0 mm[^]*Paper’s patches\s+4\.00 \/mm/];
  const [x, y] = await center(page, '[data-view="surface/paper"]');
  for (let down = -120; down <= 120 && wanted.length; down += 8) {
    for (let across = -120; across <= 120 && wanted.length; across += 8) {
      await page.mouse.move(x + across, y + down);
      const told = await page.$eval('.tooltip', box => box.hidden ? '' : box.innerText);
      const found = wanted.findIndex(pattern => pattern.test(told));
      if (found >= 0) wanted.splice(found, 1);
    }
  }
  assert.deepEqual(wanted, [], 'dots tell their jumps, faces their curvatures');
  const [heads] = await page.$$eval('.table table', all => all.map(t => [...t.tHead.rows[0].cells].map(c => c.innerText.trim())));
  assert.deepEqual(heads, ['Figure', 'Fair patches', 'Paper’s patches', 'Flat polygons']);
}

const brightness = page => page.evaluate(() => {
  const [r, g, b] = getComputedStyle(document.querySelector('section')).backgroundColor.match(/\d+/g).map(Number);
  return (r + g + b) / 3;
});

makeResults();
makeOddResults();
const browser = await puppeteer.launch({
  executablePath: chromium,
  timeout: patience,
  protocolTimeout: patience,
  args: ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--hide-scrollbars',
    ...(process.getuid() === 0 ? ['--no-sandbox'] : [])],
});
try {
  for (const theme of ['light', 'dark']) {
    const {page, complaints} = await open(browser, 'report.html', theme);
    assert.equal(await brightness(page) > 128, theme === 'light', theme);
    await checkBars(page);
    await checkViews(page);
    await checkCharts(page);
    await checkZeros(page);
    await checkFacts(page);
    await checkTips(page);
    await page.screenshot({path: join(folder, `${theme}.png`), fullPage: true});
    await page.click('.theme');
    assert.equal(await brightness(page) > 128, theme === 'dark', 'the button changes the theme');
    assert.deepEqual(complaints, []);
    await page.close();
  }
  for (const [name, width] of [['surfaces', 1400], ['narrow-surfaces', 420]]) {
    const {page, complaints} = await open(browser, 'pictured.html', 'light', width);
    assert(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'nothing is wider than the page');
    await page.screenshot({path: join(folder, `${name}.png`), fullPage: true});
    if (width > 1000) await checkSurfaces(page);
    else await checkTips(page);
    await page.close();
  }
  {
    const {page, complaints} = await open(browser, 'report.html', 'light', 420);
    assert(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'nothing is wider than the page');
    await checkTables(page);
    await checkTips(page);
    assert.deepEqual(complaints, []);
    await page.close();
  }
  const {page: odd, complaints} = await open(browser, 'odd.html', 'light');
  assert.equal((await odd.$$('section')).length, 6);
  assert.deepEqual(complaints, []);
  await odd.close();
  for (const [name, width] of [['narrow', 400], ['wide', 1100]]) {
    const {page, complaints} = await open(browser, 'knot.html', 'light', width);
    assert(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'nothing is wider than the page');
    // The wide one is docs/report.png.
    await page.screenshot({path: join(folder, `${name}.png`), fullPage: name === 'narrow'});
    assert.deepEqual(complaints, []);
    await page.close();
  }
} finally {
  await browser.close();
}
console.log(`the page draws; its pictures are in ${folder}`);
