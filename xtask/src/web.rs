//! `cargo xtask web`: the page of the browser, as a folder for a server of files and as one file.

use crate::arguments::WebArguments;
use fractal_contact::scenes::page_parts;
use runs::{Error, Result};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Vector instructions, which every browser has had since 2023.
const FLAGS: &str = "-C target-feature=+simd128";
const TARGET: &str = "wasm32-unknown-unknown";
/// Maps of the folder `data` that the page offers. The page of one file has the first one alone.
const EXAMPLES: [&str; 3] = ["scenes/polished.x3p", "measured/optical.x3p", "measured/uncd-afm.001"];
/// The served page reaches its own folder and nothing else.
const SERVED: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; style-src 'self' 'unsafe-inline'; \
    img-src data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'";
/// The page of one file reaches nothing. It runs the scripts whose hashes stand in the place of `@HASHES@`, and no other.
const ALONE: &str = "default-src 'none'; script-src @HASHES@ 'wasm-unsafe-eval'; worker-src blob:; style-src 'unsafe-inline'; \
    img-src data: blob:; connect-src 'none'; base-uri 'none'; form-action 'none'";

/// Builds the page.
///
/// # Errors
/// A step that fails, by its command; files that cannot be read or written.
pub fn build(arguments: &WebArguments) -> Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."));
    let made = compile(root, arguments.build_std)?;
    let page = BrowserPage::read(root, &made)?;
    let out = &arguments.out;
    runs::files::create_directory(&out.join("examples"))?;
    let write = |name: &str, bytes: &[u8]| Ok::<(), Error>(runs::files::write_whole(&out.join(name), bytes)?);
    for (name, text) in page.served() {
        write(name, text.as_bytes())?;
    }
    write("fractal_contact_bg.wasm", &page.wasm)?;
    for (name, bytes) in EXAMPLES.iter().zip(&page.examples) {
        write(&format!("examples/{}", file_name(name)), bytes)?;
    }
    write("fractal-contact.html", page.alone().as_bytes())?;
    runs::out!("{}: {} bytes of WebAssembly", out.display(), page.wasm.len());
    runs::out!("serve this folder, or open fractal-contact.html in a browser");
    Ok(())
}

/// Compiles the WebAssembly and its script, and returns the folder that holds both.
fn compile(root: &Path, build_std: bool) -> Result<PathBuf> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    let mut build = Command::new(&cargo);
    build.current_dir(root).env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS", FLAGS);
    build.args([
        "build",
        "--locked",
        "--profile",
        "web",
        "--package",
        "fractal-contact-web",
        "--target",
        TARGET,
    ]);
    if build_std {
        build.arg("-Zbuild-std=std,panic_abort").env("RUSTC_BOOTSTRAP", "1");
    }
    run(&mut build, "is the target there? `rustup target add wasm32-unknown-unknown` installs it")?;
    let wasm = target.join(TARGET).join("web/fractal_contact_web.wasm");
    let made = target.join("web-bindings");
    let mut bindings = Command::new(&cargo);
    bindings.current_dir(root).args([
        "run",
        "--quiet",
        "--locked",
        "--package",
        "fractal-contact-web-bindings",
        "--",
    ]);
    run(bindings.arg(&wasm).arg(&made), "the WebAssembly was compiled, and its script could not be made")?;
    Ok(made)
}

fn run(command: &mut Command, help: &str) -> Result<()> {
    let program = PathBuf::from(command.get_program());
    let status = command.status().map_err(Error::file("run", &program))?;
    if status.success() {
        return Ok(());
    }
    Err(Error::content(&program, format!("ended with {status}: {help}")))
}

/// The parts of the page.
struct BrowserPage {
    html: String,
    style: String,
    report: String,
    palette: String,
    app: String,
    worker: String,
    offline: String,
    wasm: Vec<u8>,
    examples: Vec<Vec<u8>>,
}

impl BrowserPage {
    fn read(root: &Path, made: &Path) -> Result<Self> {
        let bytes = |path: PathBuf| runs::files::read(&path, u64::MAX).map_err(Error::from);
        let text = |name: &str| {
            bytes(root.join("web/page").join(name)).map(|bytes| String::from_utf8_lossy(&bytes).into_owned())
        };
        let [style, report, palette] = page_parts();
        let script = bytes(made.join("fractal_contact.js"))?;
        Ok(Self {
            html: text("index.html")?,
            style: format!("{style}\n{}", text("page.css")?),
            report,
            palette,
            app: text("app.js")?,
            worker: format!("{}\n{}", String::from_utf8_lossy(&script), text("worker.js")?),
            offline: text("offline.js")?,
            wasm: bytes(made.join("fractal_contact_bg.wasm"))?,
            examples: EXAMPLES
                .iter()
                .map(|name| bytes(root.join("data").join(name)))
                .collect::<Result<_>>()?,
        })
    }

    /// The page with what its places hold.
    fn html(&self, policy: &str, style: &str, scripts: &str) -> String {
        self.html.replace("@POLICY@", policy).replace("@STYLE@", style).replace("@SCRIPTS@", scripts)
    }

    fn stored(id: &str, what: &str) -> String {
        format!("<script id=\"{id}\" type=\"application/octet-stream\">{what}</script>\n")
    }

    /// The texts of a folder for a server.
    fn served(&self) -> [(&'static str, String); 6] {
        let scripts = "<script src=\"report.js\"></script>\n<script src=\"app.js\"></script>";
        let scripts = format!("{}{scripts}", Self::stored("palette", &self.palette));
        let html = self.html(SERVED, "<link rel=\"stylesheet\" href=\"page.css\">", &scripts);
        // The name of the store is that of the content, so that a new page replaces an old one.
        let content =
            [html.as_bytes(), self.style.as_bytes(), self.app.as_bytes(), self.worker.as_bytes(), &self.wasm];
        let version = format!("{:032x}", runs::fnv1a_128(&content.concat()));
        [
            ("index.html", html),
            ("page.css", self.style.clone()),
            ("report.js", self.report.clone()),
            ("app.js", self.app.clone()),
            ("worker.js", self.worker.clone()),
            ("offline.js", self.offline.replace("@VERSION@", &version)),
        ]
    }

    /// The page as one file, which a browser opens from a folder: there a worker and WebAssembly can only come from the
    /// page itself.
    fn alone(&self) -> String {
        // Nothing in a script may end its element.
        let script = |text: &str| text.replace("</script", "<\\/script");
        let example = format!(
            "<script data-example=\"{}\" type=\"application/octet-stream\">{}</script>\n",
            file_name(EXAMPLES[0]),
            base64(&self.examples[0])
        );
        let [report, app] = [&self.report, &self.app].map(|text| script(text));
        let policy = ALONE.replace("@HASHES@", &format!("{} {}", script_hash(&report), script_hash(&app)));
        let scripts = [
            Self::stored("palette", &self.palette),
            Self::stored("ui-wasm", &base64(&self.wasm)),
            example,
            format!("<script id=\"ui-worker\" type=\"text/plain\">{}</script>\n", script(&self.worker)),
            format!("<script>{report}</script>\n<script>{app}</script>"),
        ];
        self.html(&policy, &format!("<style>{}</style>", self.style), &scripts.concat())
    }
}

/// The name of an example without its folder.
fn file_name(example: &str) -> &str {
    example.rsplit('/').next().unwrap_or(example)
}

/// A script of the page as a security policy names it.
fn script_hash(script: &str) -> String {
    format!("'sha256-{}'", base64(&hmac_sha256::Hash::hash(script.as_bytes())))
}

fn base64(bytes: &[u8]) -> String {
    use base64::Engine as _;
    base64::engine::general_purpose::STANDARD.encode(bytes)
}
