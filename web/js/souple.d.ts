// Types of souple.js. Lengths are in meters, times in seconds; arrays hold x, y, z of each vertex.

export class SoupleError extends Error {}

/** Throws SoupleError where the module's memory has grown since the view was read. */
export function checkView<View extends ArrayBufferView>(view: View, what?: string): View;

export interface LoadOptions {
  /** souple_wasm.wasm, if it does not lie beside souple.js. */
  wasm?: ArrayBuffer | Uint8Array;
  /** Addresses of souple_wasm.mjs and souple_wasm.worker.js of a build with threads, likewise. */
  scripts?: { loader: string; worker: string };
  /** Views that throw when they are read after they were detached: slow, for searching mistakes. */
  checked?: boolean;
}
/** Why this build cannot run on this page, in a sentence; empty if it can. */
export function whyNot(): string;
export function load(options?: LoadOptions): Promise<Souple>;

/** A scene or an object, with the keys of docs/scene-format.md. */
export type Json = { [key: string]: unknown };
/** Values by path: { substeps: 20, 'objects.flag.material.damping': 0.1 }. */
export type Overrides = { [path: string]: unknown };
export type Point = [number, number, number];

export interface Report {
  time: number;
  /** `refused`: the step did nothing. `diverged`: the state before it was restored. */
  outcome: 'done' | 'refused' | 'diverged' | 'abandoned';
  step: number;
  milliseconds: number;
  /** Milliseconds of each stage. */
  stages: { [stage: string]: number };
  particles: number;
  constraints: number;
  contacts: number;
  asleep: number;
  deepestContact: number;
  /** Extension over rest length. */
  largestStrain: number;
  /** One line for each warning. */
  warnings: string;
  /** Why the last step is not done. */
  failure?: string;
}

export interface Tunable {
  name: string;
  label: string;
  unit: string;
  value: number;
  least: number;
  most: number;
  logarithmic: boolean;
}

/** Vertices by their numbers, or coordinates. */
export type Numbers = readonly number[] | Float32Array | Float64Array | Int32Array | Uint8Array | Uint16Array | Uint32Array;

export interface SoupleObject {
  readonly world: World;
  readonly id: number;
  readonly name: string;
  readonly kind: 'cloth' | 'soft_body' | 'rope' | 'grains' | 'obstacle' | 'fluid' | 'rigid_body';
  readonly radius: number;
  readonly vertexCount: number;
  readonly triangleCount: number;
  /** Views of the module's memory, without a copy and only to be read: read the property again after each step or reset. */
  readonly positions: Float32Array;
  readonly velocities: Float32Array;
  /** Empty for ropes, grains and fluids. */
  readonly normals: Float32Array;
  /** A copy. */
  readonly triangles: Uint32Array;
  /** Pins vertices where they are, until `unpin` or a reset: the scene has pins of its own, which a reset restores. */
  pin(vertices: Numbers): void;
  unpin(vertices: Numbers): void;
  movePins(vertices: Numbers, positions: Numbers): void;
}

export interface World {
  /** Gives the memory back; every later use throws SoupleError. */
  free(): void;
  /** One frame of the scene, or dt seconds. Throws SoupleError when the step is refused, and when a state is no longer finite. */
  step(dt?: number): void;
  reset(): void;
  readonly time: number;
  readonly frameRate: number;
  /** Hash of all positions and velocities: equal on every machine. */
  readonly hash: string;
  readonly report: Report;
  readonly scene: string;
  readonly objects: SoupleObject[];
  object(name: string): SoupleObject;
  add(object: Json): SoupleObject;
  set(path: string, value: unknown): void;
  /** The material's numbers of the object at this place in `objects`. */
  tunables(object: number): Tunable[];
  grab(origin: Point, direction: Point, reach?: number): boolean;
  drag(origin: Point, direction: Point): void;
  release(): void;
}

export interface WorldConstructor {
  new (scene?: Json | string, options?: { name?: string; folder?: string; overrides?: Overrides }): World;
  /** Opens a scene file that writeFile has stored. */
  open(file: string, overrides?: Overrides): World;
}

export interface Souple {
  readonly World: WorldConstructor;
  /** "Souple 0.1.0, wasm": the version and the instruction set. */
  readonly version: string;
  /** Threads that run now: 1, or more in a build with threads. */
  readonly threads: number;
  /** Bytes of the module's memory. */
  readonly memory: number;
  /** Bytes of it in use. */
  readonly memoryUsed: number;
  writeFile(path: string, content: string | ArrayBuffer | ArrayBufferView): void;
}
