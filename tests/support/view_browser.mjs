// A browser and the server of gliss view, for tests and measurements of its page.
import assert from 'node:assert/strict';
import {spawn, spawnSync} from 'node:child_process';
import {existsSync} from 'node:fs';
import {createRequire} from 'node:module';
import {join} from 'node:path';

export const token = '00112233445566778899aabbccddeeff';
export const sleep = ms => new Promise(done => setTimeout(done, ms));

export function skip(why) {
  console.log(`skipped: ${why}`);
  process.exit(77);
}

export function findChromium() {
  for (const name of ['chromium', 'chromium-browser', 'google-chrome']) {
    for (const path of process.env.PATH.split(':')) {
      const file = join(path, name);
      if (existsSync(file) && spawnSync(file, ['--version']).status === 0) return file;
    }
  }
  return null;
}

// Starts a browser that draws in software. Ends with code 77, "skipped", where there is none or the build has no page.
export async function launch(packages, ...words) {
  const chromium = findChromium();
  if (!chromium) skip('no Chromium in PATH');
  if (!existsSync(join(packages, 'package.json'))) skip('this build has no page');
  const puppeteer = createRequire(join(packages, 'package.json'))('puppeteer-core');
  return puppeteer.launch({executablePath: chromium, headless: true,
    args: ['--no-sandbox', '--enable-unsafe-swiftshader', '--use-angle=swiftshader', '--autoplay-policy=no-user-gesture-required', ...words]});
}

// A server, once it says where it is.
export function serve(gliss, folder, mesh, ...words) {
  const child = spawn(gliss, ['view', mesh, '--json', ...words], {cwd: folder, env: {...process.env, GLISS_VIEW_TOKEN: token}});
  const server = {child, out: '', told: ''};
  child.stdout.on('data', data => server.out += data);
  server.ended = new Promise(done => child.on('exit', (code, signal) => done({code, signal})));
  return new Promise((done, fail) => {
    child.stderr.on('data', data => {
      server.told += data;
      server.url = server.told.match(/http:\/\/127\.0\.0\.1:(\d+)\/#[0-9a-f]{32}/)?.[0];
      if (server.url && !server.port) (server.port = new URL(server.url).port, done(server));
    });
    child.on('exit', () => fail(new Error(server.told)));
  });
}

export async function interrupt(server) {
  const began = Date.now();
  server.child.kill('SIGINT');
  const {code} = await server.ended;
  server.took = Date.now() - began;
  return code;
}

export async function open(browser, url, theme = 'light', width = 1280) {
  const page = await browser.newPage();
  page.setDefaultTimeout(60000);
  const complaints = [];
  page.on('console', message => {
    // The software renderer's own warnings are not the page's; nor are a browser's words about a server that is gone.
    const ours = !/GL Driver Message|GPU stall|WebSocket connection to .* failed|ERR_CONNECTION_REFUSED/.test(message.text());
    if (['error', 'warn', 'warning'].includes(message.type()) && ours) complaints.push(message.text());
  });
  page.on('pageerror', error => complaints.push(String(error)));
  page.on('request', request => {
    if (!/^(data|blob):/.test(request.url()) && request.url() !== url.split('#')[0] && request.url() !== url) complaints.push(`asks for ${request.url()}`);
  });
  await page.setViewport({width, height: 800});
  await page.emulateMediaFeatures([{name: 'prefers-color-scheme', value: theme}]);
  await page.goto(url);
  await page.waitForSelector('html[data-ready]');
  return {page, complaints};
}

export async function until(what, ask, patience = 20000) {
  const end = Date.now() + patience;
  for (let last;;) {
    last = await ask();
    if (last) return last;
    assert(Date.now() < end, what);
    await sleep(100);
  }
}

export const status = page => page.$eval('.status', element => element.innerText);
export const cell = (page, method, column) => page.$eval(`tr[data-method="${method}"]`, (row, i) => row.cells[i].innerText, column);
export const number = text => text.includes('·10') ? Number(text.split('·')[0]) * 10 ** Number([...text.split('·10')[1]].map(c => c === '⁻' ? '-' : '⁰¹²³⁴⁵⁶⁷⁸⁹'.indexOf(c)).join('')) : Number(text);
export const shot = async page => (await page.$('.stage')).screenshot({encoding: 'base64'});
export const colors = async page => page.evaluate(async text => {
  const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  const image = await createImageBitmap(new Blob([bytes], {type: 'image/png'}));
  const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
  context.drawImage(image, 0, 0);
  const {data} = context.getImageData(0, 0, image.width, image.height), seen = new Set();
  for (let i = 0; i < data.length; i += 4) seen.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2]);
  return seen.size;
}, await shot(page));

export async function press(page, text) {
  await page.evaluate(wanted => [...document.querySelectorAll('button')].find(button => button.innerText.startsWith(wanted)).click(), text);
}

// Takes another value of the list, or the slider (in thousandths), of that label.
export function choose(page, label, value) {
  return page.evaluate((wanted, to) => {
    const choice = [...document.querySelectorAll('.choice')].find(c => c.innerText.startsWith(wanted)), list = choice.querySelector('select');
    (list ?? choice.querySelector('input')).value = to;
    if (list) list.dispatchEvent(new Event('change'));
    else choice.querySelector('input').dispatchEvent(new Event('input'));
  }, label, value);
}

export const tells = (page, text) => until(`the page tells ${text}`, () => page.evaluate(wanted => document.body.innerText.includes(wanted), text));
