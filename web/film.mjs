// The animated picture of README: a mouse that plays with the page. node film.mjs PAGE.html OUT.webp, with SOUPLE_NPM set.
import { execFileSync } from 'node:child_process';
import { mkdtempSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { open } from './tests/browser.mjs';

const [path, film] = process.argv.slice(2);
const size = { width: 960, height: 540 }, frames = 42;
const folder = mkdtempSync(`${tmpdir()}/souple-film-`);
const { browser, page } = await open(`file://${path}#scene=playground`, size);
await page.waitForFunction('window.page !== undefined');
await page.evaluate('page.press(" ")');

// Pulls the cloth to the right and lets go, then throws a ball at the jelly.
const hand = { from: [520, 250], to: [720, 190], press: 4, release: 30 };
await page.addStyleTag({ content: '#hand { position: fixed; width: 18px; height: 18px; margin: -9px; border: 3px solid #f0a35e; border-radius: 50%; pointer-events: none }' });
await page.evaluate(() => document.body.append(Object.assign(document.createElement('div'), { id: 'hand' })));
for (let frame = 0; frame < frames; ++frame) {
  const part = Math.min(Math.max((frame - hand.press) / (hand.release - hand.press - 4), 0), 1);
  const at = hand.from.map((x, i) => x + (hand.to[i] - x) * part * part * (3 - 2 * part));
  await page.mouse.move(...at);
  await page.$eval('#hand', (div, [x, y]) => Object.assign(div.style, { left: `${x}px`, top: `${y}px` }), at);
  if (frame === hand.press) await page.mouse.down();
  if (frame === hand.release) await page.mouse.up();
  if (frame === 36) await page.evaluate('page.press("t")');
  for (let step = 0; step < 4; ++step) await page.evaluate('page.press(".")');
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  await page.screenshot({ path: `${folder}/${String(frame).padStart(4, '0')}.png` });
}
await browser.close();
execFileSync('ffmpeg', ['-loglevel', 'error', '-y', '-framerate', '15', '-i', `${folder}/%04d.png`, '-vf', 'scale=640:-1:flags=lanczos',
  '-c:v', 'libwebp_anim', '-quality', '25', '-compression_level', '4', '-loop', '0', film]);
