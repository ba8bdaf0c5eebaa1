// The example with three.js runs as its comment says.
import assert from 'node:assert/strict';
import { existsSync, readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import test from 'node:test';
import { open, skip } from './browser.mjs';
import { root } from './golden.mjs';

const { SOUPLE_NPM, SOUPLE_PACKAGE, SOUPLE_PICTURES } = process.env;
const types = { html: 'text/html', js: 'text/javascript', mjs: 'text/javascript', wasm: 'application/wasm' };

test('a cloth falls over a ball', { skip: skip || (!existsSync(`${SOUPLE_NPM}/node_modules/three`) && 'npm has not installed three') }, async () => {
  assert.ok(readFileSync(`${root}/web/examples/three.html`, 'utf8').split('\n').length <= 65);
  const server = createServer((request, response) => {
    const path = request.url.split('?')[0];
    const file = path.startsWith('/node_modules/souple/') ? SOUPLE_PACKAGE + path.slice(20)
      : path.startsWith('/node_modules/') ? SOUPLE_NPM + path : `${root}/web/examples${path}`;
    if (!existsSync(file)) return response.writeHead(path === '/favicon.ico' ? 204 : 404).end();
    response.writeHead(200, { 'content-type': types[file.split('.').pop()] ?? 'text/plain' }).end(readFileSync(file));
  }).listen(0);
  const { browser, page, errors } = await open(`http://localhost:${server.address().port}/three.html`);
  await page.waitForFunction('window.example?.world.time > 0.5');
  await page.screenshot({ path: `${SOUPLE_PICTURES}/three.png` });
  const lowest = await page.evaluate(() => Math.min(...window.example.cloth.positions.filter((_, i) => i % 3 === 1)));
  assert.ok(lowest < 0.9, `${lowest} m`);
  assert.deepEqual(errors, []);
  await browser.close();
  server.close();
});
