// Records docs/view.webp, the moving picture of gliss view: a hand slides over the knot. usage: node
// record_view.mjs GLISS PACKAGES OUT.webp; PACKAGES: build/report. It needs Chromium.
import {execFileSync} from 'node:child_process';
import {mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join, resolve} from 'node:path';
import {cell, interrupt, launch, number, open, serve, sleep} from '../../tests/support/view_browser.mjs';

const [gliss, packages, out] = process.argv.slice(2).map(path => resolve(path));
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

const folder = mkdtempSync(join(tmpdir(), 'gliss-view-'));
execFileSync(gliss, ['generate', 'knot', '-o', 'knot.obj', '--quiet'], {cwd: folder});
const browser = await launch(packages);
const server = await serve(gliss, folder, 'knot.obj', '--unit', 'mm', '--settle', '0');
try {
  const {page} = await open(browser, server.url, 'light', size.width);
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
  const file = animation(pictures, size.width * scale, size.height * scale, every);
  writeFileSync(out, file);
  console.log(`${out}: ${(file.length / 1e6).toFixed(2)} MB`);
} finally {
  await browser.close();
  await interrupt(server);
  rmSync(folder, {recursive: true});
}
