// souple.js as a user meets it: what it does, and the sentence for each misuse.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import test from 'node:test';
import { root, storeScenes } from './golden.mjs';

const { checkView, load, SoupleError } = await import(`${process.env.SOUPLE_PACKAGE}/souple.js`);
const souple = await load();
storeScenes(souple);

const cloth = { name: 'sheet', kind: 'cloth', mesh: { grid: { columns: 8, rows: 8, size: 1 } }, material: { preset: 'cotton' } };
const floor = { name: 'floor', shape: { plane: {} } };
const says = (pattern) => (error) => error instanceof SoupleError && pattern.test(error.message);
const heights = (object) => object.positions.filter((_, i) => i % 3 === 1);

test('a free cloth falls as a body falls in a vacuum', () => {
  const world = new souple.World({ objects: [cloth], wind: { air_density: 0 } });
  for (let i = 0; i < 60; ++i) world.step();
  assert.ok(Math.abs(world.time - 1) < 1e-9);
  for (const y of heights(world.object('sheet'))) assert.ok(Math.abs(y + 4.905) < 0.1, `${y} m`);
  world.free();
});
test('positions are a view of the memory, not a copy', () => {
  const world = new souple.World({ objects: [cloth] }), object = world.object('sheet');
  const view = object.positions;
  assert.equal(view.length, 3 * 64);
  assert.equal(object.triangles.length, 3 * 98);
  assert.equal(view.buffer, object.normals.buffer);
  const before = view[1];
  world.step();
  assert.ok(object.positions[1] < before);
  assert.equal(view.byteOffset, object.positions.byteOffset);
  world.free();
});
test('pins hold, move and let go', () => {
  const world = new souple.World({ objects: [cloth] }), object = world.object('sheet');
  object.pin([0]);
  const start = [...object.positions.slice(0, 3)];
  for (let i = 0; i < 20; ++i) world.step();
  assert.deepEqual([...object.positions.slice(0, 3)], start);
  for (let i = 1; i <= 60; ++i) {
    object.movePins([0], [start[0], 0.5 * i / 60, start[2]]);
    world.step();
  }
  assert.ok(Math.abs(object.positions[1] - 0.5) < 1e-6);
  object.unpin([0]);
  for (let i = 0; i < 120; ++i) world.step();
  assert.ok(object.positions[1] < -1, `${object.positions[1]} m`);
  world.free();
});
test('a hand pulls what its ray hits', () => {
  const world = new souple.World({ gravity: [0, 0, 0], objects: [cloth] });
  assert.equal(world.grab([5, 1, 0], [0, -1, 0]), false);
  assert.equal(world.grab([0.1, 1, 0.1], [0, -1, 0]), true);
  world.drag([0.1, 1, 0.4], [0, -1, 0]);
  for (let i = 0; i < 30; ++i) world.step();
  world.release();
  const z = [...world.object('sheet').positions].filter((_, i) => i % 3 === 2).reduce((a, b) => a + b) / 64;
  assert.ok(z > 0.1, `${z} m`);
  world.free();
});
test('settings and materials change while it runs, and the scene knows', () => {
  const world = new souple.World({ objects: [cloth], colliders: [floor] });
  world.set('substeps', 17);
  world.set('objects.sheet.material.damping', 0.25);
  assert.equal(JSON.parse(world.scene).substeps, 17);
  assert.equal(world.tunables(0).find((tunable) => tunable.name === 'damping').value, 0.25);
  world.add({ ...cloth, name: 'second', transform: { translate: [0, 1, 0] } });
  assert.deepEqual(world.objects.map((object) => object.name), ['sheet', 'second']);
  world.step();
  world.reset();
  assert.equal(world.time, 0);
  world.free();
});
test('a reset repeats the same bits', () => {
  const world = souple.World.open('/scenes/flag.json', { substeps: 5 });
  const run = () => { for (let i = 0; i < 10; ++i) world.step(); return world.hash; };
  const first = run();
  world.reset();
  assert.equal(run(), first);
  world.free();
});

test('wrong types are refused in words', () => {
  const world = new souple.World({ objects: [cloth] }), object = world.object('sheet');
  assert.throws(() => new souple.World(7), says(/expected a scene.*the number 7/));
  assert.throws(() => new souple.World('{'), says(/scene:1/));
  assert.throws(() => new souple.World({ objects: [{ ...cloth, kind: 'clot' }] }), says(/clot/));
  assert.throws(() => new souple.World({ subsetps: 3 }), says(/substeps/));
  assert.throws(() => souple.World.open('/scenes/none.json'), says(/none\.json/));
  assert.throws(() => world.step('a'), says(/World\.step: expected a finite number, got the text 'a'/));
  assert.throws(() => world.step(-1), says(/above 0/));
  assert.throws(() => world.step(NaN), says(/NaN/));
  assert.throws(() => world.object('shet'), says(/'sheet'/));
  assert.throws(() => world.set('substeps', -3), says(/substeps/));
  assert.throws(() => world.set('objects.sheet.mesh', {}), says(/./));
  assert.throws(() => world.add(3), says(/expected an object/));
  assert.throws(() => object.pin('0'), says(/array of numbers/));
  assert.throws(() => object.pin([0.5]), says(/whole numbers/));
  assert.throws(() => object.pin([99]), says(/99/));
  assert.throws(() => object.movePins([0], [1, 2]), says(/multiple of 3/));
  assert.throws(() => object.movePins([0], [0, 0, 0]), says(/pin/));
  assert.throws(() => world.grab([0, 0], [0, -1, 0]), says(/a ray/));
  assert.throws(() => object.pin([2 ** 32]), says(/whole numbers/));
  assert.throws(() => object.pin(new DataView(new ArrayBuffer(4))), says(/array of numbers/));
  assert.throws(() => world.grab([0, 0], [0, 0, 0, -1, 0]), says(/origin of a ray/));
  assert.throws(() => world.grab(null, [0, -1, 0]), says(/origin of a ray/));
  for (const place of [-1, 0.5, 99, 2 ** 32]) assert.throws(() => world.tunables(place), says(/World\.tunables/));
  for (const scene of [Promise.resolve({}), new Map(), new Date(), new ArrayBuffer(8)])
    assert.throws(() => new souple.World(scene), says(/expected a scene/));
  assert.throws(() => new souple.World({}, { overrides: new Map([['substeps', 3]]) }), says(/overrides/));
  assert.throws(() => new souple.World({}, null), says(/options/));
  assert.throws(() => world.set('substeps', 7n), says(/JSON/));
  assert.throws(() => world.set('substeps', { toJSON() {} }), says(/JSON/));
  assert.throws(() => new souple.World('{"souple":1,"objects":[]}\0 rest'), says(/zero character/));
  for (const [path, content] of [['', 'x'], ['a/b.json', 'x'], ['/scenes', 'x'], ['/scenes/x.json', null], ['/scenes/', 'x']])
    assert.throws(() => souple.writeFile(path, content), says(/writeFile/));
  for (const dt of [1e10, 1e300]) assert.throws(() => world.step(dt), says(/nothing was done/));
  world.step();  // and nothing of it harmed the world
  world.free();
});
test('bytes of any view are stored as they are', () => {
  const bytes = new TextEncoder().encode('{"souple":1,"objects":[]} ');
  souple.writeFile('/scenes/bytes.json', new Uint16Array(bytes.buffer));
  const world = souple.World.open('/scenes/bytes.json');
  assert.equal(world.objects.length, 0);
  world.free();
});
test('triangles are a copy', () => {
  const world = new souple.World({ objects: [cloth] }), object = world.object('sheet');
  object.triangles.fill(4000000000);
  world.grab([0.1, 1, 0.1], [0, -1, 0]);
  assert.ok(object.triangles.every((vertex) => vertex < 64));
  world.free();
});
test('a freed world is refused in words', () => {
  const world = new souple.World({ objects: [cloth] }), object = world.object('sheet');
  world.free();
  world.free();
  for (const use of [() => world.step(), () => world.hash, () => world.objects, () => object.positions, () => object.pin([0])])
    assert.throws(use, says(/was freed/));
});
test('a view that the memory has left is refused in words', async () => {
  const checked = await load({ checked: true });
  for (const module of [souple, checked]) {
    const world = new module.World({ objects: [cloth] }), object = world.object('sheet');
    object.pin([0]);
    const view = object.positions, memory = module.memory;
    const large = [];
    while (module.memory === memory)
      large.push(new module.World({ objects: [{ ...cloth, mesh: { grid: { columns: 150, rows: 150, size: 1 } } }] }));
    if (module === checked) {
      assert.throws(() => view[0], says(/sheet\.positions is detached.*read the property again/));
    } else {
      assert.throws(() => checkView(view), says(/detached/));
      assert.throws(() => object.movePins([0], view), says(/detached/));
    }
    assert.ok(Number.isFinite(object.positions[0]));
    large.forEach((other) => other.free());
    world.free();
  }
});
test('a checked view knows that its world has left it', async () => {
  const checked = await load({ checked: true });
  const world = new checked.World({ objects: [cloth] }), object = world.object('sheet');
  object.pin([0]);
  object.movePins([0], object.positions.slice(0, 3));
  object.movePins(Uint32Array.from({ length: 1 }), object.positions.subarray(0, 3));
  assert.throws(() => object.positions.fill(5), says(/only be read/));
  assert.equal(checkView(new Float32Array()).length, 0);
  const view = object.positions;
  world.free();
  assert.throws(() => view[1], says(/was freed/));
  assert.throws(() => checkView(view), says(/was freed/));
});
test('arguments that find no memory are refused in words', async () => {
  const module = await load(), worlds = [];
  const world = new module.World({ objects: [cloth] }), object = world.object('sheet');
  try {
    for (;;) worlds.push(new module.World({ objects: [{ kind: 'grains', grid: { counts: [100, 100, 100] } }] }));
  } catch (error) {
    assert.ok(error instanceof SoupleError, String(error));
  }
  const many = new Uint32Array(1 << 24);
  assert.throws(() => object.pin(many), says(/out of memory/));
  world.step();
  worlds.forEach((other) => other.free());
  world.free();
});
test('types are declared for all that there is', () => {
  const types = readFileSync(`${root}/web/js/souple.d.ts`, 'utf8');
  const world = new souple.World({ objects: [cloth] });
  for (const [name, object] of [['World', world], ['SoupleObject', world.object('sheet')]]) {
    const begin = types.indexOf(`interface ${name} `), body = types.slice(begin, types.indexOf('\n}', begin));
    for (const member of Object.getOwnPropertyNames(Object.getPrototypeOf(object)))
      if (!['constructor', 'handle', 'info'].includes(member)) assert.match(body, new RegExp(`\\b${member}\\b`));
  }
  world.free();
});
