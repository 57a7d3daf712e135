"use strict";
// Sets the formulas of a page with KaTeX, which lies beside the pages: blocks of the language `math`, and code
// between two dollar signs. A page without formulas loads nothing. Without scripts the source stays as it is.
(() => {
    const blocks = [...document.querySelectorAll("pre > code.language-math")];
    const between = (code) => {
        const [before, after] = [code.previousSibling, code.nextSibling];
        const text = (node) => node !== null && node.nodeType === Node.TEXT_NODE;
        return text(before) && text(after) && before.data.endsWith("$") && after.data.startsWith("$");
    };
    const inline = [...document.querySelectorAll(":not(pre) > code")].filter(between);
    if (blocks.length + inline.length === 0) {
        return;
    }
    const root = typeof path_to_root === "undefined" ? "" : path_to_root;
    const load = (name, attributes) =>
        new Promise((loaded, failed) => {
            const element = Object.assign(document.createElement(name), attributes);
            element.onload = loaded;
            element.onerror = failed;
            document.head.append(element);
        });
    const set = () => {
        for (const code of blocks) {
            const place = document.createElement("div");
            place.className = "formula";
            window.katex.render(code.textContent, place, { displayMode: true, throwOnError: false });
            code.parentElement.replaceWith(place);
        }
        for (const code of inline) {
            const [before, after] = [code.previousSibling, code.nextSibling];
            const place = document.createElement("span");
            window.katex.render(code.textContent, place, { throwOnError: false });
            before.data = before.data.slice(0, -1);
            after.data = after.data.slice(1);
            code.replaceWith(place);
        }
    };
    const style = load("link", { rel: "stylesheet", href: `${root}katex/katex.min.css` });
    const script = load("script", { src: `${root}katex/katex.min.js` });
    Promise.all([style, script]).then(set);
})();
