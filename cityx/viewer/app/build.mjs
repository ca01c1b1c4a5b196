// Bundle the page: node build.mjs OUT. It writes two pages, style.css, their scripts and licences.txt.
import { build } from 'esbuild';
import { cpSync, mkdirSync, readFileSync, readdirSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

const out = process.argv[2];
const partial = `${out}.partial`;
rmSync(partial, { recursive: true, force: true });
mkdirSync(partial, { recursive: true });
await build({
  entryPoints: { app: 'src/main.ts', tiles: 'src/tiles.ts' },
  bundle: true,
  minify: true,
  format: 'esm',
  target: 'es2022',
  legalComments: 'none',
  outdir: partial,
});
for (const name of ['index.html', 'tiles.html', 'style.css']) cpSync(name, join(partial, name));
const packages = Object.keys(JSON.parse(readFileSync('package.json', 'utf8')).dependencies);
const texts = packages.map((name) => {
  const folder = join('node_modules', name);
  const held = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8'));
  const file = readdirSync(folder).find((entry) => /^licen[cs]e/i.test(entry));
  return `${name} ${held.version}, ${held.license}\n\n${file ? readFileSync(join(folder, file), 'utf8').trim() : ''}\n`;
});
const own = 'CityX, Apache-2.0. The page holds these packages:\n\n';
writeFileSync(join(partial, 'licences.txt'), own + texts.join(`\n${'-'.repeat(72)}\n\n`));
rmSync(out, { recursive: true, force: true });
renameSync(partial, out);
