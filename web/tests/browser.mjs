// Headless Chromium that draws in software, for tests; `skip` says what is missing.
import { existsSync } from 'node:fs';
import { createRequire } from 'node:module';

const chromium = ['/usr/bin/chromium', '/usr/bin/google-chrome'].find(existsSync);
let puppeteer;
try {
  puppeteer = createRequire(`${process.env.SOUPLE_NPM}/node_modules/`)('puppeteer-core');
} catch {
  puppeteer = undefined;
}
export const skip = chromium === undefined ? 'Chromium is not installed' : puppeteer === undefined ? 'npm has not installed puppeteer-core' : false;

/** A page at an address. `errors` gets what its console complains about, `requests` what it asks for. */
export async function open(address, viewport = { width: 900, height: 600 }) {
  const browser = await puppeteer.launch({ executablePath: chromium, protocolTimeout: 1800000, args: [
    '--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-gpu-watchdog'] });
  const page = await browser.newPage(), errors = [], requests = [];
  page.on('console', (message) => ['error', 'warn', 'warning'].includes(message.type()) && errors.push(message.text()));
  page.on('pageerror', (error) => errors.push(String(error)));
  page.on('request', (request) => requests.push(request.url()));
  page.setDefaultTimeout(120000);  // in software, on a busy machine
  await page.setViewport(viewport);
  await page.goto(address);
  return { browser, page, errors, requests };
}
