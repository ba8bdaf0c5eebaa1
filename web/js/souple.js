// Souple for browsers and node. docs/browser.md explains it, souple.d.ts has the types.
import create from './souple_wasm.mjs';
import { threads } from './build.js';

/** What went wrong, in a sentence. */
export class SoupleError extends Error {
  name = 'SoupleError';
}

function describe(value) {
  if (value === null || value === undefined) return String(value);
  if (typeof value === 'number') return `the number ${value}`;
  if (typeof value === 'string') return `the text '${value.slice(0, 40)}'`;
  return Array.isArray(value) ? 'an array' : `a value of type ${typeof value}`;
}
function refuse(what, expected, value) {
  throw new SoupleError(`${what}: expected ${expected}, got ${describe(value)}`);
}
function text(value, what) {
  return typeof value === 'string' ? value : refuse(what, 'a text', value);
}
function number(value, what) {
  return typeof value === 'number' && Number.isFinite(value) ? value : refuse(what, 'a finite number', value);
}
function isDetached(view) {
  return ArrayBuffer.isView(view) && view.byteLength === 0 && view.buffer.byteLength === 0;
}
/** Throws where the module's memory has grown since `view` was read: then the view is empty. */
export function checkView(view, what = 'the view') {
  if (!isDetached(view)) return view;
  throw new SoupleError(`${what} is detached: the module's memory has grown since it was read; read the property again`);
}
/** A view that says so itself; slow, and for searching mistakes only. */
function checkedView(view, what) {
  const get = (target, key) => {
    checkView(view, what);
    const value = view[key];
    return typeof value === 'function' ? value.bind(view) : value;
  };
  return new Proxy(view, { get, set: () => { throw new SoupleError(`${what} can only be read`); } });
}
function numbers(values, Type, what, multiple = 1) {
  checkView(values, what);
  if (!Array.isArray(values) && !ArrayBuffer.isView(values)) refuse(what, 'an array of numbers', values);
  for (const value of values) number(value, what);
  if (values.length % multiple !== 0) refuse(what, `a multiple of ${multiple} numbers`, values.length);
  if (Type === Uint32Array && values.some((value) => value < 0 || !Number.isInteger(value)))
    throw new SoupleError(`${what}: expected whole numbers from 0 on`);
  return values instanceof Type ? values : Type.from(values);
}
function overrideLines(overrides = {}) {
  if (typeof overrides !== 'object' || overrides === null) refuse('overrides', 'an object such as {substeps: 20}', overrides);
  return Object.entries(overrides).map(([path, value]) => `${path}=${JSON.stringify(value)}`).join('\n');
}
async function readWasm() {
  const url = new URL('souple_wasm.wasm', import.meta.url);
  if (url.protocol !== 'file:') return (await fetch(url)).arrayBuffer();
  const { readFile } = await import('node:fs/promises');
  return readFile(url);
}

/** Why this build cannot run here, in a sentence; empty if it can. */
export function whyNot() {
  if (!threads || globalThis.crossOriginIsolated) return '';
  return 'This build of Souple has threads, which browsers allow only on pages that their server isolates, with the headers '
    + 'Cross-Origin-Opener-Policy: same-origin and Cross-Origin-Embedder-Policy: require-corp. Use the build without threads.';
}

/**
 * Loads the module. `wasm` is its binary, if it does not lie beside this file; `scripts` are the addresses of the loader and
 * of the worker of a build with threads, likewise. With `checked` a view that is detached throws when it is read.
 */
export async function load({ wasm, scripts, checked = false } = {}) {
  if (whyNot() !== '') throw new SoupleError(whyNot());
  // Emscripten warns where the page waits for a thread to end. Those of a freed world end at once.
  const print = (line) => line.startsWith('Blocking on the main thread') || console.warn(line);
  const elsewhere = scripts && { mainScriptUrlOrBlob: scripts.loader, locateFile: () => scripts.worker };
  const M = await create({ wasmBinary: wasm ?? await readWasm(), print, printErr: print, ...elsewhere });
  /** The module's memory as it is now: of a build with threads another thread may have made it grow. */
  const memory = () => M.wasmMemory?.buffer ?? M.HEAPU8.buffer;

  /** Calls souple_NAME; texts and arrays are copied into the module's memory for the call. */
  function call(name, ...values) {
    const copies = [];
    const arguments_ = values.map((value) => {
      if (typeof value === 'number') return value;
      const isText = typeof value === 'string';
      const size = isText ? M.lengthBytesUTF8(value) + 1 : value.byteLength;
      const at = M._malloc(Math.max(size, 1));
      copies.push(at);
      if (isText) M.stringToUTF8(value, at, size);
      else new Uint8Array(memory(), at, size).set(new Uint8Array(value.buffer, value.byteOffset, value.byteLength));
      return at;
    });
    const result = M[`_souple_${name}`](...arguments_);
    copies.forEach((at) => M._free(at));
    const error = M._souple_error();
    if (error !== 0) throw new SoupleError(M.UTF8ToString(error));
    return result;
  }
  const callText = (name, ...values) => M.UTF8ToString(call(name, ...values));
  const callJson = (name, ...values) => JSON.parse(callText(name, ...values));

  /** An object of a world. The arrays are views of the module's memory: read the property again after a step. */
  class SoupleObject {
    constructor(world, { id, name, kind, radius }) {
      Object.assign(this, { world, id, name, kind, radius });
    }
    #view(name, Type, size) {
      const world = this.world.handle(name), at = call(name, world, this.id);
      const count = name === 'triangles' ? this.triangleCount : call('vertex_count', world, this.id);
      const view = new Type(memory(), at, at === 0 ? 0 : size * count);
      return checked ? checkedView(view, `${this.name}.${name}`) : view;
    }
    get vertexCount() { return call('vertex_count', this.world.handle('vertexCount'), this.id); }
    get triangleCount() { return this.world.info(this.id).triangles; }
    get positions() { return this.#view('positions', Float32Array, 3); }
    get velocities() { return this.#view('velocities', Float32Array, 3); }
    /** Empty for ropes, grains and fluids. */
    get normals() { return this.triangleCount > 0 ? this.#view('normals', Float32Array, 3) : new Float32Array(); }
    get triangles() { return this.#view('triangles', Uint32Array, 3); }
    /** Pins vertices where they are, or lets them go. */
    pin(vertices) { this.#vertices('pin', vertices); }
    unpin(vertices) { this.#vertices('unpin', vertices); }
    /** Moves pinned vertices: x, y, z of each [m]. */
    movePins(vertices, positions) {
      const which = numbers(vertices, Uint32Array, 'movePins: vertices');
      const to = numbers(positions, Float32Array, 'movePins: positions', 3);
      if (to.length !== 3 * which.length)
        throw new SoupleError(`movePins: expected ${3 * which.length} numbers for ${which.length} vertices, got ${to.length}`);
      call('move_pins', this.world.handle('movePins'), this.id, which, which.length, to);
    }
    #vertices(name, vertices) {
      const which = numbers(vertices, Uint32Array, `${name}: vertices`);
      call(name, this.world.handle(name), this.id, which, which.length);
    }
  }

  /** A world made from a scene: an object or a text with the keys of docs/scene-format.md. */
  class World {
    #handle = 0;
    constructor(scene = {}, { name = 'scene', folder = '/', overrides } = {}) {
      if (typeof scene !== 'string' && (typeof scene !== 'object' || scene === null || Array.isArray(scene)))
        refuse('new World', 'a scene, as an object or a text', scene);
      const json = typeof scene === 'string' ? scene : JSON.stringify({ souple: 1, objects: [], ...scene });
      this.#handle = call('open_text', json, text(folder, 'folder'), text(name, 'name'), overrideLines(overrides));
    }
    /** A scene file that `writeFile` has stored. */
    static open(file, overrides) {
      const handle = call('open_file', text(file, 'World.open'), overrideLines(overrides));
      const world = new World();
      call('close', world.#handle);
      world.#handle = handle;
      return world;
    }
    /** For this module's own calls. */
    handle(what = 'this call') {
      if (this.#handle === 0) throw new SoupleError(`World.${what}: the world was freed; make a new one`);
      return this.#handle;
    }
    /** Gives the world's memory back. Every later use of the world or of its objects throws. */
    free() {
      if (this.#handle !== 0) call('close', this.#handle);
      this.#handle = 0;
    }
    /** One frame of the scene, or dt seconds. */
    step(dt) {
      if (dt !== undefined && !(number(dt, 'World.step') > 0)) refuse('World.step', 'a time above 0 s', dt);
      call('step', this.handle('step'), dt ?? 0);
    }
    reset() { call('reset', this.handle('reset')); }
    get time() { return call('time', this.handle('time')); }
    get frameRate() { return call('frame_rate', this.handle('frameRate')); }
    /** Hash of all positions and velocities, as in tests/golden.json. */
    get hash() { return callText('hash', this.handle('hash')); }
    /** Numbers of the last step. */
    get report() { return callJson('report', this.handle('report')); }
    /** The scene as it is now, as a text. */
    get scene() { return callText('scene', this.handle('scene')); }
    get objects() { return callJson('objects', this.handle('objects')).map((info) => new SoupleObject(this, info)); }
    info(id) { return callJson('objects', this.handle('info')).find((info) => info.id === id) ?? refuse('info', 'an object', id); }
    object(name) {
      const all = this.objects, found = all.find((object) => object.name === text(name, 'World.object'));
      return found ?? refuse('World.object', `one of ${all.map((object) => `'${object.name}'`).join(', ')}`, name);
    }
    /** Adds an object, with the keys of a scene's object. */
    add(object) {
      if (typeof object !== 'object' || object === null) refuse('World.add', 'an object as in a scene', object);
      return this.object(callText('add', this.handle('add'), JSON.stringify(object)));
    }
    /** Sets a number of the running scene: set('substeps', 20), set('objects.flag.material.damping', 0.1). */
    set(path, value) {
      if (value === undefined) refuse('World.set', 'a value', value);
      call('set', this.handle('set'), `${text(path, 'World.set')}=${JSON.stringify(value)}`);
    }
    /** The numbers of an object's material that sliders show, with their ranges. */
    tunables(object) { return callJson('tunables', this.handle('tunables'), number(object, 'World.tunables')); }
    /** Takes hold of what a ray hits, or passes within `reach` [m]. */
    grab(origin, direction, reach = 0) {
      return call('grab', this.handle('grab'), this.#ray(origin, direction), number(reach, 'World.grab')) !== 0;
    }
    drag(origin, direction) { call('drag', this.handle('drag'), this.#ray(origin, direction)); }
    release() { call('release', this.handle('release')); }
    #ray(origin, direction) {
      const ray = numbers([...origin, ...direction, 0, 0, 0], Float32Array, 'a ray');
      return ray.length === 9 ? ray : refuse('a ray', 'an origin and a direction of 3 numbers', ray.length - 3);
    }
  }

  /** Stores a file, such as a scene or a mesh that a scene names, where World.open finds it. */
  function writeFile(path, content) {
    const folders = text(path, 'writeFile').split('/').slice(1, -1);
    folders.reduce((above, folder) => {
      const here = `${above}/${folder}`;
      if (!M.FS.analyzePath(here).exists) M.FS.mkdir(here);
      return here;
    }, '');
    M.FS.writeFile(path, content);
  }

  return { World, writeFile, call, callText, version: callText('version'),
           /** Threads that run now, this one included. */
           get threads() { return 1 + (M.PThread?.runningWorkers.length ?? 0); },
           get memory() { return memory().byteLength; }, get memoryUsed() { return call('memory_used'); } };
}
