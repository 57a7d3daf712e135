"use strict";
// Keeps the page for use without a network: what is there is served from here, and a newer version is looked for beside it.
const STORE = "fractal-contact @VERSION@";
const FILES = ["./", "page.css", "report.js", "app.js", "worker.js", "fractal_contact_bg.wasm", "examples/polished.x3p", "examples/optical.x3p", "examples/uncd-afm.001"];
addEventListener("install", (event) => event.waitUntil(caches.open(STORE).then((store) => store.addAll(FILES)).then(() => skipWaiting())));
addEventListener("activate", (event) => event.waitUntil((async () => {
  for (const name of await caches.keys()) if (name.startsWith("fractal-contact ") && name !== STORE) await caches.delete(name);
  await clients.claim();
})()));
addEventListener("fetch", (event) => event.respondWith((async () => (await caches.match(event.request)) || fetch(event.request))()));
