// Checks files with the Khronos glTF validator and tinyusdz: node check_studio_files.mjs NODE_MODULES < FILES, a JSON list.
// Prints a JSON list: per file errors, warnings and, of USD, the prims' names with their numbers of points.

import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { basename } from 'node:path';

const folder = process.argv[2];
const require = createRequire(`${folder}/`);
const validator = require('gltf-validator'); // before globals change
const files = JSON.parse(readFileSync(0, 'utf8'));

async function tinyusdz() {
  // The package is built for browsers only, and refuses to start elsewhere.
  globalThis.window = globalThis;
  globalThis.document = {};
  process.type = 'renderer';
  const { default: start } = await import(`${folder}/tinyusdz/tinyusdz.js`);
  return start({ wasmBinary: readFileSync(`${folder}/tinyusdz/tinyusdz.wasm`) });
}

async function checkGltf(file) {
  const { issues } = await validator.validateBytes(new Uint8Array(readFileSync(file)));
  return { errors: issues.numErrors, warnings: issues.numWarnings, messages: issues.messages.filter((m) => m.severity < 2).slice(0, 3) };
}

function checkUsd(usd, file) {
  const loader = new usd.TinyUSDZLoaderNative();
  const read = loader.loadFromBinary(new Uint8Array(readFileSync(file)), basename(file));
  const meshes = {};
  for (let i = 0; read && i < loader.numMeshes(); i++) {
    const mesh = loader.getMesh(i);
    meshes[mesh.primName] = Array.from(mesh.points).length / 3;
  }
  const result = { errors: read ? 0 : 1, warnings: 0, messages: read ? [] : [loader.error()], meshes };
  loader.delete();
  return result;
}

const usd = files.some((file) => file.endsWith('.usda')) ? await tinyusdz() : null;
const results = [];
for (const file of files) results.push(file.endsWith('.glb') ? await checkGltf(file) : checkUsd(usd, file));
process.stdout.write(JSON.stringify(results));
