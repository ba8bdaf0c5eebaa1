// What node lacks: Emscripten's code for canvases names both even where none is used.
var document = globalThis.document, window = globalThis.window;
