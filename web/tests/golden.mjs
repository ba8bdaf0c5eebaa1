// The recorded hashes and codes of tests/golden, as tests/golden/trace.cpp explains them.
import { readFileSync, readdirSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

export const root = join(dirname(fileURLToPath(import.meta.url)), '../..');
const hashes = JSON.parse(readFileSync(`${root}/tests/golden.json`));
const letters = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/';

/** FNV-1a of 64 bits, in two halves: the prime is 2^40 + 435. */
function fnv1a64(bytes) {
  let high = 0xcbf29ce4, low = 0x84222325;
  for (const byte of bytes) {
    low = (low ^ byte) >>> 0;
    const product = low * 435;
    high = (high * 435 + Math.floor(product / 2 ** 32) + low * 256) % 2 ** 32;
    low = product >>> 0;
  }
  return (BigInt(high) << 32n) | BigInt(low);
}
function codeOf(view) {
  const bytes = new Uint8Array(view.buffer, view.byteOffset, view.byteLength);
  const bits = Number(BigInt.asUintN(64, fnv1a64(bytes) * 11400714819323198485n) >> 52n);
  return letters[bits >> 6] + letters[bits & 63];
}

/** Stores the shipped scenes and meshes in the module. */
export function storeScenes(souple) {
  for (const folder of ['scenes', 'scenes/meshes'])
    for (const file of readdirSync(join(root, folder)).filter((name) => /\.(json|obj|msh|pc2)$/.test(name)))
      souple.writeFile(`/${folder}/${file}`, readFileSync(join(root, folder, file)));
}
/** The lines of a scene's trace: object, quantity, codes of its frames. */
const traceOf = (scene) => readFileSync(`${root}/tests/golden/trace/${scene}.txt`, 'utf8').trimEnd().split('\n').map((line) => line.split(' '));
/** The first difference of a world from what native builds record, as a sentence; '' if there is none. */
export function differenceOf(scene, frame, world) {
  const expected = hashes[scene][frame];
  if (expected !== undefined && world.hash !== expected) return `frame ${frame}: hash ${world.hash}, native ${expected}`;
  for (const [object, quantity, codes] of traceOf(scene)) {
    const code = codeOf(world.object(object)[quantity]);
    if (code !== codes.slice(2 * (frame - 1), 2 * frame)) return `frame ${frame}: ${quantity} of ${object} differ`;
  }
  return '';
}
/** Difference after `frames` frames of a world in a page of puppeteer that opens the scene. */
export async function differenceInPage(page, scene, frames) {
  const wanted = traceOf(scene).map(([object, quantity]) => [object, quantity]);
  const bits = await page.evaluate((name, text, count, arrays) => {
    window.page.souple.writeFile(`/scenes/${name}.json`, text);  // the page has ten
    const world = window.page.souple.World.open(`/scenes/${name}.json`);
    for (let i = 0; i < count; ++i) world.step();
    const found = arrays.map(([object, quantity]) => {
      const view = world.object(object)[quantity];
      return Array.from(new Uint32Array(view.buffer, view.byteOffset, view.length));
    });
    const hash = world.hash;
    world.free();
    return { hash, found };
  }, scene, readFileSync(`${root}/scenes/${scene}.json`, 'utf8'), frames, wanted);
  const arrayOf = (object, quantity) => Uint32Array.from(bits.found[wanted.findIndex(([o, q]) => o === object && q === quantity)]);
  return differenceOf(scene, frames, {
    hash: bits.hash,
    object: (name) => ({ get positions() { return arrayOf(name, 'positions'); }, get velocities() { return arrayOf(name, 'velocities'); } }),
  });
}
