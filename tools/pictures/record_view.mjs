// Records the pictures of gliss view for docs/: view.webp, which moves, a hand that slides over the knot; and
// view-*.webp, what the page can show of it. usage: node record_view.mjs GLISS PACKAGES DOCS; PACKAGES:
// build/report. It needs Chromium.
import {execFileSync} from 'node:child_process';
import {mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join, resolve} from 'node:path';
import {cell, choose, interrupt, launch, number, open, serve, sleep} from '../../tests/support/view_browser.mjs';

const [gliss, packages, docs] = process.argv.slice(2).map(path => resolve(path));
const size = {width: 1080, height: 620}, scale = 0.75, frames = 64, every = 120;  // pixels of the page; ms

// A chunk of a RIFF file: its name, its length, its bytes to an even end.
function chunk(name, ...parts) {
  const body = Buffer.concat(parts), head = Buffer.alloc(8);
  head.write(name, 'latin1');
  head.writeUInt32LE(body.length, 4);
  return Buffer.concat([head, body, Buffer.alloc(body.length % 2)]);
}

const bits24 = number => Buffer.from([number & 255, number >> 8 & 255, number >> 16]);

// The picture of a WebP file: its chunks but for what stands before.
function pictureOf(webp) {
  const parts = [];
  for (let at = 12; at < webp.length;) {
    const length = webp.readUInt32LE(at + 4), end = at + 8 + length + length % 2;
    if (/^(ALPH|VP8 |VP8L)$/.test(webp.toString('latin1', at, at + 4))) parts.push(webp.subarray(at, end));
    at = end;
  }
  return Buffer.concat(parts);
}

// One file that shows them one after another, for so many ms each, and again (WebP container specification, "Animation").
function animation(pictures, width, height, ms) {
  const extent = Buffer.concat([bits24(width - 1), bits24(height - 1)]);
  const head = chunk('VP8X', Buffer.from([2, 0, 0, 0]), extent), loop = chunk('ANIM', Buffer.alloc(6));
  const shown = pictures.map(picture => chunk('ANMF', Buffer.alloc(6), extent, bits24(ms), Buffer.from([2]), pictureOf(picture)));
  return chunk('RIFF', Buffer.from('WEBP'), head, loop, ...shown);
}

// A place of the stage where the hand feels the knot; the button is held there.
async function findPlace(page) {
  const {x, y, width, height} = await (await page.$('.stage')).boundingBox();
  for (let turn = 0; turn < 2 * Math.PI; turn += 0.3) {
    const place = [x + width * (0.5 + 0.16 * Math.cos(turn)), y + height * (0.5 + 0.28 * Math.sin(turn))];
    await page.mouse.move(...place);
    await page.mouse.down();
    await sleep(2000);
    if (number(await cell(page, 'gregory', 1)) > 0.1) return {place, centre: [x + width / 2, y + height / 2]};
    await page.mouse.up();
    await sleep(300);
  }
  throw new Error('the hand feels nothing');
}

// The page while a hand slides over the knot.
async function recordSlide(page) {
  await page.setViewport({...size, deviceScaleFactor: scale});
  await page.focus('.stage');
  for (let i = 0; i < 2; i++) await page.keyboard.press('+');
  const {place: [px, py], centre: [cx, cy]} = await findPlace(page);
  await sleep(10000);  // the way in leaves the plots
  const pictures = [];
  for (let i = 0; i < frames; i++) {
    const due = performance.now() + every, share = 0.3 * Math.sin(2 * Math.PI * i / frames);
    await page.mouse.move(px - share * (py - cy), py + share * (px - cx));
    pictures.push(Buffer.from(await page.screenshot({type: 'webp', quality: 55, clip: {x: 0, y: 0, ...size}})));
    await sleep(Math.max(0, due - performance.now()));
  }
  return animation(pictures, size.width * scale, size.height * scale, every);
}

// What the stage shows by each of these choices, touched where the hand feels something.
const views = {
  edges: [['Show', 'both']],
  polygons: [['Show', 'polygons']],
  departure: [['Show', 'surface'], ['Colour', 'height']],
  cut: [['Show', 'both'], ['Colour', 'clay'], ['across', '2'], ['Cut', 500]],
};
async function takeViews(page) {
  await page.setViewport({width: 480, height: 620});
  await sleep(500);
  await findPlace(page);
  const pictures = {};
  for (const [name, choices] of Object.entries(views)) {
    for (const choice of choices) await choose(page, ...choice);
    await sleep(800);
    pictures[name] = Buffer.from(await (await page.$('.stage')).screenshot({type: 'webp', quality: 70}));
  }
  return pictures;
}

function write(name, bytes) {
  writeFileSync(join(docs, name), bytes);
  console.log(`${name}: ${(bytes.length / 1e3).toFixed(0)} kB`);
}

const folder = mkdtempSync(join(tmpdir(), 'gliss-view-'));
const browser = await launch(packages);
// Calls `act` with a page of a knot of so many polygons.
async function onKnot(words, act) {
  execFileSync(gliss, ['generate', 'knot', '-o', 'knot.obj', '--quiet', ...words], {cwd: folder});
  const server = await serve(gliss, folder, 'knot.obj', '--unit', 'mm', '--settle', '0');
  try {
    return await act((await open(browser, server.url, 'light', size.width)).page);
  } finally {
    await interrupt(server);
  }
}
try {
  for (const [name, bytes] of Object.entries(await onKnot(['--along', '36', '--around', '5'], takeViews))) write(`view-${name}.webp`, bytes);
  write('view.webp', await onKnot([], recordSlide));
} finally {
  await browser.close();
  rmSync(folder, {recursive: true});
}
