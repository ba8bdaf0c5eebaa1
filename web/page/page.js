// The page: panels in HTML around a View, the part of the module that draws a world on a canvas.
import { load, SoupleError, whyNot } from './souple.js';
import { unpackLzma } from './lzma.js';

const $ = (id) => document.getElementById(id);
const files = JSON.parse($('files_inside').textContent);
const canvas = $('canvas');

/** The scenes of the menu, with what makes them fit a browser. */
const scenes = {
  playground: {}, curtain: {}, flag: {}, jelly_armada: {}, balloon: {}, rope_bridge: {}, sand_pile: {},
  dam_break: { 'objects.water.material.spacing': 0.06 }, ducks: { 'objects.water.material.spacing': 0.06 },
  folded_cloth: {},
};
const displays = ['shaded', 'plain', 'wireframe', 'strain', 'speed', 'particles', 'lattice', 'normals', 'contacts'];
const constraintDisplays = ['none', 'kind', 'color', 'strain', 'residual'];
const additions = ['cloth', 'soft ball', 'stiff box', 'rope', 'grains'];
const legends = { strain: 'red: stretched by 10 % or more', speed: 'red: 3 m/s or more', contacts: 'lines: contacts with an impulse' };

let souple, view, world;
const shown = { scene: '', own: undefined, overrides: {}, display: 0, constraints: 0 };
const pointers = new Map();  // pressed ones: where each was last
let hand = 'none', cursor = [0, 0], scale = Math.min(devicePixelRatio, 2), slow = 0;

// --- words ------------------------------------------------------------------------------------------

function notice(words, kind = 'info') {
  const p = document.createElement('p');
  p.className = kind;
  p.textContent = words;
  $('notices').append(p);
  while ($('notices').children.length > 4) $('notices').firstChild.remove();
  setTimeout(() => p.remove(), kind === 'error' ? 9000 : 3500);
}
/** Shows the sentence of an action that fails. */
function guarded(action) {
  const failed = (error) => {
    if (!(error instanceof SoupleError)) throw error;
    notice(error.message, 'error');
  };
  try {
    const result = action();
    return result instanceof Promise ? result.catch(failed) : result;
  } catch (error) {
    failed(error);
  }
}
function fail(words) {
  $('wait').textContent = words;
  $('wait').className = 'failed';
  $('wait').hidden = false;
}

// --- scenes and links ---------------------------------------------------------------------------------

function open(name, { own, overrides = {} } = {}) {
  guarded(() => {
    const all = own === undefined ? { ...scenes[name], ...overrides } : overrides;
    const next = own === undefined ? souple.World.open(`/scenes/${name}.json`, all)
                                   : new souple.World(own, { name, folder: '/scenes', overrides });
    const before = world;
    world = next;
    fitCanvas();
    souple.call('view_show', view, world.handle(), canvas.width, canvas.height);
    before?.free();
    Object.assign(shown, { scene: name, own, overrides });
    hand = 'none';
    fillPanels();
  });
}
function settings() {
  const scene = JSON.parse(world.scene);
  return { substeps: 10, iterations: 1, mode: 'small_steps', gravity: [0, -9.81, 0], ...scene };
}
function set(path, value) {
  guarded(() => {
    world.set(path, value);
    shown.overrides[path] = value;
    showLink();
  });
}
async function pack(text, stream) {
  return new Uint8Array(await new Response(new Blob([text]).stream().pipeThrough(stream)).arrayBuffer());
}
const toBase64 = (bytes) => btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(''));
const fromBase64 = (text) => Uint8Array.from(atob(text.trim()), (letter) => letter.charCodeAt(0));

async function linkHash() {
  const parts = new URLSearchParams();
  if (shown.own === undefined) parts.set('scene', shown.scene);
  else parts.set('data', toBase64(await pack(shown.own, new CompressionStream('gzip'))));
  for (const [path, value] of Object.entries(shown.overrides)) parts.append('set', `${path}=${JSON.stringify(value)}`);
  if (shown.display > 0) parts.set('display', displays[shown.display]);
  return `#${parts}`;
}
/** A longer address is left empty rather than naming another scene; "Copy a link" gives it. */
async function showLink() {
  const hash = await linkHash(), longest = 8000;
  history.replaceState(null, '', hash.length < longest ? hash : location.pathname + location.search);
}
/** Opens what the address names; the part after # is sent to no server. */
async function openAddress() {
  const parts = new URLSearchParams(location.hash.slice(1));
  const overrides = Object.fromEntries(parts.getAll('set').map((line) => {
    const at = line.indexOf('=');
    try {
      return [line.slice(0, at), JSON.parse(line.slice(at + 1))];
    } catch {
      return [line.slice(0, at), line.slice(at + 1)];
    }
  }));
  shown.display = Math.max(displays.indexOf(parts.get('display') ?? 'shaded'), 0);
  const name = parts.get('scene') ?? 'playground';
  if (parts.has('data')) {
    const own = await pack(fromBase64(parts.get('data')), new DecompressionStream('gzip'))
      .then((bytes) => new TextDecoder().decode(bytes), () => notice('the link is damaged: its scene cannot be read', 'error'));
    if (own !== undefined) open('own', { own, overrides });
  } else if (Object.keys(scenes).includes(name)) {
    open(name, { overrides });
  } else {
    notice(`the link names the scene '${name}', which this page lacks`, 'error');
  }
  if (world === undefined) open('playground');
}
async function bytesOf(file) {
  try {
    return new Uint8Array(await file.arrayBuffer());
  } catch {
    throw new SoupleError(`${file.name}: cannot be read, expected a file and no folder`);
  }
}
async function take(file) {
  const bytes = await bytesOf(file);
  if (file.name.endsWith('.json')) {
    open(file.name.replace(/\.json$/, ''), { own: new TextDecoder().decode(bytes) });
  } else if (/\.(obj|ply|stl)$/i.test(file.name)) {
    guarded(() => {
      souple.writeFile(`/scenes/${file.name}`, bytes);
      souple.call('view_add_mesh', view, `/scenes/${file.name}`);
      fillPanels();
      notice(`added ${file.name}`);
    });
  } else {
    notice(`${file.name}: expected a scene (.json) or a mesh (.obj, .ply, .stl)`, 'error');
  }
}
async function takeAll(list) {
  // Meshes first: a scene among the files may name them.
  const all = [...list].sort((a, b) => a.name.endsWith('.json') - b.name.endsWith('.json'));
  const scene = all.some((file) => file.name.endsWith('.json'));
  for (const file of all) {
    await guarded(async () => {
      if (scene && /\.(obj|ply|stl)$/i.test(file.name)) souple.writeFile(`/scenes/${file.name}`, await bytesOf(file));
      else await take(file);
    });
  }
}

// --- panels ------------------------------------------------------------------------------------------

function fill(select, names, chosen) {
  select.replaceChildren(...names.map((name, i) => new Option(name, i)));
  select.value = chosen;
}
function slider(id, value, changed) {
  const input = $(id), output = input.nextElementSibling;
  input.value = value;
  output.textContent = value;
  input.oninput = () => {
    output.textContent = input.value;
    changed(Number(input.value));
  };
}
const short = (value) => value === 0 ? '0' : Number(value.toPrecision(3)).toString();

function materialRow(object, tunable) {
  const label = document.createElement('label'), input = document.createElement('input'), output = document.createElement('output');
  const { least, most, logarithmic } = tunable;
  const toValue = (at) => !logarithmic ? least + (most - least) * at : at === 0 ? 0 : least * (most / least) ** at;
  const toPlace = (value) => !logarithmic ? (value - least) / (most - least) : value <= 0 ? 0 : Math.log(value / least) / Math.log(most / least);
  const show = (value) => { output.textContent = `${short(value)} ${tunable.unit}`; };
  Object.assign(input, { type: 'range', min: 0, max: 1, step: 0.002, value: toPlace(tunable.value) });
  input.dataset.tunable = tunable.name;
  input.oninput = () => {
    const value = Number(toValue(Number(input.value)).toPrecision(4));
    show(value);
    set(`objects.${object.name}.material.${tunable.name}`, value);
  };
  show(tunable.value);
  label.append(tunable.label, input, output);
  return label;
}
function fillMaterial() {
  const i = Number($('object').value), object = world.objects[i];
  $('material').replaceChildren(...(object ? world.tunables(i).map((tunable) => materialRow(object, tunable)) : []));
}
function fillPanels() {
  const scene = settings(), objects = world.objects;
  $('scene').value = shown.own === undefined ? shown.scene : '';
  $('description').textContent = scene.description ?? '';
  slider('substeps', scene.substeps, (value) => set('substeps', value));
  slider('iterations', scene.iterations, (value) => set('iterations', value));
  slider('gravity', scene.gravity[1], (value) => set('gravity', [0, value, 0]));
  $('mode').value = scene.mode;
  const first = objects.findIndex((object) => object.kind !== 'obstacle');
  fill($('object'), objects.map((object) => object.name), Math.max(first, 0));
  fillMaterial();
  showDisplay();
  showLink();
}
function showDisplay() {
  $('display').value = shown.display;
  $('constraints').value = shown.constraints;
  const words = legends[displays[shown.display]];
  $('legend').hidden = words === undefined;
  $('legend').textContent = words ?? '';
  souple.call('view_display', view, shown.display, shown.constraints, Number($('wireframe').checked));
  souple.call('view_quality', view, Number($('shadows').checked), Number($('occlusion').checked));
}
function showNumbers(frames) {
  if (world.objects.length !== $('object').length) fillPanels();  // thrown, added, or back in time
  const report = world.report, playing = souple.call('playing', world.handle()) !== 0;
  $('pause').textContent = playing ? 'Pause' : 'Play';
  $('numbers').textContent = `${report.time.toFixed(2)} s, ${frames} pictures/s, ${Math.round(100 * souple.call('speed', world.handle()))} % of real time\n`
    + `step ${report.milliseconds.toFixed(1)} ms, ${report.particles} particles, ${report.constraints} constraints\n`
    + `${report.contacts} contacts, strain ${(100 * report.largestStrain).toFixed(1)} %, deepest contact ${(1000 * report.deepestContact).toFixed(2)} mm`
    + (report.warnings ? `\n${report.warnings.trim()}` : '');
  $('stages').replaceChildren(...Object.entries(report.stages).map(([stage, ms]) => row(stage, `${ms.toFixed(2)} ms`)));
  if (report.failure && $('notices').children.length === 0) notice(report.failure, 'error');
}
function row(...cells) {
  const tr = document.createElement('tr');
  for (const cell of cells) tr.insertCell().textContent = cell;
  return tr;
}

// --- what users do -----------------------------------------------------------------------------------

function play(playing = souple.call('playing', world.handle()) === 0) {
  souple.call('play', world.handle(), Number(playing));
}
function neighbor(step) {
  const names = Object.keys(scenes), at = names.indexOf(shown.scene);
  open(names[(Math.max(at, 0) + step + names.length) % names.length]);
}
function reset() {
  hand = 'none';
  world.reset();
}
function throwBall(at = cursor) {
  souple.call('view_throw', view, ...at);
}
function savePicture() {
  draw();
  canvas.toBlob((blob) => {
    const a = Object.assign(document.createElement('a'), { href: URL.createObjectURL(blob), download: `souple-${shown.scene}.png` });
    a.click();
    URL.revokeObjectURL(a.href);
  });
}
/** As `souple view`: key, words, action. */
const keys = [
  [' ', 'Space', 'pause and resume', () => play()],
  ['.', '.', 'one frame', () => souple.call('step_frame', world.handle())],
  [',', ',', 'one substep', () => souple.call('step_substep', world.handle())],
  ['b', 'B', 'back in time', () => souple.call('step_back', world.handle())],
  ['r', 'R', 'reset', reset],
  ['n', 'N', 'next scene', () => neighbor(1)],
  ['p', 'P', 'previous scene', () => neighbor(-1)],
  ['t', 'T', 'throw a ball at the cursor', () => throwBall()],
  ['a', 'A', 'add a soft ball at the cursor', () => souple.call('view_add', view, 1, ...cursor)],
  ['f', 'F', 'frame all', () => souple.call('view_frame_all', view)],
  ['w', 'W', 'wireframe on and off', () => { $('wireframe').checked = !$('wireframe').checked; showDisplay(); }],
  ['c', 'C', 'next display of constraints', () => { shown.constraints = (shown.constraints + 1) % constraintDisplays.length; showDisplay(); }],
  ['', '1-9', 'display mode', () => {}],
  ['s', 'S', 'save a picture', savePicture],
  ['h', 'H', 'hide or show the panels', () => document.body.classList.toggle('bare')],
];
const gestures = [['drag', 'grab an object; beside it: orbit'], ['right drag, two fingers', 'pan, zoom'], ['wheel', 'zoom'], ['double click', 'pin or unpin']];

function press(key) {
  if (key >= '1' && key <= '9') {
    shown.display = Number(key) - 1;
    showDisplay();
    showLink();
  } else {
    keys.find(([character]) => character === key)?.[3]();
  }
}
function place(event) {
  const box = canvas.getBoundingClientRect();
  return [(event.clientX - box.left) * canvas.width / box.width, (event.clientY - box.top) * canvas.height / box.height];
}
function pointerDown(event) {
  canvas.focus();
  canvas.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, place(event));
  cursor = place(event);
  if (pointers.size === 2) {
    world.release();
    hand = 'pinch';
  } else {
    hand = event.button === 2 ? 'pan' : souple.call('view_grab', view, ...cursor) !== 0 ? 'grab' : 'orbit';
  }
  canvas.classList.toggle('holds', hand === 'grab');
}
function pointerMove(event) {
  const at = place(event), before = pointers.get(event.pointerId);
  cursor = at;
  if (before === undefined) return;
  const dx = at[0] - before[0], dy = at[1] - before[1], perPixel = canvas.clientWidth / canvas.width;
  if (hand === 'grab') souple.call('view_drag', view, ...at);
  if (hand === 'orbit') souple.call('view_orbit', view, dx * perPixel, dy * perPixel);
  if (hand === 'pan') souple.call('view_pan', view, dx, dy);
  if (hand === 'pinch' && pointers.size === 2) {
    const [other] = [...pointers].filter(([id]) => id !== event.pointerId).map(([, where]) => where);
    const distance = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
    souple.call('view_zoom', view, distance(before) / Math.max(distance(at), 1));
    souple.call('view_pan', view, dx / 2, dy / 2);
  }
  pointers.set(event.pointerId, at);
}
function pointerUp(event) {
  pointers.delete(event.pointerId);
  if (pointers.size > 0) return;
  world.release();
  hand = 'none';
  canvas.classList.remove('holds');
}
function listen() {
  const on = (target, events, action) => events.split(' ').forEach((name) => target.addEventListener(name, (event) => guarded(() => action(event))));
  on(canvas, 'pointerdown', pointerDown);
  on(canvas, 'pointermove', pointerMove);
  on(canvas, 'pointerup pointercancel', pointerUp);
  on(canvas, 'contextmenu', (event) => event.preventDefault());
  on(canvas, 'dblclick', (event) => souple.call('view_pin', view, ...place(event)));
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    souple.call('view_zoom', view, 0.88 ** (-event.deltaY / 100));
  }, { passive: false });
  on(canvas, 'webglcontextlost', () => fail('The browser took the graphics away: load the page again.'));
  on(document, 'keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || /^(INPUT|SELECT|BUTTON|SUMMARY)$/.test(event.target.tagName) && event.key !== 'h') return;
    if (event.key === ' ') event.preventDefault();
    press(event.key.toLowerCase());
  });
  on($('scene'), 'change', () => open($('scene').value));
  on($('pause'), 'click', () => play());
  for (const id of ['step_frame', 'step_back']) on($(id), 'click', () => souple.call(id, world.handle()));
  on($('reset'), 'click', reset);
  on($('throw'), 'click', () => throwBall([canvas.width / 2, canvas.height / 2]));
  on($('menu'), 'click', () => $('menu').setAttribute('aria-expanded', document.body.classList.toggle('menu')));
  on($('display'), 'change', () => { shown.display = Number($('display').value); showDisplay(); showLink(); });
  on($('constraints'), 'change', () => { shown.constraints = Number($('constraints').value); showDisplay(); });
  for (const id of ['wireframe', 'shadows', 'occlusion']) on($(id), 'change', showDisplay);
  on($('mode'), 'change', () => { set('mode', $('mode').value); fillMaterial(); });
  on($('object'), 'change', fillMaterial);
  on($('link'), 'click', async () => {
    const link = location.href.split('#')[0] + await linkHash();
    try {
      await navigator.clipboard.writeText(link);
    } catch {
      throw new SoupleError('the browser gives this page no clipboard, which needs https; copy the address instead');
    }
    notice('the link is in the clipboard');
  });
  on($('picture'), 'click', savePicture);
  on($('files'), 'change', () => takeAll($('files').files));
  on(document, 'dragover', (event) => event.preventDefault());
  on(document, 'drop', (event) => { event.preventDefault(); return takeAll(event.dataTransfer.files); });
  on(window, 'hashchange', openAddress);
}

// --- pictures -----------------------------------------------------------------------------------------

function fitCanvas() {
  const width = Math.max(Math.round(canvas.clientWidth * scale), 1), height = Math.max(Math.round(canvas.clientHeight * scale), 1);
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
}
function draw() {
  fitCanvas();
  souple.call('view_draw', view, canvas.width, canvas.height);
}
/** Fewer pixels where pictures take long. */
function adapt(milliseconds) {
  slow = 0.9 * slow + 0.1 * milliseconds;
  if (slow < 50 || scale <= 0.5) return;
  scale = Math.max(0.75 * scale, 0.5);
  slow = 0;
}
function run() {
  let last = performance.now(), counted = last, frames = 0;
  const frame = (now) => {
    const seconds = Math.min((now - last) / 1000, 0.1);
    adapt(Math.min(now - last, 200));
    last = now;
    try {
      guarded(() => souple.call('view_advance', view, seconds));
      guarded(draw);
    } catch (error) {
      return fail(`The engine stopped: ${error.message}. Load the page again.`);
    }
    ++frames;
    if (now - counted > 400) {
      guarded(() => showNumbers(Math.round(1000 * frames / (now - counted))));
      counted = now;
      frames = 0;
    }
    requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
}
function missing() {
  const simd = [0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11];
  if (typeof WebAssembly !== 'object') return 'This browser runs no WebAssembly. Use a newer one.';
  if (!WebAssembly.validate(new Uint8Array(simd))) return 'This browser lacks the SIMD instructions of WebAssembly. Use Chrome 91, Firefox 90, Safari 16.4 or newer.';
  if (typeof DecompressionStream !== 'function') return 'This browser cannot unpack the page. Use Chrome 80, Firefox 113, Safari 16.4 or newer.';
  if (whyNot() !== '') return whyNot();
  if (!document.createElement('canvas').getContext('webgl2')) return 'This browser shows no WebGL 2. Turn on hardware acceleration, or use a newer browser.';
  return '';
}
/** The scripts that workers of a build with threads load. */
function workerScripts() {
  const address = (id) => URL.createObjectURL(new Blob([$(id).textContent], { type: 'text/javascript' }));
  return $('worker_inside').textContent === '' ? undefined : { loader: address('loader_inside'), worker: address('worker_inside') };
}
async function start() {
  const lack = missing();
  if (lack) return fail(lack);
  try {
    souple = await load({ wasm: unpackLzma(fromBase64($('wasm_inside').textContent)), scripts: workerScripts() });
    for (const [path, content] of Object.entries(files)) souple.writeFile(path, content);
    fitCanvas();
    view = souple.call('view', '#canvas');
  } catch (error) {
    return fail(`The page cannot start: ${error.message}`);
  }
  $('scene').replaceChildren(...Object.keys(scenes).map((name) => new Option(name.replaceAll('_', ' '), name)));
  fill($('display'), displays, 0);
  fill($('constraints'), constraintDisplays, 0);
  $('keys').replaceChildren(...keys.map(([, key, words]) => row(key, words)), ...gestures.map((words) => row(...words)));
  $('additions').replaceChildren(...additions.map((name, i) => Object.assign(document.createElement('button'), {
    textContent: name, onclick: () => guarded(() => souple.call('view_add', view, i, canvas.width / 2, canvas.height / 2)) })));
  $('version').textContent = souple.version;
  await openAddress();
  listen();
  $('wait').hidden = true;
  run();
  window.page = { souple, press, get world() { return world; }, take };  // for tests and the curious
}
start();
