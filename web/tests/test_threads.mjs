// The page with threads: where the server isolates it, worlds have several threads and native bits; elsewhere it says why not.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import test from 'node:test';
import { open, skip } from './browser.mjs';
import { differenceInPage } from './golden.mjs';

const page = readFileSync(process.env.SOUPLE_PAGE ?? '/dev/null');
const isolating = { 'cross-origin-opener-policy': 'same-origin', 'cross-origin-embedder-policy': 'require-corp' };

/** Opens the page from a server that sends these headers, and closes both at the end. */
async function served(headers, use) {
  const server = createServer((request, response) => {
    if (request.url !== '/') return response.writeHead(204).end();
    response.writeHead(200, { 'content-type': 'text/html', ...headers }).end(page);
  }).listen(0);
  const opened = await open(`http://localhost:${server.address().port}/`);
  try {
    await use(opened);
  } finally {
    await opened.browser.close();
    server.close();
  }
}

test('worlds have threads and native bits', { skip }, () => served(isolating, async ({ page, errors }) => {
  await page.waitForFunction('window.page !== undefined');
  assert.ok(await page.evaluate('crossOriginIsolated'));
  for (const scene of ['curtain', 'flag', 'jelly_armada', 'balloon', 'rope_bridge', 'sand_pile', 'folded_cloth', 'rag_doll'])
    assert.equal(await differenceInPage(page, scene, 60), '', scene);
  const [threads, processors] = await page.evaluate('[window.page.souple.threads, navigator.hardwareConcurrency]');
  console.log(`${threads} threads on ${processors} processors`);
  if (processors > 1) assert.ok(threads > 1);
  // More worlds than workers: the last ones do with fewer threads.
  const hashes = await page.evaluate(() => {
    const { World } = window.page.souple;
    const worlds = Array.from({ length: 20 }, () => World.open('/scenes/flag.json'));
    for (const world of worlds) for (let frame = 0; frame < 3; ++frame) world.step();
    const found = worlds.map((world) => world.hash);
    worlds.forEach((world) => world.free());
    return found;
  });
  assert.equal(new Set(hashes).size, 1);
  assert.deepEqual(errors, []);
}));

test('a page that is not isolated says so', { skip }, () => served({}, async ({ page }) => {
  await page.waitForFunction("document.getElementById('wait').className === 'failed'");
  assert.match(await page.$eval('#wait', (element) => element.textContent), /Cross-Origin-Opener-Policy/);
}));
