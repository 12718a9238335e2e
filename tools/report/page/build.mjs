// Makes report.html, the page without its results. usage: node build.mjs FOLDER
import {execFileSync} from 'node:child_process';
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
    console.error('npm cannot fetch what gliss report is made of; -DGLISS_REPORT=OFF builds without it');
    process.exit(1);
  }
  copyFileSync(lock, stamp);
}

installPackages();
const esbuild = createRequire(join(folder, 'package.json'))('esbuild');
const bundle = esbuild.buildSync({
  entryPoints: [join(here, 'src', 'main.js')],
  nodePaths: [join(folder, 'node_modules')],
  bundle: true,
  minify: true,
  write: false,
  outdir: folder,
  target: 'es2021',
  charset: 'utf8',
  legalComments: 'inline',
});
const [script, style] = ['.js', '.css'].map(
    ending => bundle.outputFiles.find(file => file.path.endsWith(ending)).text);
// Functions: what is put in may hold $, which a string would have replaced.
const page = read(join(here, 'page.html'))
                 .replace('/*STYLE*/', () => style.trim())
                 .replace('/*SCRIPT*/', () => script.trim().replaceAll('</script', '<\\/script'));
writeFileSync(join(folder, 'report.html'), page);
