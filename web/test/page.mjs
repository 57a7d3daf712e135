// The page in a browser: `node page.mjs DIST PROGRAM DATA [--shots FOLDER] [--times]`. DIST is what `cargo xtask web` makes, PROGRAM is
// `fractal-contact`, DATA the folder `data`. Needs playwright-core beside it or in NODE_PATH, and a Chromium (CHROMIUM, /usr/bin/chromium).
import { execFileSync } from "node:child_process";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import assert from "node:assert/strict";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { pathToFileURL } from "node:url";

const { chromium } = createRequire(path.join(process.env.NODE_PATH || process.cwd(), "x.js"))("playwright-core");
const [dist, program, data] = process.argv.slice(2, 5).map((folder) => path.resolve(folder));
const option = (name) => { const at = process.argv.indexOf(name); return at < 0 ? null : process.argv[at + 1] || true; };
const shots = option("--shots");
const scratch = fs.mkdtempSync(path.join(os.tmpdir(), "page-"));

// ---- A plain server of files and a browser ------------------------------------------------------------------------------------------------

const TYPES = { html: "text/html", css: "text/css", js: "text/javascript", wasm: "application/wasm" };
const server = createServer((request, response) => {
  const name = path.join(dist, decodeURIComponent(new URL(request.url, "http://x").pathname).replace(/\/$/, "/index.html"));
  if (!name.startsWith(dist) || !fs.existsSync(name)) return response.writeHead(404).end();
  response.writeHead(200, { "content-type": TYPES[name.split(".").at(-1)] || "application/octet-stream" }).end(fs.readFileSync(name));
});
await new Promise((ready) => server.listen(0, "127.0.0.1", ready));
const served = `http://127.0.0.1:${server.address().port}/`;
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM || "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
});

const errors = [];
const opened = async (address, settings = {}) => {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, acceptDownloads: true, ...settings });
  const page = await context.newPage();
  page.on("pageerror", (error) => errors.push(String(error)));
  page.on("console", (message) => { if (message.type() === "error" && !/Content Security Policy|violates the following/.test(message.text())) errors.push(message.text()); });
  page.requests = [];
  page.on("request", (request) => page.requests.push(request.url()));
  await page.goto(address);
  await page.waitForFunction(() => document.documentElement.dataset.ready === "true", null, { timeout: 60_000 });
  return page;
};
const status = (page) => page.textContent("#ui-status");
const settled = async (page) => {
  const ready = page.waitForFunction(() => !document.querySelector("#ui-solve").disabled, null, { timeout: 60_000 });
  await ready.catch(async (error) => { throw new Error(`${await status(page)}; ${await page.textContent("#ui-mistake")}; ${page.url()}`, { cause: error }); });
};
const told = (page, pattern, timeout = 90_000) => page.waitForFunction((text) => new RegExp(text).test(document.querySelector("#ui-status").textContent), pattern, { timeout });
const put = async (page, key, text) => {
  const place = page.locator(`[id="ui-key-${key}"]`);
  if (!(await place.isVisible())) await page.evaluate((id) => { for (let at = document.getElementById(id)?.closest("details"); at; at = at.parentElement.closest("details")) at.open = true; }, `ui-key-${key}`);
  if (await place.evaluate((control) => control.tagName === "SELECT")) await place.selectOption(text);
  else { await place.fill(text); await place.dispatchEvent("change"); }
};
const solved = async (page) => {
  await settled(page);
  await page.click("#ui-solve");
  await told(page, "^(Solved in|This was not solved|this is a defect|Stopped)");
  assert.match(await status(page), /^Solved in/, await page.textContent("#ui-mistake"));
};
const downloaded = async (page, name) => {
  if (!["report.html", "results.csv", "scene.toml"].includes(name)) await page.evaluate(() => { document.querySelector("#ui-downloads details").open = true; });
  const [download] = await Promise.all([page.waitForEvent("download"), page.click(`#ui-downloads a[download="${name}"]`)]);
  return fs.readFileSync(await download.path());
};
// The small map, or the one that the page of one file has.
const example = (page) => page.locator("#ui-examples button", { hasText: /optical|polished/ }).last().click();
const table = (text) => {
  const [head, ...lines] = text.split("\n").filter((line) => line && !line.startsWith("#")).map((line) => line.split(","));
  return lines.map((line) => Object.fromEntries(head.map((name, i) => [name, line[i]])));
};
const tests = [];
const test = (name, does) => tests.push([name, does]);

// ---- Tests --------------------------------------------------------------------------------------------------------------------------------

// The numbers of the page against those of the program on the scene that the page gives.
const MAPS = [
  ["measured/optical.x3p", [["scene.surface.undefined", "no_contact"]]],
  ["measured/uncd-afm.001", [["scene.surface.channel", "0"], ["scene.surface.cells", "256"]]],
  ["map.sur", []],
  ["map.gwy", []],
  ["map.csv", [["scene.surface.unit", "nm"], ["scene.surface.cell", "0.5 um"]]],
];
const largest = [];
const compare = async (page, name, boundary) => {
  await solved(page);
  const folder = fs.mkdtempSync(path.join(scratch, "run-"));
  fs.copyFileSync(name, path.join(folder, path.basename(name)));
  fs.writeFileSync(path.join(folder, "scene.toml"), await downloaded(page, "scene.toml"));
  execFileSync(program, ["run", "scene.toml", "--out", "out"], { cwd: folder, stdio: "pipe" });
  const [here, there] = [String(await downloaded(page, "results.csv")), fs.readFileSync(path.join(folder, "out/results.csv"), "utf8")].map(table);
  assert.equal(here.length, there.length);
  for (let i = 0; i < here.length; i++) {
    const number = (row, column) => Number(row[column]);
    assert.equal(here[i].contact_cells, there[i].contact_cells, `${name}, ${boundary}: number of cells in contact`);
    const names = ["area", "stiffness", ...(boundary === "free" ? ["approach"] : ["mean_gap"])];
    for (const column of names) {
      const [a, b] = [number(here[i], column), number(there[i], column)];
      assert(Number.isFinite(a) && Number.isFinite(b), `${name}, ${boundary}: ${column} = ${here[i][column]} and ${there[i][column]}`);
      const difference = Math.abs(a - b) / Math.abs(b);
      const certified = (row) => ["duality_gap", "penetration", "stiffness_error"].map((of) => Math.abs(number(row, of)) || 0).reduce((x, y) => x + y, 0);
      largest.push([difference, `${path.basename(name)}, ${boundary}, load ${i}: ${column}`]);
      assert(difference <= 1e-12 + certified(here[i]) + certified(there[i]), `${name}, ${boundary}: ${column} differs by ${difference}`);
    }
  }
};
// A map of Digital Surf: heights of one surface as 32-bit numbers.
const sur = ([columns, rows], height) => {
  const file = Buffer.alloc(512 + 4 * columns * rows);
  file.write("DIGITAL SURF", 0);
  [[14, 1], [16, 1], [18, 2], [98, 32]].forEach(([at, value]) => file.writeInt16LE(value, at));
  [-1e8, 1e8, columns, rows, columns * rows].forEach((value, i) => file.writeInt32LE(value, 100 + 4 * i));
  [0.5, 0.5, 0.001].forEach((value, i) => file.writeFloatLE(value, 120 + 4 * i));
  [[164, "Height"], [180, "um"], [196, "um"], [212, "nm"]].forEach(([at, text]) => file.write(text, at));
  file.writeFloatLE(1, 474);
  for (let i = 0; i < columns * rows; i++) file.writeInt32LE(Math.round(1000 * height(i % columns, Math.floor(i / columns))), 512 + 4 * i);
  return file;
};
const ownMaps = () => {
  const size = ["--cells", "96", "--size", "48 um", "--fractal-dimension", "2.2", "--rms-height", "50 nm", "--seed", "7"];
  execFileSync(program, ["surface", path.join(scratch, "map.gwy"), ...size], { stdio: "pipe" });
  const height = (x, y) => 40 * Math.sin(0.7 * x) * Math.cos(0.4 * y) + 13 * Math.sin(1.9 * x + 0.8 * y);
  fs.writeFileSync(path.join(scratch, "map.sur"), sur([80, 60], height));
  const rows = Array.from({ length: 48 }, (_, y) => Array.from({ length: 64 }, (_, x) => height(x, y).toFixed(4)).join(","));
  fs.writeFileSync(path.join(scratch, "map.csv"), rows.join("\n"));
};
test("numbers are those of the program", async () => {
  ownMaps();
  for (const boundary of ["free", "periodic"]) {
    for (const [name, keys] of MAPS) {
      const file = name.startsWith("measured") ? path.join(data, name) : path.join(scratch, name);
      const given = new URLSearchParams([["scene.models", "bem3d"], ["scene.surface.kind", "file"], ["scene.contact_modulus", "100 GPa"], ["scene.mean_pressure", "3 MPa, 30 MPa"],
        ["scene.surface.detrend", "plane"], ["effects.boundary", boundary], ["models.bem3d.tolerance", "1e-9"], ...(boundary === "periodic" ? [["scene.surface.undefined", ""]] : []), ...keys]);
      if (boundary === "periodic" && given.get("scene.surface.undefined")) { given.delete("scene.surface.undefined"); given.set("scene.surface.fill", "neighbours"); }
      const page = await opened(`${served}#${given}`);
      await page.setInputFiles("#ui-file", file);
      await compare(page, file, boundary);
      await page.context().close();
    }
  }
  largest.sort(([a], [b]) => b - a);
  const areas = largest.filter(([, what]) => what.endsWith(": area"));
  [...largest.slice(0, 6), areas[0]].forEach(([difference, what]) => console.log(`  ${difference.toExponential(1)}  ${what}`));
});

test("nothing is requested but the page's own files", async () => {
  const page = await opened(served);
  await example(page);
  await solved(page);
  assert(page.requests.every((url) => url.startsWith(served) || /^(blob|data):/.test(url)), page.requests.join("\n"));
  const refused = await page.evaluate(() => fetch("http://127.0.0.1:9/").then(() => "fetched", () => "refused"));
  assert.equal(refused, "refused");
  const violated = await page.evaluate(() => new Promise((done) => {
    addEventListener("securitypolicyviolation", (event) => done(event.violatedDirective));
    fetch("https://example.invalid/").catch(() => {});
  }));
  assert.equal(violated, "connect-src");
  await page.context().close();
});

test("the page works without a network after it was loaded once", async () => {
  const page = await opened(served);
  await page.waitForFunction(() => navigator.serviceWorker.controller, null, { timeout: 30_000 });
  await page.context().setOffline(true);
  await page.reload();
  await page.waitForFunction(() => document.documentElement.dataset.ready === "true");
  await example(page);
  await solved(page);
  await page.context().close();
});

test("one file opens from a folder", async () => {
  const page = await opened(pathToFileURL(path.join(dist, "fractal-contact.html")).href);
  // Its policy knows its own scripts, and no other.
  assert.equal(await page.evaluate(() => {
    document.head.append(Object.assign(document.createElement("script"), { textContent: "window.foreign = true" }));
    return window.foreign;
  }), undefined);
  await example(page);
  await solved(page);
  assert(page.requests.every((url) => /^(file|blob|data):/.test(url)), page.requests.join("\n"));
  assert.equal(await page.evaluate(() => fetch("http://127.0.0.1:9/").then(() => "fetched", () => "refused")), "refused");
  await page.context().close();
});

test("a solve is stopped, and states that were solved stay", async () => {
  const given = new URLSearchParams([["scene.models", "bem3d"], ["scene.surface.kind", "self_affine"], ["scene.surface.side", "100 um"], ["scene.surface.hurst", "0.8"], ["scene.surface.rms_height", "100 nm"], ["sampling.seed", "1"],
    ["models.bem3d.cells", "512"], ["models.bem3d.tolerance", "1e-10"], ["scene.contact_modulus", "100 GPa"], ["scene.mean_pressure", "10 kPa, 100 MPa, 200 MPa, 300 MPa, 400 MPa"], ["outputs.grid_error", "false"]]);
  const page = await opened(`${served}#${given}`);
  await settled(page);
  await page.click("#ui-solve");
  await page.waitForSelector("#ui-states > div", { timeout: 120_000 });
  await page.click("#ui-stop");
  await told(page, "^Stopped");
  const count = await page.locator("#ui-states > div").count();
  assert(count >= 1 && count < 5, `${count} states`);
  assert(await page.locator("#ui-states table").first().isVisible());
  await put(page, "scene.mean_pressure", "10 kPa");
  await put(page, "models.bem3d.cells", "64");
  await solved(page);
  await page.context().close();
});

test("what is too large for a browser is offered coarser", async () => {
  const given = new URLSearchParams([["scene.models", "bem3d"], ["scene.surface.kind", "self_affine"], ["scene.surface.side", "100 um"], ["scene.surface.hurst", "0.8"], ["scene.surface.rms_height", "100 nm"],
    ["sampling.seed", "1"], ["models.bem3d.cells", "8192"], ["scene.contact_modulus", "100 GPa"], ["scene.mean_pressure", "100 MPa"]]);
  const page = await opened(`${served}#${given}`);
  await told(page, "too large");
  assert.match(await page.textContent("#ui-mistake"), /8192 x 8192 cells need/);
  await page.click("#ui-mistake button");
  assert(Number(await page.inputValue('[id="ui-key-models.bem3d.cells"]')) > 1000);
  await page.context().close();
});

test("friction is asked by a path", async () => {
  const page = await opened(served);
  await example(page);
  await settled(page);
  await put(page, "effects.friction", "0.3");
  await page.waitForSelector("#ui-mistake:not([hidden])");
  await page.click("#ui-path button");
  await page.click("#ui-path button:nth-of-type(1)");
  await put(page, "scene.path.0.mean_pressure", "20 MPa");
  await put(page, "scene.path.1.tangential_force", "50 mN");
  await solved(page);
  assert.match(await page.textContent("#ui-report"), /stick/);
  await page.context().close();
});

test("a profile is solved as a line contact", async () => {
  const page = await opened(served);
  await page.setInputFiles("#ui-file", path.join(data, "scenes/stylus-line.txt"));
  await settled(page);
  await put(page, "effects.boundary", "periodic");
  await compare(page, path.join(data, "scenes/stylus-line.txt"), "periodic");
  await page.context().close();
});

test("hostile files give a message, and the page lives on", async () => {
  const page = await opened(served);
  const files = JSON.parse(execFileSync("python3", [path.join(data, "../.ci/fuzz"), "--files", "100", "--seed", "1", "--into", path.join(scratch, "hostile")], { maxBuffer: 1 << 28 }));
  for (const name of files) {
    await page.setInputFiles("#ui-file", path.join(scratch, "hostile", name));
    await page.waitForFunction(() => !/being read/.test(document.querySelector("#ui-status").textContent), null, { timeout: 60_000 });
    assert((await status(page)).length > 0, name);
  }
  await example(page);
  await solved(page);
  await page.context().close();
});

test("markup in a channel's name is text", async () => {
  const page = await opened(served);
  const name = "<img src=x onerror=window.broken=1>";
  const file = path.join(scratch, "markup.txt");
  fs.writeFileSync(file, `# Channel: ${name}\n# Width: 3 um\n# Height: 2 um\n# Value units: nm\n1 2 3\n4 5 7\n`);
  await page.setInputFiles("#ui-file", file);
  await settled(page);
  assert((await page.textContent("#ui-surface")).includes("<img src=x"));
  await solved(page);
  assert.equal(await page.evaluate(() => window.broken), undefined);
  await page.context().close();
});

test("the question is in the address, and no data", async () => {
  const page = await opened(served);
  await example(page);
  await put(page, "effects.hardness", "2 GPa");
  await settled(page);
  const address = page.url();
  assert(address.includes("effects.hardness=2+GPa") && address.includes("example=optical.x3p"), address);
  const other = await opened(address);
  await settled(other);
  assert.equal(await other.inputValue('[id="ui-key-effects.hardness"]'), "2 GPa");
  await page.context().close();
  await other.context().close();
});

test("mistakes are told at their keys", async () => {
  const page = await opened(served);
  await example(page);
  await put(page, "scene.bodies", "210 GPa");
  await page.waitForSelector("#ui-mistake:not([hidden])");
  assert(await page.locator('.key.wrong [id="ui-key-scene.bodies"]').count() === 1);
  assert(await page.locator("#ui-solve").isDisabled());
  await put(page, "scene.bodies", "rigid, 210 GPa 0.3");
  await solved(page);
  await page.context().close();
});

test("the keyboard alone solves, and every control has a name", async () => {
  const page = await opened(served);
  const nameless = await page.evaluate(() => [...document.querySelectorAll("input,select,button,summary")].filter((control) => {
    const label = control.labels?.[0]?.textContent || control.getAttribute("aria-label") || control.textContent;
    return !label.trim();
  }).map((control) => control.outerHTML));
  assert.deepEqual(nameless, []);
  await page.focus("#ui-examples button:nth-of-type(2)");
  await page.keyboard.press("Enter");
  await settled(page);
  for (let i = 0; i < 200 && (await page.evaluate(() => document.activeElement.id)) !== "ui-solve"; i++) await page.keyboard.press("Tab");
  await page.keyboard.press("Enter");
  await told(page, "^Solved");
  const canvas = page.locator("#ui-report canvas").first();
  await canvas.focus();
  await page.keyboard.press("ArrowRight");
  assert.match(await page.locator("#ui-report figure.field:has(canvas) output").first().textContent(), /at column/);
  await page.context().close();
});

test("a slider goes through the loads", async () => {
  const page = await opened(served);
  await example(page);
  await solved(page);
  const slider = page.locator("#ui-report .states input");
  await slider.focus();
  await page.keyboard.press("ArrowRight");
  assert.equal(await page.locator("#ui-report div.fields[data-state]:visible").count(), 1);
  await page.context().close();
});

if (shots) test("pictures of the page", async () => {
  fs.mkdirSync(shots, { recursive: true });
  for (const colorScheme of ["light", "dark"]) {
    for (const width of [400, 1280, 1920]) {
      const page = await opened(served, { viewport: { width, height: 900 }, colorScheme });
      await page.screenshot({ path: path.join(shots, `${width}-${colorScheme}-begin.png`) });
      await example(page);
      await solved(page);
      assert(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `${width}: the page is wider than its window`);
      await page.screenshot({ path: path.join(shots, `${width}-${colorScheme}.png`), fullPage: true });
      await page.context().close();
    }
  }
});

test("size, and time until the page answers", async () => {
  const { gzipSync } = await import("node:zlib");
  const packed = gzipSync(fs.readFileSync(path.join(dist, "fractal_contact_bg.wasm"))).length;
  assert(packed < 3e6, `${packed} bytes of WebAssembly, packed`);
  const begun = Date.now();
  const page = await opened(served);
  const ready = Date.now() - begun;
  const paint = await page.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0]?.startTime);
  console.log(`  WebAssembly ${(packed / 1e6).toFixed(2)} MB packed; first paint after ${paint?.toFixed(0)} ms, ready after ${ready} ms`);
  await page.context().close();
});

if (option("--times")) test("seconds beside the program on one thread", async () => {
  console.log("  cells      page   program   ratio");
  for (const cells of [256, 512, 1024]) {
    const given = new URLSearchParams([["scene.models", "bem3d"], ["scene.surface.kind", "self_affine"], ["scene.surface.side", "100 um"], ["scene.surface.hurst", "0.8"], ["scene.surface.rms_height", "100 nm"], ["sampling.seed", "1"],
      ["models.bem3d.cells", String(cells)], ["scene.contact_modulus", "100 GPa"], ["scene.mean_pressure", "100 MPa, 300 MPa"], ["outputs.grid_error", "false"]]);
    const page = await opened(`${served}#${given}`);
    await solved(page);
    const here = Number(/Solved in ([\d.e+]+) s/.exec(await status(page))[1]);
    const folder = fs.mkdtempSync(path.join(scratch, "time-"));
    fs.writeFileSync(path.join(folder, "scene.toml"), await downloaded(page, "scene.toml"));
    const begun = process.hrtime.bigint();
    execFileSync(program, ["run", "scene.toml", "--out", "out", "--threads", "1"], { cwd: folder, stdio: "pipe" });
    const there = Number(process.hrtime.bigint() - begun) / 1e9;
    console.log(`  ${String(cells).padEnd(6)} ${here.toFixed(2).padStart(7)} s ${there.toFixed(2).padStart(7)} s   ${(here / there).toFixed(2)}`);
    await page.context().close();
  }
});

// ---- The run ------------------------------------------------------------------------------------------------------------------------------

let failed = 0;
const only = option("--only");
for (const [name, does] of tests.filter(([name]) => !only || name.includes(only))) {
  errors.length = 0;
  const begun = Date.now();
  try {
    await does();
    assert.deepEqual(errors, []);
    console.log(`ok      ${name} (${((Date.now() - begun) / 1000).toFixed(1)} s)`);
  } catch (error) {
    failed += 1;
    console.log(`FAILED  ${name}: ${error.stack}`);
  }
}
await browser.close();
server.close();
fs.rmSync(scratch, { recursive: true, force: true });
console.log(failed ? `${failed} failed` : "all passed");
process.exit(failed ? 1 : 0);
