// WebAssembly gives the bits of native builds: scenes of every kind, 60 frames each.
import assert from 'node:assert/strict';
import test from 'node:test';
import { differenceOf, storeScenes } from './golden.mjs';

const { load } = await import(`${process.env.SOUPLE_PACKAGE}/souple.js`);
const souple = await load();
storeScenes(souple);

test('the kernels are those of SIMD', () => assert.match(souple.version, /, wasm$/));

for (const scene of (process.env.SOUPLE_SCENES ?? 'curtain flag jelly_armada balloon rope_bridge sand_pile folded_cloth brick_wall drop rag_doll wrecking_ball dominoes').split(' '))
  test(scene, () => {
    const world = souple.World.open(`/scenes/${scene}.json`);
    const began = performance.now();
    for (let frame = 1; frame <= 60; ++frame) {
      world.step();
      assert.equal(differenceOf(scene, frame, world), '');
    }
    console.log(`${scene}: ${((performance.now() - began) / 60).toFixed(1)} ms a frame`);
    world.free();
  });
