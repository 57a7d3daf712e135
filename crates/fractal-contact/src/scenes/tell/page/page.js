"use strict";
// Every field becomes a canvas: a click or the arrow keys read a value, the wheel and + and - zoom. Without scripts its picture stays.
// A page that shows a report in its own frame calls showFields and showStates with the element that holds it.
const bytes = (text) => Uint8Array.from(atob(text.trim()), (c) => c.charCodeAt(0)).buffer;
const palette = new Uint8Array(bytes(document.getElementById("palette").textContent));

const showFields = (root) => root.querySelectorAll("figure.field[data-field]").forEach((figure) => {
  const f = JSON.parse(figure.dataset.field);
  const values = new Float32Array(bytes(figure.querySelector(".values").textContent));
  const places = new Uint8Array(bytes(figure.querySelector(".places").textContent));
  const digits = (v, n) => Number(v.toPrecision(n)).toString();
  const output = figure.querySelector("output");
  const picture = figure.querySelector("img");
  const [length, height] = f.sides;

  // One pixel for each value, the last row on top.
  const source = document.createElement("canvas");
  source.width = f.across;
  source.height = f.down;
  const image = source.getContext("2d").createImageData(f.across, f.down);
  values.forEach((v, i) => {
    const at = 4 * ((f.down - 1 - Math.floor(i / f.across)) * f.across + (i % f.across));
    const shade = 256 * f.palette + (f.high > f.low ? Math.max(0, Math.min(255, Math.floor((256 * (v - f.low)) / (f.high - f.low)))) : 128);
    const colour = !Number.isFinite(v) ? [205, 205, 205] : f.zero && v === 0 ? [255, 255, 255] : palette.subarray(3 * shade, 3 * shade + 3);
    image.data.set(colour, at);
    image.data[at + 3] = 255;
  });
  source.getContext("2d").putImageData(image, 0, 0);

  const canvas = document.createElement("canvas");
  const ratio = Math.min(20, Math.max(0.05, height / length));
  // A whole number of pixels across each value.
  canvas.width = f.across * Math.max(1, Math.round(1024 / f.across));
  canvas.height = Math.max(32, Math.round(canvas.width * ratio));
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", picture.alt + " Arrow keys move a cursor, whose value is read below the map; plus and minus zoom.");
  picture.replaceWith(canvas);
  figure.classList.add("live");

  // Ticks at multiples of 1, 2 or 5 times a power of ten, and the largest such length below a given one.
  const round = (least) => {
    const power = 10 ** Math.floor(Math.log10(least));
    return [1, 2, 5, 10].map((step) => step * power).find((step) => step >= least * (1 - 1e-9));
  };
  const axis = (selector, edge, from, to, most) => {
    const step = round((to - from) / Math.max(2, 6 * most));
    const spans = [];
    for (let i = Math.ceil(from / step - 1e-9); i * step <= to * (1 + 1e-9) && spans.length < 12; i++) {
      const span = document.createElement("span");
      span.style[edge] = `${100 * ((i * step - from) / (to - from))}%`;
      span.textContent = digits(i * step, 12);
      spans.push(span);
    }
    figure.querySelector(selector).replaceChildren(...spans);
  };
  const scaleBar = (to, width) => {
    const bar = round(width / 8);
    const [long, high, edge] = [(bar / width) * canvas.width, 12, 24];
    const text = `${digits(bar, 12)} ${f.length}`.trim();
    to.font = "600 36px system-ui, sans-serif";
    const wide = Math.max(long, to.measureText(text).width);
    const y = canvas.height - edge - 12;
    if (canvas.height < 160) return;
    to.fillStyle = "rgba(255,255,255,.85)";
    to.fillRect(edge - 12, y - 60, wide + 24, 72);
    to.fillStyle = "#1a1a1a";
    to.fillRect(edge, y - high, long, high);
    to.fillText(text, edge, y - high - 10);
  };

  // What is seen, in values from the upper left corner.
  let zoom = 1, left = 0, top = 0, chosen = null;
  const draw = () => {
    const [w, h] = [f.across / zoom, f.down / zoom];
    left = Math.min(Math.max(0, left), f.across - w);
    top = Math.min(Math.max(0, top), f.down - h);
    const to = canvas.getContext("2d");
    to.imageSmoothingEnabled = false;
    to.fillStyle = "#fff";
    to.fillRect(0, 0, canvas.width, canvas.height);
    to.drawImage(source, left, top, w, h, 0, 0, canvas.width, canvas.height);
    const [perColumn, perRow] = [length / f.across, height / f.down];
    axis(".x", "left", left * perColumn, (left + w) * perColumn, Math.min(1, 1 / ratio));
    axis(".y", "bottom", (f.down - top - h) * perRow, (f.down - top) * perRow, Math.min(1, ratio));
    scaleBar(to, w * perColumn);
    if (!chosen) return;
    const [x, y] = [((chosen[0] + 0.5 - left) / w) * canvas.width, ((f.down - chosen[1] - 0.5 - top) / h) * canvas.height];
    for (const [colour, width] of [["#fff", 7], ["#d01c1c", 3]]) {
      to.strokeStyle = colour;
      to.lineWidth = width;
      to.beginPath();
      to.arc(x, y, 14, 0, 2 * Math.PI);
      to.stroke();
    }
  };
  const within = (i, j) => [Math.min(Math.max(0, i), f.across - 1), Math.min(Math.max(0, j), f.down - 1)];
  const read = ([i, j]) => {
    const at = j * f.across + i;
    // Of several cells on a pixel one is shown.
    const column = Math.floor((i * f.columns) / f.across) + (places[2 * at] || 0);
    const row = Math.floor((j * f.rows) / f.down) + (places[2 * at + 1] || 0);
    const measure = () => `${(values[at] * f.per).toPrecision(7)} ${f.unit}`;
    const value = !Number.isFinite(values[at]) ? "undefined" : f.classes.length ? f.classes[values[at]] : measure();
    output.textContent = `${f.quantity} ${value} at column ${column}, row ${row}: x = ${digits(((column + 0.5) / f.columns) * length, 4)}, ` +
      `y = ${digits(((row + 0.5) / f.rows) * height, 4)} ${f.length}`;
  };
  const choose = (i, j) => {
    chosen = within(i, j);
    read(chosen);
    const [w, h] = [f.across / zoom, f.down / zoom];
    if (chosen[0] < left || chosen[0] >= left + w) left = chosen[0] - w / 2;
    if (f.down - 1 - chosen[1] < top || f.down - 1 - chosen[1] >= top + h) top = f.down - chosen[1] - h / 2;
    draw();
  };
  // The value under a point of the page, from the upper left corner.
  const under = (event) => {
    const box = canvas.getBoundingClientRect();
    return [left + ((event.clientX - box.left) / box.width) * (f.across / zoom), top + ((event.clientY - box.top) / box.height) * (f.down / zoom)];
  };
  const magnify = (factor, about) => {
    const next = Math.min(Math.max(1, zoom * factor), Math.max(1, Math.max(f.across, f.down) / 8));
    const [x, y] = about;
    left = x - (x - left) * (zoom / next);
    top = y - (y - top) * (zoom / next);
    zoom = next;
    draw();
  };
  const middle = () => chosen ? [chosen[0] + 0.5, f.down - chosen[1] - 0.5] : [left + f.across / zoom / 2, top + f.down / zoom / 2];
  const whole = () => { zoom = 1; draw(); };

  const cell = (event) => {
    const [x, y] = under(event);
    return within(Math.floor(x), f.down - 1 - Math.floor(y));
  };
  canvas.addEventListener("click", (event) => choose(...cell(event)));
  // A mouse reads as it passes; what it leaves is the value of the chosen cell.
  canvas.addEventListener("pointermove", (event) => { if (event.pointerType === "mouse") read(cell(event)); });
  canvas.addEventListener("pointerleave", () => { if (chosen) read(chosen); });
  // With a key, so that the page can be scrolled over a map.
  canvas.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.shiftKey) return;
    event.preventDefault();
    magnify(event.deltaY + event.deltaX < 0 ? 1.25 : 0.8, under(event));
  }, { passive: false });
  canvas.addEventListener("dblclick", (event) => magnify(2, under(event)));
  canvas.addEventListener("keydown", (event) => {
    const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    if (moves[event.key]) {
      const [i, j] = chosen || [Math.floor(f.across / 2), Math.floor(f.down / 2)];
      choose(i + moves[event.key][0], j + moves[event.key][1]);
    } else if (event.key === "+" || event.key === "=") magnify(1.5, middle());
    else if (event.key === "-") magnify(1 / 1.5, middle());
    else if (event.key === "Home") whole();
    else return;
    event.preventDefault();
  });
  const [more, less, all] = figure.querySelectorAll("button");
  more.addEventListener("click", () => magnify(1.5, middle()));
  less.addEventListener("click", () => magnify(1 / 1.5, middle()));
  all.addEventListener("click", whole);
  draw();
});

// Where there are several states, a slider goes through their fields; at its left end all of them are shown.
const showStates = (root) => {
  const rows = [...root.querySelectorAll("div.fields[data-state]")];
  if (rows.length < 2) return;
  const [label, slider, shown] = ["label", "input", "span"].map((name) => document.createElement(name));
  Object.assign(slider, { type: "range", min: 0, max: rows.length, value: 0 });
  const show = () => {
    const chosen = Number(slider.value);
    rows.forEach((row, i) => { row.hidden = chosen > 0 && i !== chosen - 1; });
    shown.textContent = chosen ? rows[chosen - 1].dataset.state : "all states";
    slider.setAttribute("aria-valuetext", shown.textContent);
  };
  slider.addEventListener("input", show);
  label.className = "states";
  label.append("Fields of ", slider, shown);
  rows[0].before(label);
  show();
};

showFields(document);
showStates(document);
