// souple.d.ts declares what a program in TypeScript calls. Skipped in words without npm's typescript.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { copyFileSync, existsSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import test from 'node:test';
import { root } from './golden.mjs';

const compiler = `${process.env.SOUPLE_NPM}/node_modules/typescript/bin/tsc`;

test('a program in TypeScript compiles', { skip: !existsSync(compiler) && 'npm has not installed typescript' }, () => {
  const folder = mkdtempSync(join(tmpdir(), 'souple-'));
  copyFileSync(`${root}/web/tests/use.ts`, `${folder}/use.ts`);
  copyFileSync(`${process.env.SOUPLE_PACKAGE}/souple.d.ts`, `${folder}/souple.d.ts`);
  const options = ['--noEmit', '--strict', '--target', 'es2022', '--module', 'es2022', '--moduleResolution', 'bundler'];
  const done = spawnSync(process.execPath, [compiler, ...options, 'use.ts'], { cwd: folder, encoding: 'utf8' });
  rmSync(folder, { recursive: true });
  assert.equal(done.status, 0, done.stdout);
});
