// Emscripten's code for canvases names both even where none is used, but node lacks them.
var document = globalThis.document, window = globalThis.window;
// Workers get the binary from the page. In a page of one file they have no address to look for it.
if (typeof WorkerGlobalScope !== 'undefined') Module['locateFile'] = Module['locateFile'] || ((name) => name);
