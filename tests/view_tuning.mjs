// The page of gliss view changes what is touched: how it is built and feels, by whom it is moved, and which file it is.
// usage: node view_tuning.mjs GLISS PACKAGES FOLDER
// Exit code 77, "skipped", where this machine has no Chromium or the build no page.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {existsSync, mkdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {join, resolve} from 'node:path';
import {cell, choose, colors, interrupt, launch, number, open, press, serve, shot, sleep, status, tells, until} from './support/view_browser.mjs';

const [gliss, packages, folder] = process.argv.slice(2).map(path => resolve(path));
rmSync(folder, {recursive: true, force: true});
mkdirSync(folder, {recursive: true});
const file = name => join(folder, name);
const run = (...words) => execFileSync(gliss, words, {cwd: folder, stdio: ['ignore', 'pipe', 'pipe']});
run('generate', 'goldberg', '-o', 'ball.obj', '--quiet');
const about = page => page.$eval('.aside', element => element.innerText);
const force = async page => number(await cell(page, 'gregory', 1));

// A place of the canvas where a ball is.
async function place(page) {
  const {x, y, width, height} = await (await page.$('.stage')).boundingBox();
  return [x + width / 2, y + height / 2];
}

// Presses until the hand feels it, also where the guard let it go meanwhile.
async function touch(page) {
  await page.mouse.move(...await place(page));
  await page.mouse.down();
  await until('it is felt', async () => (await force(page)) > 0.05);
}

async function testTuning(page) {
  await touch(page);
  await choose(page, 'Texture', 'noise');
  await until('there is a texture', () => page.evaluate(() => document.querySelector('.choice output').innerText !== ''));
  await press(page, 'Copy command');
  await page.mouse.up();
  await choose(page, 'Construction', 'paper');
  await until('it is built again', async () => /exact/.test(await about(page)));
  await choose(page, 'Construction', 'fair');
  await until('and as it was', async () => /fair/.test(await about(page)));
  await choose(page, 'Level', 'bezier');
  await until('a level', async () => /fair-bezier/.test(await about(page)));
  await choose(page, 'Creases', 'none');
  await until('creases', async () => !(await page.$eval('.notice', element => element.innerText)).includes('Builds'));
  await sleep(500);
  await touch(page);
  await page.mouse.up();
  await press(page, 'Save scene');
  await tells(page, 'Saved ball-view.toml');
  const scene = readFileSync(file('ball-view.toml'), 'utf8');
  for (const line of [/level = 'bezier'/, /crease = 'none'/, /kind = 'noise'/, /unit = 'mm'/]) assert.match(scene, line);
}

async function testLoopAndReplay(page) {
  await press(page, 'Record');
  await tells(page, 'Records to gliss-view.h5');
  await touch(page);
  await press(page, 'Measure a loop');
  const [x, y] = await place(page);
  for (let turn = 0; turn <= 2 * Math.PI; turn += 0.1) {
    await page.mouse.move(x + 20 - 20 * Math.cos(turn), y + 20 * Math.sin(turn));
    await sleep(25);
  }
  await sleep(500);
  await press(page, 'End the loop');
  const told = await page.$eval('.loop', element => element.innerText);
  assert.match(told, /Net work on the hand: Flat polygons \S+ mJ, Force shading \S+ mJ, Gregory patches \S+ mJ; the ends are \S+ mm apart/);
  console.log(told);
  await page.mouse.up();
  await press(page, 'Stop recording');
  await tells(page, 'Recorded gliss-view.h5');
  await press(page, 'Replay');
  await until('the recording moves the hand', async () => /a recording moves the hand/.test(await status(page)));
  await until('it touches as it did', async () => (await force(page)) > 0.05);
  await until('it ends by itself', async () => !/a recording/.test(await status(page)), 60000);
  await touch(page);
  await page.mouse.up();
}

// A pad that is not there: its stick moves the hand, A presses, and it rumbles.
async function testGamepad(page) {
  await page.evaluate(() => {
    const button = () => ({value: 0});
    const pad = {axes: [0, 0, 0, 0], buttons: Array.from({length: 16}, button), vibrationActuator: {playEffect: async () => (window.rumbles = (window.rumbles ?? 0) + 1)}};
    navigator.getGamepads = () => [pad];
    window.pad = pad;
    dispatchEvent(new Event('gamepadconnected'));
  });
  await choose(page, 'Settle', 0);
  await press(page, 'Flat polygons');
  await page.evaluate(() => (window.pad.buttons[0].value = 1));
  await until('A presses', async () => (await force(page)) > 0.05);
  await until('it rumbles at the edges of flat polygons', async () => {
    await page.evaluate(() => (window.pad.axes[0] = 0.3 * Math.sign(Math.sin(performance.now() / 500))));
    return page.evaluate(() => window.rumbles > 0);
  });
  const before = await shot(page);
  await page.evaluate(() => (window.pad.axes = [0, 0, 1, 0], window.pad.buttons[0].value = 0));
  await sleep(500);
  assert.notEqual(await shot(page), before, 'the right stick turns');
  await page.evaluate(() => (navigator.getGamepads = () => []));
}

// Two balls, of which one goes; and a file that breaks and is mended.
async function testScene(page) {
  await until('both are there', async () => /polygons.*;.*polygons/.test(await about(page)));
  const both = await colors(page);
  await page.evaluate(() => document.querySelector('.methods input').click());
  await sleep(500);
  assert.notEqual(await colors(page), both, 'one is hidden');
  const good = readFileSync(file('two.toml'), 'utf8');
  writeFileSync(file('two.toml'), 'nothing = 1');
  await tells(page, 'two.toml:1: nothing');
  assert.match(await about(page), /polygons.*;.*polygons/, 'the old ones stay');
  writeFileSync(file('two.toml'), good.split('[[object]]').slice(0, 2).join('[[object]]'));
  await until('one object', async () => !/;.*polygons/.test(await about(page)));
}

const browser = await launch(packages);
let server = null;
try {
  server = await serve(gliss, folder, 'ball.obj', '--unit', 'mm');
  const {page, complaints} = await open(browser, server.url);
  await until('the loop runs', async () => (await status(page)) === 'The loop runs');
  await testTuning(page);
  await testLoopAndReplay(page);
  await testGamepad(page);
  assert.deepEqual(complaints, []);
  await page.close();
  assert.equal(await interrupt(server), 130, server.told);

  const object = (x, name) => `[[object]]\nname = "${name}"\nmesh = "ball.obj"\nunit = "mm"\nposition = [${x}, 0, 0]\n`;
  writeFileSync(file('two.toml'), object(0, 'left') + object(0.03, 'right'));
  server = await serve(gliss, folder, 'two.toml', '--watch');
  const {page: second, complaints: others} = await open(browser, server.url);
  await testScene(second);
  assert.deepEqual(others, []);
  await second.close();
  assert.equal(await interrupt(server), 130);

  // A device moves its own hand: the page of a replay watches.
  server = await serve(gliss, folder, 'ball.obj', '--unit', 'mm', '--device', 'replay:gliss-view.h5', '--seconds', '60');
  const {page: third} = await open(browser, server.url);
  await until('the device is told', async () => /replay:.* moves the hand/.test(await status(third)));
  await server.ended;
  assert(existsSync(file('gliss-view.h5')));
} finally {
  server?.child.kill('SIGKILL');
  await browser.close();
}
console.log('the page tunes, builds, saves, replays and watches');
