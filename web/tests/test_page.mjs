// The page in headless Chromium, drawn in software: every scene plays, hands grab, bad files get a sentence, and no error
// is logged. Skipped in words without Chromium or puppeteer-core.
//   SOUPLE_PLAY_SECONDS=5   plays each scene so long, of simulated time
//   SOUPLE_SCENES="ducks"   only these
import assert from 'node:assert/strict';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import test, { after, before } from 'node:test';
import { open as openAddress, skip } from './browser.mjs';
import { differenceInPage, root } from './golden.mjs';

const { SOUPLE_PAGE, SOUPLE_PICTURES } = process.env;
const scenes = process.env.SOUPLE_SCENES?.split(' ') ?? ['playground', 'curtain', 'flag', 'jelly_armada', 'balloon', 'rope_bridge', 'sand_pile', 'dam_break', 'ducks', 'folded_cloth'];

// One page for all tests: in software a browser needs half a minute for its first picture.
let browser, page, errors, requests;
before(async () => {
  if (skip) return;
  ({ browser, page, errors, requests } = await openAddress(`file://${SOUPLE_PAGE}`, { width: 800, height: 480 }));
  await page.waitForFunction('window.page !== undefined');
});
after(() => browser?.close());

/** Opens a link in the page. */
async function open(hash) {
  await page.evaluate((to) => { window.last = window.page.world; location.hash = to; }, hash);
  await page.waitForFunction('window.page.world !== window.last');
}
const time = () => page.evaluate('page.world.time');
async function pass(seconds) {
  const from = await time();
  await page.waitForFunction((until) => window.page.world.time >= until, { timeout: 120000 * (1 + seconds) }, from + seconds);
}
/** How many colors a picture of the canvas has, of 16 x 16 samples; also saves it. */
async function colors(name) {
  mkdirSync(SOUPLE_PICTURES, { recursive: true });
  const picture = await page.screenshot({ encoding: 'base64' });
  writeFileSync(`${SOUPLE_PICTURES}/${name}.png`, picture, 'base64');
  return page.evaluate(async (data) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const small = Object.assign(document.createElement('canvas'), { width: 64, height: 48 }), context = small.getContext('2d');
    const left = innerWidth > 760 ? 320 : 0;
    context.drawImage(image, left, 0, image.width - left, image.height - 60, 0, 0, 64, 48);
    const bytes = context.getImageData(0, 0, 64, 48).data, seen = new Set();
    for (let i = 0; i < bytes.length; i += 4) seen.add(bytes[i] >> 3 << 10 | bytes[i + 1] >> 3 << 5 | bytes[i + 2] >> 3);
    return seen.size;
  }, picture);
}
const noErrors = () => assert.deepEqual(errors, []);
const centerOf = (object) => page.evaluate((name) => {
  const x = window.page.world.object(name).positions, n = x.length / 3, sum = [0, 0, 0];
  x.forEach((value, i) => { sum[i % 3] += value / n; });
  return sum;
}, object);

test('every scene plays, and its picture is not blank', { skip }, async () => {
  for (const scene of scenes) {
    await page.select('#scene', scene);
    await pass(Number(process.env.SOUPLE_PLAY_SECONDS ?? 0.1));
    assert.ok(await colors(scene) > 25, `${scene} has few colors`);
    noErrors();
  }
  for (const key of ['3', '4', '9', 'c', 'w']) await page.evaluate((pressed) => page.press(pressed), key);
  await pass(0.1);
  assert.ok(await colors('contacts') > 10);
  for (const key of ['1', 'c', 'c', 'c', 'c', 'w']) await page.evaluate((pressed) => page.press(pressed), key);
  noErrors();
  assert.equal(requests.filter((url) => !/^(file|data|blob):/.test(url)).length, 0, 'the page asked a server');
});

test('mouse and touch grab, keys pause, step and reset', { skip }, async () => {
  await open('#scene=curtain');
  await pass(0.15);
  await page.evaluate('page.press(" ")');
  const paused = await time();
  await page.evaluate('page.press(".")');
  assert.ok(Math.abs(await time() - paused - 1 / 60) < 1e-6);
  await page.evaluate('page.press("r")');
  assert.equal(await time(), 0);
  await page.evaluate('page.press(" ")');
  // Pulls the middle of the picture to the right, once with each.
  const x = 320 + 290, y = 260, to = x + 150;
  for (const hand of ['mouse', 'touch']) {
    const holds = async () => assert.ok(await page.$eval('#canvas', (canvas) => canvas.classList.contains('holds')), `${hand} holds nothing`);
    if (hand === 'mouse') {
      await page.mouse.move(x, y);
      await page.mouse.down();
      await holds();
      await page.mouse.move(to, y, { steps: 8 });
      await pass(0.15);
      await page.mouse.up();
    } else {
      const finger = await page.touchscreen.touchStart(x, y);
      await holds();
      for (let i = 1; i <= 8; ++i) await finger.move(x + (to - x) * i / 8, y);
      await pass(0.15);
      await finger.end();
    }
    assert.equal(await page.$eval('#canvas', (canvas) => canvas.classList.contains('holds')), false);
    await colors(`grab_${hand}`);
  }
  await page.mouse.move(330, 20);
  await page.mouse.wheel({ deltaY: 200 });
  noErrors();
});

test('a pull moves what is pulled', { skip }, async () => {
  await open('#scene=playground');
  const before = await centerOf('ball');
  assert.ok(await page.evaluate(() => {
    const [x, y, z] = [0, 1, 2].map((axis) => window.page.world.object('ball').positions.filter((_, i) => i % 3 === axis).reduce((a, b) => a + b));
    const n = window.page.world.object('ball').vertexCount;
    window.page.world.grab([x / n, y / n, 5], [0, 0, -1]);
    window.page.world.drag([x / n + 0.5, y / n + 0.4, 5], [0, 0, -1]);
    return true;
  }));
  await pass(0.6);
  const after = await centerOf('ball');
  assert.ok(after[0] > before[0] + 0.15, `${before} -> ${after}`);
  noErrors();
});

test('bad files and bad links get a sentence', { skip }, async () => {
  await page.evaluate(() => { location.hash = '#scene=nowhere'; });
  await page.waitForFunction(() => /nowhere/.test(document.getElementById('notices').textContent));
  const last = () => page.$eval('#notices', (notices) => notices.lastChild?.textContent ?? '');
  assert.match(await last(), /nowhere/);
  const take = (name, text) => page.evaluate((file, content) => window.page.take(new File([content], file)), name, text);
  await take('broken.json', '{ "souple": 1, "objects": [ { "kind": "clot" } ] }');
  assert.match(await last(), /clot/);
  await take('broken.obj', 'v 1 2 x\n');
  assert.match(await last(), /broken\.obj/);
  await take('film.mp4', '');
  assert.match(await last(), /expected a scene/);
  const objects = () => page.evaluate('page.world.objects.length');
  const count = await objects();
  await take('star.obj', readFileSync(`${root}/scenes/meshes/star.obj`, 'utf8'));
  assert.equal(await objects(), count + 1);
  await take('drop.json', readFileSync(`${root}/scenes/drop.json`, 'utf8'));
  await pass(0.1);
  noErrors();
});

test('the link carries the scene, its settings and the display; the bits are those of native builds', { skip }, async () => {
  await open('#scene=flag&set=substeps%3D7&display=strain');
  assert.equal(await page.$eval('#substeps', (input) => input.value), '7');
  assert.equal(await page.$eval('#display', (select) => select.value), '3');
  assert.equal(await page.$eval('#legend', (legend) => legend.hidden), false);
  await page.$eval('#iterations', (input) => { input.value = 2; input.oninput(); });
  await page.waitForFunction(() => /iterations%3D2/.test(location.hash) && /substeps%3D7/.test(location.hash));
  for (const scene of ['curtain', 'flag', 'jelly_armada', 'balloon', 'rope_bridge', 'sand_pile', 'folded_cloth', 'rag_doll'])
    assert.equal(await differenceInPage(page, scene, 60), '', scene);
  noErrors();
});

test('on a phone the panels make room', { skip }, async () => {
  await page.setViewport({ width: 390, height: 700 });
  await open('#scene=curtain');
  await pass(0.15);
  const box = await page.$eval('#canvas', (canvas) => canvas.getBoundingClientRect().toJSON());
  assert.ok(box.width === 390 && box.height > 560, JSON.stringify(box));
  assert.ok(await colors('phone') > 25);
  await page.click('#menu');
  await page.waitForSelector('#substeps', { visible: true });
  await colors('phone_menu');
  await page.setViewport({ width: 700, height: 360 });
  await pass(0.05);
  assert.ok(await colors('phone_wide') > 25);
  noErrors();
});
