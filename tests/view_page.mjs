// The page of gliss view in a browser: one slides over a knot and sees what each method does, and nothing complains.
// usage: node view_page.mjs GLISS PACKAGES FOLDER; pictures stay in FOLDER.
// Exit code 77, "skipped", where this machine has no Chromium or the build no page.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {existsSync, mkdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {join, resolve} from 'node:path';
import {cell, choose, colors, interrupt, launch, number, open, press, serve, shot, sleep, status, until} from './support/view_browser.mjs';

const [gliss, packages, folder] = process.argv.slice(2).map(path => resolve(path));

rmSync(folder, {recursive: true, force: true});
mkdirSync(folder, {recursive: true});
const run = (...words) => execFileSync(gliss, words, {cwd: folder, stdio: ['ignore', 'pipe', 'pipe']});
run('generate', 'knot', '-o', 'knot.obj', '--quiet');
// The same in metres, in which a recording as CSV is.
writeFileSync(join(folder, 'metres.obj'), readFileSync(join(folder, 'knot.obj'), 'utf8').replace(/^v .*$/gm,
    line => `v ${line.split(/\s+/).slice(1, 4).map(x => x / 1000).join(' ')}`));

// Until the loop has let a force out.
const isRunning = page => until('the loop runs', async () => (await status(page)) === 'The loop runs');
const isTouching = page => until('the hand touches', async () => (await cell(page, 'gregory', 4)) !== 'free' && number(await cell(page, 'gregory', 1)) > 0.05);

// A place of the canvas where the knot is, with as much of it to both sides as can be.
async function onTheKnot(page) {
  const {x, y, width, height} = await (await page.$('.stage')).boundingBox();
  return {x: x + width / 2, y: y + height / 2, width, height};
}

// Presses somewhere on the knot and slides about, until edges were crossed.
async function slide(page, seconds) {
  const {x, y, width, height} = await onTheKnot(page);
  // The middle may be a hole of the knot: look for a place to touch, beside it.
  let from = null;
  for (let radius = 0.1; radius < 0.45 && !from; radius += 0.05) {
    for (let turn = 0; turn < 2 * Math.PI && !from; turn += 0.3) {
      const [px, py] = [x + radius * width * Math.cos(turn) * 0.6, y + radius * height * Math.sin(turn)];
      await page.mouse.move(px, py);
      await sleep(400);
      await page.mouse.down();
      for (let i = 0; i < 12 && !from; i++) {
        await sleep(100);
        if (number(await cell(page, 'gregory', 1)) > 0.05) from = [px, py];
      }
      if (!from) await page.mouse.up();
    }
  }
  assert(from, 'some place can be touched');
  await slideFrom(page, from, seconds);
  return from;
}

// Slides to and fro, from a place that is touched, by small steps, however busy the machine is. Twelve seconds are longer
// than the plots show, so that the way in is forgotten.
async function slideFrom(page, from, seconds = 12) {
  const {x, y} = await onTheKnot(page), [dx, dy] = [x - from[0], y - from[1]];
  const end = Date.now() + 1000 * seconds;
  for (let turn = 0; Date.now() < end; turn += 0.06) {
    const share = 0.12 * Math.sin(turn);
    await page.mouse.move(from[0] - share * dy, from[1] + share * dx);
    await sleep(25);
  }
}

// The largest steps of the last ten seconds: [flat, shaded, gregory] in N.
const largestSteps = page => Promise.all(['flat', 'shaded', 'gregory'].map(async method => number(await cell(page, method, 3))));

const browser = await launch(packages);
let server = null;
try {
  server = await serve(gliss, folder, 'knot.obj', '--record', 'whole.h5');
  const {page, complaints} = await open(browser, server.url);
  await until('it steers', async () => /^The loop/.test(await status(page)));
  assert.match(server.told, /no --unit: taken as mm/);
  assert(await colors(page) > 100, 'the knot is drawn');

  await isRunning(page);
  await choose(page, 'Settle', 0);  // steps as they are: nothing slides where the nearest point leaps
  const from = await slide(page);
  await page.screenshot({path: join(folder, 'touch.png')});
  // Where the machine is so busy that the guard lets the hand go, it comes in anew, with a step by any method.
  let [flat, shaded, gregory] = await largestSteps(page);
  for (let tries = 0; tries < 5 && !(flat > 10 * gregory); tries++) {
    await slideFrom(page, from);
    [flat, shaded, gregory] = await largestSteps(page);
  }
  console.log(`largest steps: flat ${flat}, shaded ${shaded}, gregory ${gregory} N`);
  assert(flat > 10 * gregory, `flat's step ${flat} N is more than ten times gregory's ${gregory} N`);
  for (const chart of await page.$$('.chart')) {
    await chart.evaluate(element => element.focus());
    await page.keyboard.press('ArrowRight');
    assert.match(await page.$eval('.tooltip', box => box.innerText), /Flat polygons, force\s+\S+[^]*Gregory patches, depth/, 'charts tell all three');
  }
  await page.mouse.up();

  // Turning moves pixels.
  const before = await shot(page);
  await page.focus('.stage');
  await page.keyboard.press('ArrowLeft');
  await sleep(300);
  assert.notEqual(await shot(page), before, 'a key turns the view');
  await page.keyboard.press('ArrowRight');

  // Tuning, here and in the other page, which only watches.
  const {page: other, complaints: others} = await open(browser, server.url, 'dark', 420);
  assert.match(await status(other), /Another page steers/);
  assert(await other.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'nothing is wider than the page');
  await press(other, 'Flat polygons');
  await sleep(300);
  await page.bringToFront();  // a page behind another draws nothing
  const chosen = of => of.$eval('.methods [aria-pressed="true"]', button => button.dataset.method);
  assert.equal(await chosen(page), 'gregory', 'a page that watches tunes nothing');
  await page.focus('body');
  await page.keyboard.press('m');
  await until('the method goes round', async () => (await chosen(page)) === 'flat');
  await until('the other page is told', async () => (await chosen(other)) === 'flat');
  await choose(page, 'Stiffness', 1000);
  await until('the stiffness is the largest that the hand takes', () => other.evaluate(() => document.body.innerText.includes('2.00 N/mm')));
  await page.evaluate(() => document.activeElement.blur());
  await page.screenshot({path: join(folder, 'wide.png'), fullPage: true});
  await other.bringToFront();
  await other.screenshot({path: join(folder, 'narrow.png'), fullPage: true});
  await page.bringToFront();
  assert.deepEqual(others, []);
  for (const [label, value] of [['Colour', 'kind'], ['Colour', 'height'], ['Colour', 'curvature'], ['Show', 'polygons'], ['Show', 'both'], ['Sound', '0']]) {
    await choose(page, label, value);
    await sleep(200);
    assert(await colors(page) > 50, `${label} ${value} is drawn`);
  }

  // By keys alone, and to a further recording.
  await press(page, 'Stop recording');
  await until('the recording ends', () => page.evaluate(() => document.body.innerText.includes('Recorded whole.h5')));
  await press(page, 'Record');
  await until('another begins', () => page.evaluate(() => document.body.innerText.includes('Records to whole-2.h5')));
  await page.mouse.move(from[0], from[1]);
  await page.mouse.move(from[0] + 1, from[1]);
  await page.focus('body');
  await sleep(1000);
  await page.keyboard.press('Space');
  await until('space touches', async () => number(await cell(page, 'gregory', 1)) > 0.05 || null);
  for (const key of ['a', 'a', 'w', 'd', 'e', 'q']) await page.keyboard.press(key);
  await page.keyboard.press('Space');
  await sleep(500);
  await press(page, 'Stop recording');
  await until('it ends', () => page.evaluate(() => document.body.innerText.includes('Recorded whole-2.h5')));
  assert(existsSync(join(folder, 'whole-2.h5')));

  // The server goes, comes again, and the pages find it.
  assert.equal(await interrupt(server), 130);
  const figures = JSON.parse(server.out);
  assert(figures.in_contact > 100 && figures.pages === 2 && figures.refused === 0, server.out);
  assert.deepEqual(figures.recorded, ['whole.h5', 'whole-2.h5']);
  await until('the page sees that', async () => /server is gone/.test(await status(page)));
  const port = server.port;
  server = await serve(gliss, folder, 'metres.obj', '--port', port, '--unit', 'm', '--record', 'plain.csv');
  await until('the page is back', async () => /^The loop|^Another/.test(await status(page)));
  await other.close();
  await until('it steers', async () => /^The loop/.test(await status(page)));
  await isRunning(page);
  await slide(page, 3);
  await page.mouse.up();
  await sleep(300);

  // A page that is gone in contact: the force ends.
  await page.mouse.move(from[0], from[1]);
  await sleep(1000);
  await page.mouse.down();
  await isTouching(page);
  assert.deepEqual(complaints, []);
  await page.close();
  await sleep(600);
  assert.equal(await interrupt(server), 130);
  assert(server.took < 500 || process.env.GLISS_SLOW, `Ctrl-C took ${server.took} ms`);

  // What was felt is what gliss trace makes of the path.
  const rows = text => text.trim().split('\n').map(line => line.split(','));
  const [head, ...ticks] = rows(readFileSync(join(folder, 'plain.csv'), 'utf8'));
  const column = name => head.indexOf(name);
  assert(Number(ticks.at(-1)[column('sent_x')]) === 0, 'no force at the end');
  const lastSent = ticks.findLastIndex(tick => ['sent_x', 'sent_y', 'sent_z'].some(name => Number(tick[column(name)]) !== 0));
  const silent = ticks.findLastIndex(tick => Number(tick[column('age')]) < 1e-3);
  assert(lastSent > 0 && lastSent - silent <= 11, `the force ends ${lastSent - silent} ticks after the last input`);
  run('trace', 'metres.obj', '--unit', 'm', '--path', 'plain.csv', '--method', 'gregory', '-o', 'traced.csv', '--quiet');
  const [traceHead, ...traced] = rows(readFileSync(join(folder, 'traced.csv'), 'utf8'));
  const forces = (list, names) => list.map(row => ['fx', 'fy', 'fz'].map(name => row[names.indexOf(name)]).join());
  assert.equal(traced.length, ticks.length);
  assert.deepEqual(forces(traced, traceHead), forces(ticks, head), 'gliss trace gives the same forces');
} finally {
  server?.child.kill('SIGKILL');
  await browser.close();
}
console.log(`the page draws and touches; its pictures are in ${folder}`);
