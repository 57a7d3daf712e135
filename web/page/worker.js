"use strict";
// Runs the solver beside the page. Each message of the page is { id, ask, given }, and is answered by { id, answer } or { id, failed }; what is
// told in between has no id. The page ends this worker to stop a solve.
self.tellProgress = (progress) => postMessage({ told: "progress", value: JSON.parse(progress) });
self.tellState = (state) => postMessage({ told: "state", value: state });
self.tellPanic = (message) => postMessage({ told: "panic", value: message });

let session = null;
const asks = {
  begin: async (module) => {
    await wasm_bindgen({ module_or_path: module });
    session = new wasm_bindgen.Session();
    return JSON.parse(wasm_bindgen.form());
  },
  open: (name, bytes) => session.open(name, new Uint8Array(bytes)),
  surface: (keys) => JSON.parse(session.surface(keys)),
  plan: (keys) => JSON.parse(session.plan(keys)),
  solve: (keys) => {
    const solved = session.solve(keys);
    const outcome = JSON.parse(solved.outcome());
    outcome.files = (outcome.files || []).map(([name]) => [name, solved.file(name)]);
    solved.free();
    return outcome;
  },
};

addEventListener("message", async ({ data: { id, ask, given } }) => {
  try {
    const answer = await asks[ask](...given);
    const files = ask === "solve" ? answer.files.map(([, bytes]) => bytes.buffer) : [];
    postMessage({ id, answer }, files);
  } catch (error) {
    postMessage({ id, failed: String(error) });
  }
});
