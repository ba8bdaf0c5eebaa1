// Times of docs/browser.md: a cloth of 64 x 64 vertices falls on a ball, on one thread. node measure.mjs PACKAGE_FOLDER
// As `souple bench` does, it reports the median and the least time of frames 60 to 240. With an argument --hour also the
// memory of an hour of simulated time and of 50 changes of the scene.
import { storeScenes } from './tests/golden.mjs';

const { load } = await import(`${process.argv[2]}/souple.js`);
const souple = await load();
const cloth = {
  objects: [{ name: 'cloth', kind: 'cloth', mesh: { grid: { columns: 64, rows: 64, size: 2 } }, transform: { translate: [0, 0.6, 0] },
              material: { preset: 'cotton' } }],
  colliders: [{ name: 'ball', shape: { sphere: { radius: 0.5 } }, friction: 0.4 }],
};
const world = new souple.World(cloth);
const times = [];
for (let frame = 0; frame < 240; ++frame) {
  const began = performance.now();
  world.step();
  if (frame >= 60) times.push(performance.now() - began);
}
times.sort((a, b) => a - b);
console.log(`${souple.version}: median ${times[90].toFixed(2)} ms, least ${times[0].toFixed(2)} ms, hash ${world.hash}`);
world.free();
if (process.argv.includes('--hour')) {
  storeScenes(souple);
  const before = [];
  for (let change = 0; change < 50; ++change) {
    const shown = souple.World.open(`/scenes/${['curtain', 'flag', 'balloon', 'rope_bridge', 'folded_cloth'][change % 5]}.json`);
    for (let frame = 0; frame < 20; ++frame) shown.step();
    shown.free();
    before.push(souple.memoryUsed);
  }
  console.log(`memory after 5, 25, 50 changes: ${[4, 24, 49].map((i) => (before[i] / 2 ** 20).toFixed(2)).join(', ')} MiB`);
  const small = new souple.World({ ...cloth, objects: [{ ...cloth.objects[0], mesh: { grid: { columns: 12, rows: 12, size: 2 } } }] });
  for (let minute = 1; minute <= 60; ++minute) {
    for (let frame = 0; frame < 3600; ++frame) small.step();
    if ([1, 10, 30, 60].includes(minute)) console.log(`memory after ${minute} minutes: ${(souple.memoryUsed / 2 ** 20).toFixed(2)} MiB`);
  }
}
