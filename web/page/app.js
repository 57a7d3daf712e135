"use strict";
// The page: a form made from the table of keys, a worker that solves, and its results. The state of the form is a list of keys of a scene
// with their texts, which is also the fragment of the address.
const $ = (id) => document.getElementById(id);
const element = (name, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
};

// ---- The solver in its worker -------------------------------------------------------------------------------------------------------------

const decode = (text) => Uint8Array.from(atob(text.trim()), (c) => c.charCodeAt(0));
// A page of one file has the program and the worker in itself; a page that is served has them beside it.
const inside = (id) => $(id)?.textContent;
const module = (async () => {
  const bytes = inside("ui-wasm");
  if (bytes) return WebAssembly.compile(decode(bytes));
  const response = await fetch("fractal_contact_bg.wasm");
  if (!response.ok) throw new Error(`the program is not there: ${response.status}`);
  return WebAssembly.compile(await response.arrayBuffer());
})();

const solver = {
  worker: null,
  waiting: new Map(),
  last: 0,
  form: null,
  told: () => {},

  async start() {
    const source = inside("ui-worker");
    const address = source ? URL.createObjectURL(new Blob([source], { type: "text/javascript" })) : "worker.js";
    this.worker = new Worker(address);
    this.worker.addEventListener("message", ({ data }) => this.receive(data));
    this.worker.addEventListener("error", (event) => this.fail(event.message || "the solver could not be started"));
    this.form = await this.ask("begin", await module);
    if (file) await this.ask("open", file.name, file.bytes);
  },
  ask(ask, ...given) {
    const id = (this.last += 1);
    return new Promise((answer, failed) => {
      this.waiting.set(id, { answer, failed });
      this.worker.postMessage({ id, ask, given });
    });
  },
  receive({ id, answer, failed, told, value }) {
    if (told === "panic") this.panic = value;
    if (told) return this.told(told, value);
    const waiting = this.waiting.get(id);
    this.waiting.delete(id);
    if (!waiting) return;
    if (failed === undefined) return waiting.answer(answer);
    // WebAssembly that was interrupted by a panic is not used again.
    waiting.failed(new Error(this.panic ? `this is a defect of the program, and a new solver was begun. It says: ${this.panic}` : failed));
    if (this.panic || failed.includes("RuntimeError") || failed.includes("RangeError")) this.restart("the solver ended");
  },
  fail(message) {
    for (const { failed } of this.waiting.values()) failed(new Error(message));
    this.waiting.clear();
  },
  restart(message) {
    this.worker.terminate();
    this.panic = null;
    this.fail(message);
    return this.start();
  },
};

// ---- What is asked ------------------------------------------------------------------------------------------------------------------------

let file = null; // { name, bytes }
const values = new Map(); // The texts of the keys, as "scene.bodies".
const rows = new Map(); // The row of each key in the form.
const needed = new Set(); // Keys that the open file needs, because it does not say the same itself.
const LOADS = ["mean_pressure", "force", "force_bar", "approach", "mean_gap"];
const ABOUT_LOADS = (key) => key.table === "scene" && LOADS.includes(key.name);
// Steel on steel under three pressures, as in the first command of the README.
const BEGIN = [["scene.models", "bem3d"], ["scene.surface.kind", "file"], ["scene.surface.detrend", "plane"], ["scene.bodies", "210 GPa 0.3, 210 GPa 0.3"],
  ["scene.mean_pressure", "2 MPa, 5 MPa, 20 MPa"], ["effects.boundary", "free"]];
const RANDOM = [["scene.surface.side", "100 um"], ["scene.surface.hurst", "0.8"], ["scene.surface.rms_height", "100 nm"],
  ["scene.surface.roll_off_wavelength", "25 um"], ["models.bem3d.cells", "256"], ["sampling.seed", "1"]];

const isFile = () => values.get("scene.surface.kind") === "file";
const kind = () => (isFile() ? 'kind = "file"' : 'kind = "self_affine"');
const hasPath = () => [...values.keys()].some((key) => key.startsWith("scene.path."));
// Keys of the other kind of surface are kept in the form, so that one can go back, and are not asked.
const asked = () => {
  const known = new Set(solver.form.keys.filter((key) => key.table === "scene.surface" && key.kind === kind()).map((key) => `scene.surface.${key.name}`));
  const model = values.get("scene.models");
  return [...values].filter(([key, text]) => {
    if (!text.trim() || key === "example" || key === "scene.surface.path") return false;
    if (key.startsWith("scene.surface.")) return known.has(key);
    if (key.startsWith("models.")) return key.startsWith(`models.${model}.`) && !(isFile() && /\.(cells|rows)$/.test(key));
    if (hasPath() && LOADS.some((load) => key === `scene.${load}`)) return false;
    return true;
  });
};
const fragment = () => {
  history.replaceState(null, "", `#${new URLSearchParams([...values].filter(([, text]) => text.trim()))}`);
};

const set = (key, text) => {
  suited.delete(key);
  if ((values.get(key) || "") === text) return;
  if (text.trim()) values.set(key, text);
  else values.delete(key);
  fragment();
  changed(key);
};

// ---- The form -----------------------------------------------------------------------------------------------------------------------------

// Markdown of the book without formulas and links.
const unlinked = (text) => text.replace(/\$`([^`]*)`\$/g, "$1").replace(/\[([^\]]*)\]\([^)]*\)/g, "$1");
// The same as text with code.
const marked = (text) => {
  return unlinked(text).split("`").map((part, i) => (i % 2 ? element("code", { textContent: part }) : part));
};
// The words that a key takes, where it takes nothing else.
const words = (takes) => {
  const codes = [...takes.matchAll(/`([^`]*)`/g)].map((match) => match[1].replace(/^"|"$/g, ""));
  const rest = takes.replace(/`[^`]*`/g, "").replace(/\bor\b|[,\s]/g, "");
  return codes.length > 1 && !rest ? codes : null;
};
// The name of a key, as "scene.hardness" or without its table, in words.
const SAID = { "scene.hardness": "hardness, for a note alone", force_bar: "dimensionless force", models: "model" };
const said = (path) => {
  const name = path.split(".").at(-1);
  return SAID[path] || SAID[name] || name.replaceAll("_", " ");
};

const control = (path, takes, fallback, label) => {
  const options = words(takes);
  let input;
  if (options) {
    const none = element("option", { value: "", textContent: fallback ? `not given: ${fallback.replaceAll("`", "").replaceAll('"', "")}` : "not given" });
    input = element("select", {}, none, ...options.map((word) => element("option", { value: word, textContent: said(word) })));
  } else {
    input = element("input", { type: "text", spellcheck: false, placeholder: plain(fallback) });
  }
  input.value = values.get(path) || "";
  input.id = `ui-key-${path}`;
  if (label) input.setAttribute("aria-label", label);
  input.addEventListener("change", () => set(path, input.value));
  return input;
};
const plain = (text) => unlinked(text).replaceAll("`", "");

// The row of a key, or of several of which one is given.
const row = (keys, path) => {
  const about = element("p", { className: "about" });
  const made = element("div", { className: "key" });
  const show = (key) => {
    const sentence = `${key.about.replace(/\.$/, "")}.`;
    // What a list of words offers is seen.
    about.replaceChildren(...marked(sentence[0].toUpperCase() + sentence.slice(1)), ...(key.takes && !words(key.takes) ? [" Takes: ", ...marked(key.takes), "."] : []));
  };
  if (keys.length === 1) {
    const [key] = keys;
    const input = control(path(key), key.takes, key.default || "");
    made.append(element("label", { htmlFor: input.id, textContent: said(path(key)) }), input);
    show(key);
  } else {
    const name = keys.some((key) => LOADS.includes(key.name)) ? "load" : keys.some((key) => key.name === "bodies") ? "material" : keys.map((key) => said(path(key))).join(" or ");
    const chosen = () => keys.find((key) => values.has(path(key))) || keys[0];
    const pair = element("div", { className: "pair" });
    const select = element("select", { id: `ui-which-${path(keys[0])}` }, ...keys.map((key) => element("option", { value: key.name, textContent: said(path(key)) })));
    select.setAttribute("aria-label", `which of ${name}`);
    const input = (key) => control(path(key), key.takes, key.default || "", said(path(key)));
    select.value = chosen().name;
    pair.append(select, input(chosen()));
    select.addEventListener("change", () => {
      const key = keys.find((one) => one.name === select.value);
      keys.forEach((one) => suited.delete(path(one)));
      keys.filter((one) => one !== key).forEach((one) => values.delete(path(one)));
      pair.replaceChildren(select, input(key));
      show(key);
      fragment();
      changed(path(key));
    });
    made.append(element("div", { className: "name", textContent: name }), pair);
    show(chosen());
  }
  made.append(about, element("p", { className: "mistake", hidden: true }));
  keys.forEach((key) => rows.set(path(key), made));
  return made;
};

// Rows of keys; those of which one is given share a row.
const grouped = (keys) => {
  const groups = [];
  for (const key of keys) {
    const group = groups.find((of) => of.some((other) => other.insteadOf.includes(key.name) || key.insteadOf.includes(other.name)));
    if (group) group.push(key);
    else groups.push([key]);
  }
  return groups;
};
const fill = (container, keys, path, more) => {
  const groups = grouped(keys);
  const isUsual = (group) => group.some((key) => path(key) === "scene.surface.detrend" || needed.has(path(key)) || values.has(path(key)));
  const [usual, others] = more ? [groups.filter(isUsual), groups.filter((group) => !isUsual(group))] : [groups, []];
  container.replaceChildren(...usual.map((group) => row(group, path)));
  if (others.length) container.append(element("details", {}, element("summary", { textContent: more }), ...others.map((group) => row(group, path))));
};
const within = (key) => `${key.table}.${key.name}`;

const model = () => solver.form.models.find((one) => one.name === values.get("scene.models")) || solver.form.models[0];

const drawEffects = () => {
  const of = model();
  const made = solver.form.effects.map((effect) => {
    const key = { ...effect, table: "effects", default: effect.off, insteadOf: [] };
    const line = row([key], within);
    const can = effect.name === "boundary" || of.effects.includes(effect.name);
    const options = [...line.querySelectorAll("option")].filter((option) => option.value.includes("periodic"));
    if (effect.name === "boundary" && !of.periodic) options.forEach((option) => option.remove());
    if (!can) {
      line.querySelector("input,select").disabled = true;
      line.querySelector(".about").textContent = `The model ${of.name} does not have this effect.`;
    }
    return line;
  });
  $("ui-effect-keys").replaceChildren(...made);
};

const drawPath = () => {
  const container = $("ui-path");
  const keys = solver.form.keys.filter((key) => key.table === "scene.path");
  const count = Math.max(-1, ...[...values.keys()].map((key) => Number(/^scene\.path\.(\d+)\./.exec(key)?.[1] ?? -1))) + 1;
  const steps = [];
  for (let i = 0; i < count; i++) {
    const rowsOfStep = grouped(keys).map((group) => row(group, (key) => `scene.path.${i}.${key.name}`));
    steps.push(element("fieldset", { className: "step" }, element("legend", { textContent: `Step ${i + 1}` }), ...rowsOfStep));
  }
  const add = element("button", { type: "button", textContent: count ? "Add a step" : "Prescribe a path of loads" });
  add.addEventListener("click", () => {
    const load = LOADS.find((name) => values.has(`scene.${name}`) && name !== "force_bar");
    const texts = load ? values.get(`scene.${load}`).split(",").map((text) => text.trim()) : ["1 MPa"];
    // Loads one by one become the steps of the path.
    if (count) values.set(`scene.path.${count}.states`, "8");
    else texts.forEach((text, i) => values.set(`scene.path.${i}.${load || "mean_pressure"}`, text));
    draw();
    fragment();
    changed("scene.path");
  });
  const drop = element("button", { type: "button", textContent: "Remove the path" });
  drop.addEventListener("click", () => {
    [...values.keys()].filter((key) => key.startsWith("scene.path.")).forEach((key) => values.delete(key));
    draw();
    fragment();
    changed("scene.path");
  });
  const why = element("p", { className: "faint", textContent: "Friction with a tangential force, loading and unloading, and time need a path: the ends of straight pieces, in their order." });
  container.replaceChildren(...steps, add, " ", ...(count ? [drop] : [why]));
};

// All of the form from the values.
const draw = () => {
  rows.clear();
  const { keys, models } = solver.form;
  const surface = (of) => keys.filter((key) => key.table === "scene.surface" && key.kind === `kind = "${of}"` && !["kind", "path"].includes(key.name));
  document.querySelectorAll("input[name=kind]").forEach((input) => { input.checked = input.value === values.get("scene.surface.kind"); });
  $("ui-of-file").hidden = !isFile();
  $("ui-of-random").hidden = isFile();
  fill($("ui-file-keys"), isFile() ? surface("file") : [], within, "More about the file and its preprocessing");
  const random = [...surface("self_affine"), ...keys.filter((key) => within(key) === "models.bem3d.cells" || key.table === "sampling")];
  fill($("ui-random-keys"), isFile() ? [] : random, within, "");
  const scene = keys.filter((key) => key.table === "scene" && !["units", "models"].includes(key.name));
  const [usual, others] = [scene.filter((key) => ["contact_modulus", "bodies"].includes(key.name) || (ABOUT_LOADS(key) && !hasPath())), scene.filter((key) => !["contact_modulus", "bodies"].includes(key.name) && !ABOUT_LOADS(key))];
  fill($("ui-scene-keys"), usual.map((key) => ({ ...key, insteadOf: key.insteadOf.filter((name) => !["hardness", "accuracy"].includes(name)) })), within, "");
  drawPath();
  drawEffects();
  const takes = models.map((one) => `\`${one.name}\``).join(" or ");
  const first = row([{ table: "scene", name: "models", takes, about: "the model: bem3d solves every cell of the map; the others are reductions and theories", default: "", insteadOf: [] }], within);
  const numerics = keys.filter((key) => key.table === `models.${model().name}` && !(isFile() && ["cells", "rows"].includes(key.name)) && within(key) !== "models.bem3d.cells");
  const outputs = solver.form.outputs.filter((output) => model().outputs.includes(output.name)).map((output) => ({
    table: "outputs", name: output.name, default: "", insteadOf: [], about: output.about || "",
    takes: output.name === "conductance" ? '`{ kind = "electrical", resistivities }` or `{ kind = "thermal", conductivities }`' : output.field ? "`[\"npy\", \"png\"]`, or formats" : "`true` or `false`",
  }));
  const body = keys.filter((key) => key.table === "scene.body");
  const container = $("ui-more-keys");
  fill(container, [...others, ...numerics, ...outputs, ...keys.filter((key) => key.table === "outputs")], within, "");
  container.prepend(first);
  container.append(element("details", {}, element("summary", { textContent: "A smooth body below the roughness" }), ...grouped(body).map((group) => row(group, within))));
};

// ---- Answers ------------------------------------------------------------------------------------------------------------------------------

const cut = (text, most = 60) => (text.length > most ? `${text.slice(0, most)}…` : text);
const tell = (text) => { $("ui-status").textContent = text; };
const showMistake = (mistake) => {
  document.querySelectorAll(".key.wrong").forEach((line) => line.classList.remove("wrong"));
  document.querySelectorAll(".key .mistake").forEach((line) => { line.hidden = true; });
  const box = $("ui-mistake");
  box.hidden = !mistake;
  if (!mistake) return;
  const { key } = mistake;
  const [message, help] = [mistake.message, mistake.help && !/\[\[scene\.path\]\]/.test(mistake.help) ? mistake.help : mistake.help && "press “Prescribe a path of loads”, and give a tangential force in its second step"].map((text) => text && cut(text, 600));
  box.replaceChildren(element("strong", { textContent: key ? said(key) : "This cannot be answered yet" }),
    element("pre", { textContent: message }), ...(help ? [element("p", {}, ...marked(`${help}.`))] : []));
  if (key && !rows.has(key)) {
    const remove = element("button", { type: "button", textContent: `Remove ${cut(key)}` });
    remove.addEventListener("click", () => { values.delete(key); fragment(); changed(key); });
    box.append(remove);
  }
  const line = rows.get(key);
  if (!line) return;
  line.closest("details")?.setAttribute("open", "");
  line.classList.add("wrong");
  const place = line.querySelector(".mistake");
  place.hidden = false;
  place.textContent = message;
};

// A part of a report: its fields become readable, and links within it do not replace the fragment.
const showPage = (container, html) => {
  container.innerHTML = html;
  showFields(container);
  showStates(container);
  container.querySelectorAll("a[href^='#']").forEach((link) => link.addEventListener("click", (event) => {
    event.preventDefault();
    container.querySelector(`[id="${CSS.escape(link.hash.slice(1))}"]`)?.scrollIntoView();
  }));
};

const showSurface = ({ channels, missing = [], page, error, mistake }) => {
  document.querySelectorAll(".key.missing").forEach((line) => line.classList.remove("missing"));
  const of = isFile() ? channels?.channels || [] : [];
  // Channels of one name, such as both directions of a scan, are told apart by those of their details that differ.
  const details = (channel) => (channel.details || "").split(", ");
  const differing = (channel) => {
    const others = of.filter((other) => other !== channel && other.name === channel.name);
    return details(channel).filter((part) => others.some((other) => !details(other).includes(part)));
  };
  const option = (channel, i) => {
    const text = [`${i}: ${channel.name || "without a name"}`, ...differing(channel), ...(channel.heights === false ? ["no heights"] : []), `${channel.columns} x ${channel.rows}`];
    return element("option", { value: String(i), textContent: text.join(", "), disabled: channel.heights === false });
  };
  const choice = [];
  if (of.length > 1) {
    const select = element("select", { id: "ui-channel" }, element("option", { value: "", textContent: "choose one" }), ...of.map(option));
    select.value = values.get("scene.surface.channel") || "";
    select.addEventListener("change", () => set("scene.surface.channel", select.value));
    choice.push(element("div", { className: "key" }, element("label", { htmlFor: select.id, textContent: "channel" }), select));
  }
  $("ui-channels").replaceChildren(...choice);
  rows.get("scene.surface.channel")?.toggleAttribute("hidden", choice.length > 0);
  const more = missing.flatMap(({ key, instead }) => [key, ...(instead ? [instead[0]] : [])]).map((key) => `scene.surface.${key}`);
  if (more.some((key) => !needed.has(key))) {
    more.forEach((key) => needed.add(key));
    draw();
  }
  for (const { key, example, why, instead } of missing) {
    const line = rows.get(`scene.surface.${key}`);
    if (!line) continue;
    line.closest("details")?.setAttribute("open", "");
    line.classList.add("missing");
    const place = line.querySelector(".mistake");
    place.hidden = false;
    place.textContent = `${why}, such as ${example}${instead ? `; or ${said(instead[0])}: ${instead[1]}` : ""}`;
  }
  const shown = $("ui-surface");
  shown.hidden = !page && !error;
  if (!page) shown.open = true;
  const container = shown.querySelector("div");
  if (page) showPage(container, page);
  else container.replaceChildren(element("p", { className: "verdict warned", textContent: error || "" }));
  return missing.length === 0 && Boolean(page) && !mistake;
};

let turn = 0;
let solving = false;
let stopping = false;
let waiting = null;
let reading = null; // The question that the solver is reading.
let ready = false; // Whether the question that was read can be solved.
let surfaceIsOld = true;
let solvedKeys = null; // What the results that are shown answer.
const changed = (key) => {
  if (key === "scene.models" || key === "scene.surface.kind") draw();
  surfaceIsOld ||= /^scene\.surface\.|^example$|^sampling|cells$/.test(key);
  clearTimeout(waiting);
  waiting = setTimeout(() => { waiting = null; refresh(false); }, 250);
  showAge();
};
// Results of another question say so.
const question = () => `${isFile() ? file?.name : ""} ${JSON.stringify(asked())}`;
const showAge = () => {
  const old = solvedKeys !== null && solvedKeys !== question();
  $("ui-old").hidden = !old;
  $("ui-report").classList.toggle("old", old);
};

// Memory of WebAssembly is 4 GiB; what is already held needs room too.
const MOST_MEMORY = 3.2e9;
const tooLarge = (memory, grids) => {
  const cells = /(\d+) x (\d+)/.exec(grids.join(" "));
  const [columns, rowsOf] = cells ? [Number(cells[1]), Number(cells[2])] : [0, 0];
  const fits = Math.floor(columns * Math.sqrt((0.7 * MOST_MEMORY) / memory));
  const coarser = element("button", { type: "button", textContent: `Average it over larger cells: ${fits} columns` });
  const crop = element("button", { type: "button", textContent: `Cut out ${fits} x ${Math.min(fits, rowsOf)} cells of its middle` });
  coarser.addEventListener("click", () => { values.set(isFile() ? "scene.surface.cells" : "models.bem3d.cells", String(fits)); values.set("outputs.grid_error", "true"); draw(); changed("scene.surface.cells"); });
  crop.addEventListener("click", () => {
    const height = Math.min(fits, rowsOf);
    values.set("scene.surface.crop", `${Math.floor((rowsOf - height) / 2)},${Math.floor((columns - fits) / 2)},${height},${fits}`);
    draw();
    changed("scene.surface.crop");
  });
  const box = $("ui-mistake");
  box.hidden = false;
  box.replaceChildren(element("strong", { textContent: "Too large for a browser" }),
    element("p", { textContent: `The ${columns} x ${rowsOf} cells need ${(memory / 1e9).toPrecision(2)} GB, and a page has 4 GB. The program on your machine solves the map as it is. Here, larger cells cost accuracy, which the error of the grid in the results then tells; a part of the map is as accurate, and is a smaller sample.` }),
    coarser, " ", ...(isFile() ? [crop] : []));
};

// Reads the question, and the surface where it is another one. Of several that come while one is read, the last is read next.
const refresh = async (surfaceToo) => {
  turn += 1;
  surfaceIsOld ||= surfaceToo;
  if (reading) {
    // The loop below reads again.
    while (reading) await reading;
    return;
  }
  while (!solving && solver.form) {
    const mine = turn;
    ready = false;
    reading = readQuestion(mine, surfaceIsOld);
    surfaceIsOld = false;
    await reading;
    reading = null;
    $("ui-solve").disabled = !ready;
    if (mine === turn) break;
  }
};
const readQuestion = async (mine, surfaceToo) => {
  showAge();
  if (isFile() && !file) {
    showMistake(null);
    const name = values.get("scene.surface.path");
    return tell(name ? `This link asks of ${name}: drop that file, or another one.` : "Drop a file, or choose an example.");
  }
  tell("The question is being read.");
  const keys = JSON.stringify(asked());
  try {
    // A random surface that is too large is not drawn.
    if (surfaceToo && !isFile()) {
      const plan = await solver.ask("plan", keys);
      if (mine !== turn) return;
      if (plan.memory > MOST_MEMORY) {
        showMistake(null);
        tooLarge(plan.memory, plan.grids);
        return tell("This surface is too large for a browser.");
      }
    }
    if (surfaceToo) {
      const surface = await solver.ask("surface", keys);
      if (mine !== turn) return;
      const unread = surface.error && !surface.missing.length ? { message: surface.error } : null;
      showMistake(surface.mistake || unread);
      if (!showSurface(surface)) return tell(surface.mistake ? "The surface is not understood yet." : surface.missing.length ? "The file does not say everything: see the marked lines." : "This file gives no map yet.");
    }
    const plan = await solver.ask("plan", keys);
    if (mine !== turn) return;
    showMistake(plan.mistake || null);
    $("ui-plan").hidden = Boolean(plan.mistake);
    if (plan.mistake) return tell("The question is not complete yet.");
    $("ui-plan").querySelector("pre").textContent = plan.plan;
    if (plan.memory > MOST_MEMORY) {
      tooLarge(plan.memory, plan.grids);
      return tell("This map is too large for a browser.");
    }
    ready = true;
    tell(`Ready: ${plan.grids.join("; ")}.`);
  } catch (error) {
    if (mine === turn) tell(`The question cannot be read: ${error.message}`);
  }
};

// ---- Solving ------------------------------------------------------------------------------------------------------------------------------

let addresses = [];
const offer = (files, scene) => {
  addresses.forEach((address) => URL.revokeObjectURL(address));
  const types = { csv: "text/csv", html: "text/html", png: "image/png", svg: "image/svg+xml", toml: "text/plain" };
  const all = [...files, ["scene.toml", new TextEncoder().encode(scene)]];
  const order = (name) => ["report.html", "results.csv", "scene.toml"].indexOf(name) >>> 0;
  all.sort(([a], [b]) => order(a) - order(b) || a.localeCompare(b));
  const links = all.map(([name, bytes]) => {
    const address = URL.createObjectURL(new Blob([bytes], { type: types[name.split(".").at(-1)] || "application/octet-stream" }));
    addresses.push(address);
    return element("li", {}, element("a", { href: address, download: name, textContent: name }));
  });
  $("ui-downloads").hidden = false;
  const [first, others] = $("ui-downloads").querySelectorAll("ul");
  first.replaceChildren(...links.slice(0, 3));
  others.replaceChildren(...links.slice(3));
};

const solve = async () => {
  if (solving || stopping) return;
  // What was typed last is read before it is solved.
  if (waiting) {
    clearTimeout(waiting);
    waiting = null;
    await refresh(false);
  }
  while (reading) await reading;
  if (solving || !ready) return;
  solving = true;
  tell("The solve begins.");
  const answered = question();
  const states = $("ui-states");
  states.replaceChildren(states.firstElementChild);
  states.hidden = true;
  $("ui-report").replaceChildren();
  $("ui-downloads").hidden = true;
  $("ui-solve").disabled = true;
  $("ui-stop").hidden = false;
  $("ui-progress").hidden = false;
  $("ui-progress").value = 0;
  showMistake(null);
  const begun = performance.now();
  solver.told = (what, value) => {
    if (what === "state") {
      states.hidden = false;
      const place = element("div");
      states.append(place);
      showPage(place, value);
    } else if (what === "progress" && value.words) {
      // Without a value the bar says that something is under way whose share is not known.
      if (value.share === null) $("ui-progress").removeAttribute("value");
      else $("ui-progress").value = value.share;
      tell(`${value.words[0].toUpperCase()}${value.words.slice(1)}.`);
    }
  };
  try {
    const outcome = await solver.ask("solve", JSON.stringify(asked()));
    if (outcome.mistake) {
      showMistake(outcome.mistake);
      tell("This was not solved.");
    } else {
      showPage($("ui-report"), outcome.report);
      offer(outcome.files, outcome.scene);
      // The report has all of them.
      states.hidden = true;
      $("ui-surface").open = false;
      solvedKeys = answered;
      showAge();
      const { failed, notes } = outcome;
      const beware = notes.length ? ` ${notes.length === 1 ? "One thing" : `${notes.length} things`} to beware of.` : "";
      tell(`Solved in ${((performance.now() - begun) / 1000).toPrecision(2)} s.${failed ? ` ${failed === 1 ? "One state was" : `${failed} states were`} refused or missed the tolerance.` : ""}${beware}`);
      if ($("ui-results").getBoundingClientRect().top < 0 || matchMedia("(max-width: 60rem)").matches) $("ui-results").scrollIntoView();
    }
  } catch (error) {
    tell(error.message);
  }
  finish();
};
const finish = () => {
  solving = false;
  if (surfaceIsOld) setTimeout(() => refresh(false));
  solver.told = () => {};
  $("ui-stop").hidden = true;
  $("ui-progress").hidden = true;
  $("ui-solve").disabled = stopping || !ready;
};
// Ends the worker: the solver itself is never asked. The next solve begins in a new one.
const stop = async () => {
  if (!solving || stopping) return;
  stopping = true;
  const count = $("ui-states").querySelectorAll(":scope > div").length;
  const kept = count === 0 ? "No state was solved." : count === 1 ? "One state is solved and stays below." : `${count} states are solved and stay below.`;
  await solver.restart(`Stopped. ${kept}`);
  stopping = false;
  $("ui-solve").disabled = !ready;
};

// ---- Beginning ----------------------------------------------------------------------------------------------------------------------------

const OF_ONE_FILE = ["channel", "unit", "lateral_unit", "size", "cell", "height_scale", "format", "missing", "skip_lines", "decimal", "axes", "border", "crop", "cells",
  "rows", "undefined", "fill"];
const open = async (name, bytes, asAddressed = false) => {
  // What was said of another file is not true of this one; what the address says is of the first.
  if (file && file.name !== name) OF_ONE_FILE.forEach((key) => values.delete(`scene.surface.${key}`));
  if (!asAddressed) suit(values.get("example"));
  file = { name, bytes };
  surfaceIsOld = true;
  needed.clear();
  $("ui-file-name").textContent = `${name}, ${bytes.byteLength} bytes`;
  values.set("scene.surface.kind", "file");
  values.set("scene.surface.path", name);
  draw();
  fragment();
  await solver.ask("open", name, bytes);
  await refresh(true);
};
// Maps of the repository, with the keys that they need and bodies and loads that suit them.
const EXAMPLES = [["polished.x3p", "polished steel, generated", [["effects.boundary", "periodic"]]],
  ["optical.x3p", "an optical map with undefined points", [["scene.surface.undefined", "no_contact"]]],
  ["uncd-afm.001", "a diamond film by AFM", [["scene.surface.channel", "0"], ["scene.surface.filter_across", "6 nm"], ["scene.bodies", "900 GPa 0.1, 900 GPa 0.1"],
    ["scene.mean_pressure", "1 GPa, 3 GPa, 10 GPa"]]]];
const exampleKeys = (name) => EXAMPLES.find(([known]) => known === name)?.[2] || [];
const suited = new Set(); // Keys that the page has set, and nobody since.
// Keys that nobody has set become what suits the example, or a file of one's own.
const suit = (name) => {
  const own = exampleKeys(name);
  for (const key of suited) {
    const suits = [...own, ...BEGIN].find(([of]) => of === key)?.[1];
    if (suits) values.set(key, suits);
    else values.delete(key);
  }
  // An absent load or material has another one in its place.
  for (const [key, text] of own) {
    if (values.has(key) || !/^(scene\.surface|effects)\./.test(key)) continue;
    values.set(key, text);
    suited.add(key);
  }
};
const openExample = async (name, asAddressed = false) => {
  if (!EXAMPLES.some(([known]) => known === name)) throw new Error(`there is no example ${cut(name)}: drop a file`);
  const stored = document.querySelector(`[data-example="${CSS.escape(name)}"]`)?.textContent;
  const fetched = stored ? null : await fetch(`examples/${name}`);
  if (fetched && !fetched.ok) throw new Error(`the example ${name} is not there: ${fetched.status}`);
  values.set("example", name);
  await open(name, stored ? decode(stored).buffer : await fetched.arrayBuffer(), asAddressed);
};

// Steps of a path beyond a hundred are for a scene in a file.
const isStep = (key) => !key.startsWith("scene.path.") || /^scene\.path\.\d{1,2}\./.test(key);
const begin = async () => {
  const given = [...new URLSearchParams(location.hash.slice(1))];
  // An address without a question may name an example.
  const isWhole = given.some(([key]) => key !== "example");
  [...(isWhole ? [] : BEGIN), ...given].filter(([key]) => isStep(key)).forEach(([key, text]) => values.set(key, text));
  if (!isWhole) BEGIN.forEach(([key]) => suited.add(key));
  if (!values.has("scene.models")) values.set("scene.models", "bem3d");
  if (!values.has("scene.surface.kind")) values.set("scene.surface.kind", "file");
  await solver.start();
  $("ui-version").textContent = `fractal-contact ${solver.form.version}`;
  draw();
  const single = Boolean(inside("ui-wasm"));
  for (const [name, words] of EXAMPLES) {
    if (single && !document.querySelector(`[data-example="${CSS.escape(name)}"]`)) continue;
    const button = element("button", { type: "button", textContent: words });
    button.addEventListener("click", () => openExample(name).catch((error) => tell(error.message)));
    $("ui-examples").append(button);
  }
  const example = values.get("example");
  if (example) await openExample(example, isWhole).catch((error) => tell(error.message));
  else await refresh(true);
  document.documentElement.dataset.ready = "true";
};

$("ui-form").addEventListener("submit", (event) => { event.preventDefault(); solve(); });
$("ui-stop").addEventListener("click", () => stop());
// Another address is another question.
addEventListener("hashchange", () => location.reload());
document.querySelectorAll("input[name=kind]").forEach((input) => input.addEventListener("change", () => {
  values.set("scene.surface.kind", input.value);
  if (input.value === "self_affine") RANDOM.forEach(([key, text]) => { if (!values.has(key)) values.set(key, text); });
  fragment();
  changed("scene.surface.kind");
}));
const take = async (taken) => {
  if (!taken) return;
  values.delete("example");
  ready = false;
  $("ui-solve").disabled = true;
  tell(`${taken.name} is being read: ${(taken.size / 1e6).toPrecision(2)} MB.`);
  try {
    await open(taken.name, await taken.arrayBuffer());
  } catch (error) {
    tell(`${taken.name}: ${error.message}`);
  }
};
$("ui-file").addEventListener("change", (event) => take(event.target.files[0]));
for (const [name, over] of [["dragover", true], ["dragleave", false], ["drop", false]]) {
  addEventListener(name, (event) => {
    event.preventDefault();
    $("ui-drop").classList.toggle("over", over);
    if (name === "drop") take(event.dataTransfer.files[0]);
  });
}
begin().catch((error) => tell(`The solver could not be started: ${error.message}`));
if ("serviceWorker" in navigator && location.protocol.startsWith("http")) navigator.serviceWorker.register("offline.js");
