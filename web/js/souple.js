// Souple for browsers and node. docs/browser.md explains it, souple.d.ts has the types.
import create from './souple_wasm.mjs';
import { threads } from './build.js';

/** An error, explained in a sentence. */
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
/** {...} or Object.create(null), of this page or another: no Promise, Map or Date, which have no keys of their own. */
function isPlain(value) {
  if (typeof value !== 'object' || value === null) return false;
  const prototype = Object.getPrototypeOf(value);
  return prototype === null || Object.getPrototypeOf(prototype) === null;
}
function plain(value, what, expected) {
  return isPlain(value) ? value : refuse(what, expected, value);
}
function toJson(value, what) {
  try {
    return JSON.stringify(value) ?? refuse(what, 'a value that JSON can hold', value);
  } catch (error) {
    if (error instanceof SoupleError) throw error;
    throw new SoupleError(`${what}: expected a value that JSON can hold (${error.message})`);
  }
}

function isDetached(view) {
  if (!ArrayBuffer.isView(view) || view.byteLength > 0) return false;
  try {
    return new Uint8Array(view.buffer) === undefined;
  } catch {
    return true;  // an empty view of a buffer that is still there does not throw
  }
}
/** The view behind each view of a module that was loaded with `checked`, and what finds out whether it still holds. */
const behind = new WeakMap();
/** Throws where the module's memory has grown since `view` was read: then the view is empty. */
export function checkView(view, what = 'the view') {
  behind.get(view)?.check();
  if (!isDetached(behind.get(view)?.view ?? view)) return view;
  throw new SoupleError(`${what} is detached: the module's memory has grown since it was read; read the property again`);
}
/** A view that reports when it is detached; slow, and for finding mistakes only. `check` throws where the world has
/*  another one now. */
function checkedView(view, what, check) {
  const readOnly = () => { throw new SoupleError(`${what} can only be read`); };
  const get = (target, key) => {
    checkView(view, what);
    check();
    if (['copyWithin', 'fill', 'reverse', 'set', 'sort'].includes(key)) readOnly();
    const value = view[key];
    return typeof value === 'function' ? value.bind(view) : value;
  };
  const proxy = new Proxy(view, { get, set: readOnly });
  behind.set(proxy, { view, check });
  return proxy;
}
function numbers(given, Type, what, multiple = 1) {
  checkView(given, what);
  const values = behind.get(given)?.view ?? given;
  if (!Array.isArray(values) && !(ArrayBuffer.isView(values) && 'length' in values)) refuse(what, 'an array of numbers', given);
  for (const value of values) number(value, what);
  if (values.length % multiple !== 0) refuse(what, `a multiple of ${multiple} numbers`, values.length);
  if (Type === Uint32Array && values.some((value) => value < 0 || value > 0xffffffff || !Number.isInteger(value)))
    throw new SoupleError(`${what}: expected whole numbers from 0 to 4294967295`);
  return values instanceof Type ? values : Type.from(values);
}
function overrideLines(overrides = {}) {
  plain(overrides, 'overrides', 'an object such as {substeps: 20}');
  return Object.entries(overrides).map(([path, value]) => `${path}=${toJson(value, path)}`).join('\n');
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
 * Loads the module. `wasm` is its binary, if it does not lie beside this file. `scripts` are the addresses of the
 * loader and of the worker of a build with threads, likewise. With `checked` a view that is detached throws when it is
 * read.
 */
export async function load(options = {}) {
  const { wasm, scripts, checked = false } = plain(options, 'load', 'options such as {checked: true}');
  if (whyNot() !== '') throw new SoupleError(whyNot());
  // Emscripten warns where the page waits for a thread to end. Those of a freed world end at once.
  const print = (line) => line.startsWith('Blocking on the main thread') || console.warn(line);
  const elsewhere = scripts && { mainScriptUrlOrBlob: scripts.loader, locateFile: () => scripts.worker };
  const M = await create({ wasmBinary: wasm ?? await readWasm(), print, printErr: print, ...elsewhere });
  /** The module's memory as it is now: of a build with threads another thread may have made it grow. */
  const memory = () => M.wasmMemory?.buffer ?? M.HEAPU8.buffer;

  /** Bytes of a text with its end, or of an array. Views of the module's own memory are copied: it may grow before they
  /*  are read. */
  function bytesOf(value) {
    if (typeof value !== 'string') {
      const bytes = new Uint8Array(value.buffer, value.byteOffset, value.byteLength);
      return value.buffer === memory() ? bytes.slice() : bytes;
    }
    if (value.includes('\0')) throw new SoupleError(`the text '${value.slice(0, 40)}' holds a zero character, expected none`);
    return new TextEncoder().encode(`${value}\0`);
  }
  /** Calls souple_NAME; texts and arrays are copied into the module's memory for the call. */
  function call(name, ...values) {
    const all = values.map((value) => typeof value === 'number' ? value : bytesOf(value));
    const copies = [];
    let result;
    try {
      const arguments_ = all.map((value) => {
        if (typeof value === 'number') return value;
        const at = M._malloc(Math.max(value.byteLength, 1));
        if (at === 0) throw new SoupleError(`out of memory: ${name} needs ${value.byteLength} bytes; free a world`);
        copies.push(at);
        new Uint8Array(memory(), at, value.byteLength).set(value);
        return at;
      });
      result = M[`_souple_${name}`](...arguments_);
    } finally {
      copies.forEach((at) => M._free(at));
    }
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
      if (!checked) return view;
      const what = `${this.name}.${name}`;
      return checkedView(view, what, () => {
        if (call(name, this.world.handle(name), this.id) === view.byteOffset) return;
        throw new SoupleError(`${what} is elsewhere since a reset or a change of its object; read the property again`);
      });
    }
    get vertexCount() { return call('vertex_count', this.world.handle('vertexCount'), this.id); }
    get triangleCount() { return this.world.info(this.id).triangles; }
    get positions() { return this.#view('positions', Float32Array, 3); }
    get velocities() { return this.#view('velocities', Float32Array, 3); }
    /** Empty for ropes, grains and fluids. */
    get normals() { return this.triangleCount > 0 ? this.#view('normals', Float32Array, 3) : new Float32Array(); }
    /** A copy: indices that a page changed would lead the module astray. */
    get triangles() { return this.#view('triangles', Uint32Array, 3).slice(); }
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
    constructor(scene = {}, options = {}) {
      const { name = 'scene', folder = '/', overrides } = plain(options, 'new World', 'options such as {name: \'mine\'}');
      const json = typeof scene === 'string' ? scene : toJson({ souple: 1, objects: [],
        ...plain(scene, 'new World', 'a scene, as an object or a text') }, 'new World');
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
      const json = toJson(plain(object, 'World.add', 'an object as in a scene'), 'World.add');
      return this.object(callText('add', this.handle('add'), json));
    }
    /** Sets a number of the running scene: set('substeps', 20), set('objects.flag.material.damping', 0.1). */
    set(path, value) {
      const line = `${text(path, 'World.set')}=${toJson(value, 'World.set')}`;
      call('set', this.handle('set'), line);
    }
    /** The numbers of an object's material that sliders show, with their ranges. */
    tunables(object) {
      const [place] = numbers([object], Uint32Array, 'World.tunables');
      return callJson('tunables', this.handle('tunables'), place);
    }
    /** Takes hold of what a ray hits, or passes within `reach` [m]. */
    grab(origin, direction, reach = 0) {
      const ray = this.#ray(origin, direction);
      return call('grab', this.handle('grab'), ray, number(reach, 'World.grab')) !== 0;
    }
    drag(origin, direction) {
      const ray = this.#ray(origin, direction);
      call('drag', this.handle('drag'), ray);
    }
    release() { call('release', this.handle('release')); }
    #ray(origin, direction) {
      const three = (values, what) => {
        const found = numbers(values, Float32Array, what);
        return found.length === 3 ? found : refuse(what, '3 numbers', values);
      };
      return Float32Array.of(...three(origin, 'the origin of a ray'), ...three(direction, 'the direction of a ray'), 0, 0, 0);
    }
  }

  /** Stores a file, such as a scene or a mesh that a scene names, where World.open finds it. */
  function writeFile(path, content) {
    if (!/^\/.*[^/]$/.test(text(path, 'writeFile'))) refuse('writeFile', 'a path such as /scenes/mine.json', path);
    const isBytes = content instanceof ArrayBuffer || ArrayBuffer.isView(content);
    if (typeof content !== 'string' && !isBytes) refuse('writeFile', 'a text or bytes', content);
    const bytes = !isBytes ? content : content instanceof ArrayBuffer ? new Uint8Array(content)
      : new Uint8Array(content.buffer, content.byteOffset, content.byteLength);
    try {
      path.split('/').slice(1, -1).reduce((above, folder) => {
        const here = `${above}/${folder}`;
        if (!M.FS.analyzePath(here).exists) M.FS.mkdir(here);
        return here;
      }, '');
      M.FS.writeFile(path, bytes);
    } catch (error) {
      throw new SoupleError(`writeFile: ${path} cannot be written (${error.message}), expected a path such as /scenes/mine.json`);
    }
  }

  return { World, writeFile, call, callText, version: callText('version'),
           /** Threads that run now, this one included. */
           get threads() { return 1 + (M.PThread?.runningWorkers.length ?? 0); },
           get memory() { return memory().byteLength; }, get memoryUsed() { return call('memory_used'); } };
}
