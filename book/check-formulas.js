"use strict";
// Reads formulas as `place NUL source NUL display NUL` and prints `place: message` for each that KaTeX does not set.
const { readFileSync } = require("node:fs");
const { join } = require("node:path");
const katex = require(join(__dirname, "src", "katex", "katex.min.js"));
const fields = readFileSync(0, "utf8").split("\0");
for (let i = 0; i + 2 < fields.length; i += 3) {
    const [place, source, display] = fields.slice(i, i + 3);
    try {
        katex.renderToString(source, { displayMode: display !== "", throwOnError: true, strict: "error" });
    } catch (error) {
        console.log(`${place}: ${error.message.replaceAll("\n", " ")}`);
    }
}
