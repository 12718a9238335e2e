// Makes report.html, the page of gliss report without its results, and view.html, that of gliss view. usage: node build.mjs FOLDER
import {execFileSync} from 'node:child_process';
import {createHash} from 'node:crypto';
import {copyFileSync, existsSync, mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const folder = resolve(process.argv[2]);
const read = path => readFileSync(path, 'utf8');

// The lock file's copy stands for packages that are all there.
function installPackages() {
  const lock = join(here, 'package-lock.json'), stamp = join(folder, 'installed-lock.json');
  if (existsSync(stamp) && read(stamp) === read(lock)) return;
  mkdirSync(folder, {recursive: true});
  for (const name of ['package.json', 'package-lock.json', '.npmrc']) {
    copyFileSync(join(here, name), join(folder, name));
  }
  try {
    execFileSync('npm', ['ci', '--loglevel=error'], {cwd: folder, stdio: ['ignore', 'ignore', 'inherit']});
  } catch {
    console.error('npm cannot fetch what the pages are made of; -DGLISS_REPORT=OFF builds without it');
    process.exit(1);
  }
  copyFileSync(lock, stamp);
}

installPackages();
const esbuild = createRequire(join(folder, 'package.json'))('esbuild');

// A script's and a style's hash as a Content-Security-Policy names them.
const hashOf = text => `'sha256-${createHash('sha256').update(text).digest('base64')}'`;

// Puts `entry` and its style into the template of that name, and their hashes where it asks for them.
function makePage(entry, template, name) {
  const bundle = esbuild.buildSync({
    entryPoints: [join(here, 'src', entry)],
    nodePaths: [join(folder, 'node_modules')],
    bundle: true,
    minify: true,
    write: false,
    outdir: folder,
    target: 'es2021',
    charset: 'utf8',
    legalComments: 'inline',
  });
  const [js, css] = ['.js', '.css'].map(ending => bundle.outputFiles.find(file => file.path.endsWith(ending)).text.trim());
  const script = js.replaceAll('</script', '<\\/script');
  // Functions: what is put in may hold $, which a string would have replaced.
  const page = read(join(here, template))
                   .replace('@@SCRIPT_HASH@@', () => hashOf(script))
                   .replace('@@STYLE_HASH@@', () => hashOf(css))
                   .replace('/*STYLE*/', () => css)
                   .replace('/*SCRIPT*/', () => script);
  writeFileSync(join(folder, name), page);
}

makePage('main.js', 'page.html', 'report.html');
makePage('view.js', 'view.html', 'view.html');
