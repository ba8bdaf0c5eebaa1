// Makes the page of one file: node bundle.mjs BUILD_FOLDER SOURCE_FOLDER PAGE.html
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { gzipSync } from 'node:zlib';

const [build, source, page] = process.argv.slice(2);
const read = (file) => readFileSync(file, 'utf8');
const scenes = ['curtain', 'flag', 'jelly_armada', 'balloon', 'rope_bridge', 'sand_pile', 'dam_break', 'ducks', 'folded_cloth'];

/** A module without what it imports and exports: all of them become one. */
const plain = (text) => text.replace(/^import .*?;\n/gm, '').replace(/^export default (\w+);/gm, 'const create = $1;').replace(/^export /gm, '');

/** The format of page/lzma.js, with the size in its header: xz leaves it out. */
function packed(file) {
  const size = readFileSync(file).length;
  const bytes = execFileSync('xz', ['--format=lzma', '-9e', '--stdout', file], { maxBuffer: 1 << 26 });
  bytes.writeBigUInt64LE(BigInt(size), 5);
  return bytes;
}

const files = { '/scenes/playground.json': read(`${source}/web/page/playground.json`) };
for (const scene of scenes) {
  files[`/scenes/${scene}.json`] = read(`${source}/scenes/${scene}.json`);
  for (const [, mesh] of files[`/scenes/${scene}.json`].matchAll(/"file": "([^"]+)"/g))
    files[`/scenes/${mesh}`] = read(`${source}/scenes/${mesh}`);
}
// The loader and the worker of a build with threads, as workers get them.
const worker = `${build}/souple_wasm.worker.js`;
const asText = (file) => (existsSync(worker) ? read(file).replaceAll('</script', '<\\/script') : '');
const parts = {
  '/* page.css */': read(`${source}/web/page/page.css`),
  '/* files */': JSON.stringify(files).replaceAll('<', '\\u003c'),
  '/* wasm */': packed(`${build}/souple_wasm.wasm`).toString('base64'),
  '/* loader */': asText(`${build}/souple_wasm.mjs`),
  '/* worker */': asText(worker),
  '/* scripts */': [`${build}/package/build.js`, `${build}/souple_wasm.mjs`, `${source}/web/js/souple.js`, `${source}/web/page/lzma.js`,
    `${source}/web/page/page.js`]
    .map((file) => plain(read(file))).join('\n').replaceAll('</script', '<\\/script'),
};
let html = read(`${source}/web/page/index.html`);
for (const [mark, text] of Object.entries(parts)) html = html.replace(mark, () => text);
writeFileSync(page, html);
console.log(`${page}: ${(html.length / 1e6).toFixed(2)} MB, ${(gzipSync(html).length / 1e6).toFixed(2)} MB compressed`);
