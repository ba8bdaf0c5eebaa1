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
    for (const file of readdirSync(join(root, folder)).filter((name) => /\.(json|obj|msh)$/.test(name)))
      souple.writeFile(`/${folder}/${file}`, readFileSync(join(root, folder, file)));
}
/** The first difference of a world from what native builds record, as a sentence; '' if there is none. */
export function differenceOf(scene, frame, world) {
  const expected = hashes[scene][frame];
  if (expected !== undefined && world.hash !== expected) return `frame ${frame}: hash ${world.hash}, native ${expected}`;
  const trace = readFileSync(`${root}/tests/golden/trace/${scene}.txt`, 'utf8').trimEnd().split('\n');
  for (const line of trace) {
    const [object, quantity, codes] = line.split(' ');
    const code = codeOf(world.object(object)[quantity]);
    if (code !== codes.slice(2 * (frame - 1), 2 * frame)) return `frame ${frame}: ${quantity} of ${object} differ`;
  }
  return '';
}
