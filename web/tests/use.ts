// A program in TypeScript with the calls of docs/browser.md; test_types.mjs compiles it against souple.d.ts.
import { checkView, load, SoupleError } from './souple';

async function main(): Promise<void> {
  const souple = await load({ checked: true });
  const world = new souple.World({
    objects: [{ name: 'cloth', kind: 'cloth', mesh: { grid: { columns: 5, rows: 5, size: 2 } }, material: { preset: 'cotton' } }],
  });
  const cloth = world.object('cloth');
  cloth.pin([0, 4]);
  world.step();
  const positions: Float32Array = cloth.positions;
  checkView(positions);
  souple.writeFile('/scenes/mine.json', '{}');
  const opened = souple.World.open('/scenes/flag.json'), hash: string = opened.hash, time: number = world.time;
  console.log(positions.length, hash, time, cloth.velocities, cloth.normals, cloth.triangles);
  try {
    world.free();
  } catch (error) {
    if (error instanceof SoupleError) console.log(error.message);
  }
  // @ts-expect-error vertices are numbers
  cloth.pin('all');
  // @ts-expect-error there is no such call
  world.advance();
}
void main();
