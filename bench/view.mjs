// Measures gliss view in a headless Chromium that draws in software: how long a mesh of 100,000 polygons takes to open
// and how many frames a second it is then drawn with, and how many periods the loop misses with pages that are slow or
// gone. usage: node bench/view.mjs GLISS PACKAGES FOLDER [SECONDS]; PACKAGES: build/report, SECONDS: of each loop.
import {execFileSync} from 'node:child_process';
import {mkdirSync} from 'node:fs';
import {resolve} from 'node:path';
import {cell, interrupt, launch, open, serve, sleep, until} from '../tests/support/view_browser.mjs';

const [gliss, packages, folder] = process.argv.slice(2, 5).map(path => resolve(path)), seconds = Number(process.argv[5] ?? 20);
mkdirSync(folder, {recursive: true});
const generate = (kind, name, ...words) => execFileSync(gliss, ['generate', kind, '-o', name, '--quiet', ...words], {cwd: folder});
const onStage = async page => {
  const {x, y, width, height} = await (await page.$('.stage')).boundingBox();
  return (dx, dy) => [x + (0.5 + dx) * width, y + (0.5 + dy) * height];
};

// Frames of the stage in a second, while `act` goes on: those that the browser has drawn.
async function frames(page, act) {
  await page.evaluate(() => {
    [window.drawn, window.counting] = [0, true];
    const count = () => window.counting && (window.drawn++, requestAnimationFrame(count));
    requestAnimationFrame(count);
  });
  const began = performance.now();
  for (let i = 0; performance.now() < began + 5000; i++) (await act(i), await sleep(10));
  const took = (performance.now() - began) / 1e3;
  return await page.evaluate(() => (window.counting = false, window.drawn)) / took;
}

async function measureLarge(browser) {
  generate('torus', 'large.obj', '--along', '400', '--around', '250');
  const began = performance.now();
  const server = await serve(gliss, folder, 'large.obj', '--unit', 'mm');
  const served = performance.now();
  const {page} = await open(browser, server.url);
  await page.evaluate(() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done))));
  const drawn = performance.now();
  const at = await onStage(page);
  await page.mouse.move(...at(0.2, 0.1));
  await page.mouse.down();
  await sleep(1000);
  const touching = await frames(page, i => page.mouse.move(...at(0.2 + 0.02 * Math.sin(i / 20), 0.1)));
  await page.mouse.up();
  await page.mouse.move(...at(-0.48, -0.48));
  await page.mouse.down();
  const turning = await frames(page, i => page.mouse.move(...at(-0.48 + 0.1 * Math.sin(i / 20), -0.48)));
  await page.mouse.up();
  await page.close();
  await interrupt(server);
  console.log(`100,000 polygons: served after ${((served - began) / 1e3).toFixed(2)} s, drawn after ${((drawn - began) / 1e3).toFixed(2)} s; ` +
      `${touching.toFixed(0)} frames/s touching, ${turning.toFixed(0)} turning`);
}

// Ticks and missed periods of a loop with a page that `act` is done to.
async function missed(browser, act) {
  const server = await serve(gliss, folder, 'knot.obj', '--unit', 'mm');
  const page = act && (await open(browser, server.url)).page;
  if (page) {
    const at = await onStage(page);
    await page.mouse.move(...at(0.1, 0.15));
    await page.mouse.down();
    await until('the hand touches', async () => (await cell(page, 'gregory', 4)) !== 'free');
  }
  const end = performance.now() + 1e3 * seconds;
  if (page) await act(page, end);
  await sleep(Math.max(0, end - performance.now()));
  if (page && !page.isClosed()) await page.close();
  await interrupt(server);
  const {ticks, missed, in_contact, frames_lost} = JSON.parse(server.out);
  return {ticks, missed, in_contact, frames_lost};
}

const pages = {
  'no page': null,
  'a page that reads': async () => {},
  'a page that sleeps 5 s': async (page, end) => {
    while (performance.now() < end) await page.evaluate(() => { for (const until = performance.now() + 5000; performance.now() < until;); });
  },
  'a page that closes in contact': page => page.close(),
};

const browser = await launch(packages);
try {
  generate('knot', 'knot.obj');
  await measureLarge(browser);
  for (let round = 1; round <= 3; round++) {  // in turn: what else the machine does is alike for all
    for (const [name, act] of Object.entries(pages)) {
      const {ticks, missed: lost, in_contact: touched, frames_lost: frames} = await missed(browser, act);
      console.log(`round ${round}, ${name}: ${lost} of ${ticks} periods missed, ${touched} ticks in contact, ${frames} frames lost`);
    }
  }
} finally {
  await browser.close();
}
