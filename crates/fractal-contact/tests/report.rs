//! `report.html` in a browser: no error, maps that draw, values that are those of the files, nothing that a
//! name could do.

use fractal_contact::scenes::{Options, Plan, SceneFile, info_statistics, run};
use std::path::Path;
use std::process::Command;

/// Records errors of the page, from its beginning.
const WATCH: &str = "<script>window.errors = []; addEventListener('error', (e) => errors.push(e.message)); \
    for (const name of ['error', 'warn']) console[name] = (...words) => errors.push(words.join(' '));</script>";

/// Clicks in the middle of every map, moves by keys, zooms, and writes down what is read and what is seen.
const PROBE: &str = r#"<script>
const found = [];
document.querySelectorAll("figure.field[data-field]").forEach((figure) => {
  const canvas = figure.querySelector("canvas"), box = canvas.getBoundingClientRect(), output = figure.querySelector("output");
  const at = { clientX: box.left + 0.3 * box.width, clientY: box.top + 0.6 * box.height, bubbles: true };
  canvas.dispatchEvent(new MouseEvent("click", at));
  found.push(output.textContent);
  canvas.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowUp" }));
  found.push(output.textContent);
  for (const key of ["+", "+", "-", "Home"]) canvas.dispatchEvent(new KeyboardEvent("keydown", { key }));
  const image = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  found.push(String(new Set(new Uint32Array(image.buffer)).size));
});
const probe = document.createElement("pre");
probe.id = "probe";
probe.textContent = JSON.stringify({ found, errors, images: document.querySelectorAll("body > img").length, scripted: String(window.scripted) });
document.body.append(probe);
</script>"#;

/// The Chromium that the environment names: these pages are looked at by `.ci/full`.
fn browser() -> Option<String> {
    std::env::var("FRACTAL_CONTACT_BROWSER").ok()
}

/// Runs a scene and gives its report.
fn report(dir: &Path, name: &str, scene: &str) -> String {
    std::fs::write(dir.join(name), scene).unwrap();
    let scene = SceneFile::read(&dir.join(name)).unwrap_or_else(|e| panic!("{e}"));
    let plan = Plan::new(&scene).unwrap_or_else(|e| panic!("{e}"));
    let options = Options { out: dir.join("out"), threads: 2, fresh: false };
    run(&scene, &plan, &options, &runs::Silent, &contact_model::never).unwrap_or_else(|e| panic!("{e}"));
    std::fs::read_to_string(dir.join("out/report.html")).unwrap()
}

const HOSTILE: &str = "<img src=x onerror=\"scripted=1\"> & '\"";
const SCENE: &str = r#"# </script><script>scripted = 1</script> How stiff? "Quoted" & <b>bold</b>
[scene]
models = ["bem3d"]
force_bar = [0.01, 0.1]
contact_modulus = "100 GPa"

[scene.surface]
kind = "self_affine"
size = ["2 mm", "1 mm"]
fractal_dimension = 2.2
rms_height = "1 um"

[outputs]
stiffness = true
heights = ["npy"]
pressure = ["npy"]
gap = ["png"]
distributions = ["pressure", "patches"]
grid_error = true

[models.bem3d]
cells = CELLS

[sampling]
seed = 3
"#;

#[test]
fn a_report_stands_alone_and_escapes_what_it_is_given() {
    let dir = tempfile::tempdir().unwrap();
    let page = report(dir.path(), &format!("{HOSTILE}.toml").replace('/', ""), &SCENE.replace("CELLS", "64"));
    assert!(page.contains("&lt;/script&gt;&lt;script&gt;scripted = 1&lt;/script&gt;"));
    assert!(
        page.contains("&lt;img src=x onerror=&quot;scripted=1&quot;&gt;") && !page.contains("<img src=x")
    );
    // Nothing comes from elsewhere; namespaces of pictures are in base64.
    for (i, _) in page.match_indices("src=\"") {
        assert!(page[i + 5..].starts_with("data:image/"), "{}", &page[i..i + 60]);
    }
    assert!(!page.contains("http://") && !page.contains("https://") && !page.contains("@import"));
    for section in ["results", "fields", "surface", "certificates", "effects", "work", "cite", "scene"] {
        assert!(page.contains(&format!("<section id=\"{section}\">")), "{section}");
    }
    // Every picture has words in its place.
    assert_eq!(page.matches("<img ").count(), page.matches(" alt=\"").count());
}

/// Draws a page, clicks on its maps and gives the three texts of each: clicked, moved, number of colours.
fn probed(browser: &str, dir: &Path, page: &str) -> Vec<String> {
    let page =
        page.replace("<head>", &format!("<head>{WATCH}")).replace("</body>", &format!("{PROBE}</body>"));
    let path = dir.join("probe.html");
    std::fs::write(&path, page).unwrap();
    let seen = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--window-size=1000,800", "--dump-dom"])
        .arg(format!("file://{}", path.display()))
        .output()
        .unwrap();
    let dom = String::from_utf8_lossy(&seen.stdout);
    let probe = dom.rsplit_once("<pre id=\"probe\">").expect("the page's scripts ran to their end").1;
    let probe = &probe[..probe.find("</pre>").unwrap()];
    let probe: serde_json::Value =
        serde_json::from_str(&probe.replace("&gt;", ">").replace("&lt;", "<").replace("&amp;", "&")).unwrap();
    assert_eq!(probe["errors"], serde_json::json!([]));
    assert_eq!(
        (&probe["images"], &probe["scripted"]),
        (&serde_json::json!(0), &serde_json::json!("undefined"))
    );
    let found = probe["found"].as_array().unwrap().iter();
    found.filter_map(|text| text.as_str().map(str::to_owned)).collect()
}

/// Compares what a click read with the value of an NPY file of so many columns and rows.
fn compare(text: &str, file: &Path, [columns, rows]: [usize; 2]) {
    let word = |before: &str| {
        let rest = &text[text.find(before).unwrap() + before.len()..];
        rest.split([' ', ',', ':']).next().unwrap().to_owned()
    };
    let bytes = std::fs::read(file).unwrap();
    let (_, values) = bytes.split_at(bytes.len() - 8 * columns * rows);
    let (column, row): (usize, usize) = (word("column ").parse().unwrap(), word("row ").parse().unwrap());
    let value = f64::from_le_bytes(values[8 * (row * columns + column)..][..8].try_into().unwrap());
    let mut words = text.split(' ').skip(1);
    let (read, unit): (f64, &str) = (words.next().unwrap().parse().unwrap(), words.next().unwrap());
    // Seven digits are shown, in the multiple of the unit that suits the field.
    let (prefixes, plain) =
        (["n", "µ", "m", "k", "M", "G"], ["m", "Pa"].into_iter().find(|plain| unit.ends_with(plain)));
    let prefix = plain.and_then(|plain| unit.strip_suffix(plain)).unwrap_or_default();
    let power = prefixes.iter().position(|p| *p == prefix).map_or(0, |i| [-9, -6, -3, 3, 6, 9][i]);
    let read = read * 10f64.powi(power);
    assert!((read - value).abs() <= 5e-7 * value.abs(), "{text}: {value} in {}", file.display());
}

#[test]
fn a_click_reads_the_value_of_the_file() {
    let Some(browser) = browser() else {
        println!("skipped: FRACTAL_CONTACT_BROWSER names no Chromium");
        return;
    };
    // Each cell is seen, and blocks of cells are.
    for cells in [64, 600] {
        let dir = tempfile::tempdir().unwrap();
        let name = format!("{HOSTILE}.toml").replace('/', "");
        let page = report(dir.path(), &name, &SCENE.replace("CELLS", &cells.to_string()));
        assert!(page.len() < 13_000_000, "{}", page.len());
        let found = probed(&browser, dir.path(), &page);
        let mut compared = 0;
        for figure in found.chunks(3) {
            assert!(figure[2].parse::<usize>().unwrap() > 3, "{figure:?}: the map is not drawn");
            for text in &figure[..2] {
                let file = match text.split(' ').next().unwrap() {
                    "height" => "heights-bem3d-0-000.npy",
                    "pressure" if compared < 4 => "pressure-bem3d-0-001.npy",
                    "pressure" => "pressure-bem3d-0-000.npy",
                    _ => continue,
                };
                compare(text, &dir.path().join("out").join(file), [cells, cells / 2]);
                compared += 1;
            }
        }
        assert_eq!(compared, 6, "{found:?}");
    }
}

/// The statistics of a map with holes, those of `preprocessing`, as they are told, and the spectrum's picture.
fn statistics_of(map: &contact_model::HeightMap, preprocessing: &surface_io::Preprocessing) -> [String; 2] {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("map.csv");
    let height = |h: &f64| if h.is_finite() { format!("{h:e}") } else { String::new() };
    let line = |row: &[f64]| row.iter().map(height).collect::<Vec<_>>().join(",") + "\n";
    std::fs::write(&file, map.heights().chunks(map.columns()).map(line).collect::<String>()).unwrap();
    let declared = surface_io::ReadOptions {
        unit: Some("none".parse().unwrap()),
        size: Some(format!("{} x {}", map.size().x, map.size().y).parse().unwrap()),
        ..Default::default()
    };
    let out = dir.path().join("out");
    let told = info_statistics(&file, &declared, preprocessing, &out).unwrap_or_else(|e| panic!("{e}"));
    [told, std::fs::read_to_string(out.join("spectrum.svg")).unwrap()]
}

/// Holes of 1.7 % cost no part of the map: spectra and their fit are of all of it, whether the points are kept
/// undefined or filled, and the fit ends where filled points matter. The fitted line is drawn with its interval.
#[test]
fn a_map_with_holes_has_an_exponent_of_all_of_it() {
    let surface = contact_model::SelfAffine {
        roll_off: Some(8.0 * std::f64::consts::TAU),
        ..contact_model::SelfAffine::new(2.2, 2.0, 0.01).unwrap()
    };
    let whole = surface_gen::self_affine_map(&surface, 400, 3).unwrap().cropped(0..200, 0..160).unwrap();
    // Discs of 7 cells, one in each 48 x 48.
    let hole = |i: usize| {
        let [x, y] = [i % 200 % 48, i / 200 % 48].map(|at| at as f64 - 24.0);
        x.hypot(y) < 3.6
    };
    let heights = whole.heights().iter().enumerate().map(|(i, h)| if hole(i) { f64::NAN } else { *h });
    let holes =
        contact_model::HeightMap::with_undefined(whole.cells(), whole.size(), heights.collect()).unwrap();
    let exponent = |told: &str| -> [f64; 3] {
        let line = told.lines().find(|line| line.starts_with("H  ")).unwrap_or_else(|| panic!("{told}"));
        let numbers = line.split(|c: char| !(c.is_ascii_digit() || c == '.'));
        let numbers: Vec<f64> = numbers.filter_map(|word| word.parse().ok()).collect();
        [numbers[0], numbers[1], numbers[2]]
    };
    let kept = surface_io::Preprocessing {
        undefined: Some(surface_io::Undefined::NoContact),
        ..surface_io::Preprocessing::default()
    };
    let filled = surface_io::Preprocessing {
        fill: Some(surface_io::Fill::Neighbours),
        ..surface_io::Preprocessing::default()
    };
    let [of_whole, picture] = statistics_of(&whole, &surface_io::Preprocessing::default());
    assert!(!of_whole.contains("spectra and H are those of the whole map"), "{of_whole}");
    let told = [&kept, &filled].map(|preprocessing| statistics_of(&holes, preprocessing)[0].clone());
    for told in &told {
        let note = "%) have heights between those of their neighbours";
        assert!(told.contains("spectra and H are those of the whole map") && told.contains(note), "{told}");
        assert!(!told.contains("not known      spectrum") && !told.contains("not known      fit"), "{told}");
        let [value, low, high] = exponent(told);
        let [_, whole_low, whole_high] = exponent(&of_whole);
        assert!(low < 0.8 && 0.8 < high && low < value && value < high, "{value} {low} {high}");
        assert!(high - low < 2.0 * (whole_high - whole_low), "{low} to {high}, {whole_low} to {whole_high}");
    }
    assert_eq!(exponent(&told[0]).map(f64::to_bits), exponent(&told[1]).map(f64::to_bits));
    // The scene of a map that is filled has the same exponent, and says so in its report.
    let dir = tempfile::tempdir().unwrap();
    let row = |row: &[f64]| row.iter().map(f64::to_string).collect::<Vec<_>>().join(" ") + "\n";
    let text = holes.heights().chunks(holes.columns()).map(row).collect::<String>().replace("-inf", "nan");
    std::fs::write(dir.path().join("map.txt"), text).unwrap();
    let page = report(
        dir.path(),
        "scene.toml",
        "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\nforce = 1e-4\ncontact_modulus = 1.0\n[scene.surface]\nkind = \"file\"\n\
         path = \"map.txt\"\nsize = [1.0, 0.8]\nfill = \"neighbours\"\ndetrend = \"none\"\n[outputs]\narea = true\nstatistics = true\n\
         [models.bem3d]\ntolerance = 1e-2\n",
    );
    assert!(page.contains("spectra and H are those of the whole map"), "{page}");
    let table = std::fs::read_to_string(dir.path().join("out/statistics.csv")).unwrap();
    let line = table.lines().find(|line| line.starts_with("H,")).unwrap_or_else(|| panic!("{table}"));
    let numbers: Vec<f64> = line.split(',').skip(1).take(3).map(|number| number.parse().unwrap()).collect();
    let shown = exponent(&told[1]);
    assert!(
        numbers.iter().zip(shown).all(|(number, shown)| (number - shown).abs() < 6e-4),
        "{numbers:?} {shown:?}"
    );
    for symbol in ["Sk", "Spk", "Svk"] {
        let line = told[0].lines().find(|line| line.starts_with(&format!("{symbol} "))).unwrap();
        assert!(line.split_whitespace().nth(1).unwrap().parse::<f64>().unwrap() > 0.0, "{line}");
    }
    assert!(picture.contains("fit, ") && picture.contains(", shaded 0."), "{picture}");
}

#[test]
fn a_tilt_that_leaves_no_digits_for_the_roughness_is_told_in_words() {
    let dir = tempfile::tempdir().unwrap();
    let rough = |i: usize| ((i * i * 31 + i / 24 * 17) % 101) as f64 / 101.0;
    let mut count = 0;
    let mut told = |tilt: f64, print: &dyn Fn(f64) -> String, detrend: surface_io::Detrend| {
        count += 1;
        let file = dir.path().join(format!("{count}.csv"));
        let line = |row: usize| {
            let heights =
                (24 * row..24 * row + 24).map(|i| print(tilt * ((i % 24) + 2 * row) as f64 + rough(i)));
            heights.collect::<Vec<_>>().join(",") + "\n"
        };
        std::fs::write(&file, (0..24).map(line).collect::<String>()).unwrap();
        let declared = surface_io::ReadOptions {
            unit: Some("nm".parse().unwrap()),
            cell: Some("1 um".parse().unwrap()),
            ..Default::default()
        };
        let preprocessing = surface_io::Preprocessing { detrend, ..Default::default() };
        fractal_contact::scenes::info(&file, &declared, &preprocessing).unwrap()
    };
    let words = "the rounding of the file's numbers, ";
    let exact = |h: f64| format!("{h:e}");
    for detrend in [surface_io::Detrend::Nothing, surface_io::Detrend::Plane] {
        // A tilt of 1e20 times the roughness, and one of 300 times that is printed without decimals.
        for told in [told(1e20, &exact, detrend), told(300.0, &|h| format!("{:.0}", h / 30.0), detrend)] {
            assert!(told.contains(words) && told.contains("Subtract the tilt in the program of"), "{told}");
            assert!(!told.contains("times its rms height without the tilt"), "{told}");
        }
        // Digits that are enough.
        for told in [told(300.0, &exact, detrend), told(3.0, &|h| format!("{h:.1}"), detrend)] {
            assert!(!told.contains(words), "{told}");
        }
    }
}

#[test]
fn a_surface_has_a_report() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join(format!("{HOSTILE}.npy").replace('/', ""));
    let surface = contact_model::SelfAffine::new(2.2, [2.0, 1.0], 0.01).unwrap();
    let map = surface_gen::self_affine_map(&surface, [300, 150], 5).unwrap();
    std::fs::write(&file, surface_io::map_file("npy", &map, surface_io::Metric::Unitless).unwrap()).unwrap();
    let declared = surface_io::ReadOptions {
        unit: Some("none".parse().unwrap()),
        size: Some("2 x 1".parse().unwrap()),
        ..Default::default()
    };
    let out = dir.path().join("out");
    let preprocessing = surface_io::Preprocessing::default();
    let told = info_statistics(&file, &declared, &preprocessing, &out).unwrap_or_else(|e| panic!("{e}"));
    assert!(told.contains("report.html"));
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("&lt;img src=x onerror=") && !page.contains("<img src=x"));
    assert!(!page.contains("http://") && !page.contains("https://"));
    assert!(page.len() < 13_000_000 && page.contains("Hurst exponent of the fitted spectrum"));
    assert_eq!(page.matches("<img ").count(), page.matches(" alt=\"").count());
    let Some(browser) = browser() else {
        println!("skipped: FRACTAL_CONTACT_BROWSER names no Chromium");
        return;
    };
    let found = probed(&browser, dir.path(), &page);
    assert_eq!(found.len(), 3);
    assert!(found[2].parse::<usize>().unwrap() > 3, "{found:?}: the map is not drawn");
    for text in &found[..2] {
        compare(text, &file, [300, 150]);
    }
}

#[test]
fn statistics_are_written_where_they_are_asked_for() {
    let dir = tempfile::tempdir().unwrap();
    let scene = SCENE.replace("CELLS", "64").replace("grid_error = true", "statistics = true");
    let page = report(dir.path(), "rough.toml", &scene);
    assert!(page.contains("Hurst exponent of the fitted spectrum"));
    let read = |name: &str| runs::CsvFile::read(&dir.path().join("out").join(name)).unwrap();
    let table = read("statistics.csv");
    let (names, values) = (table.texts("quantity").unwrap(), table.numbers("value").unwrap());
    let of = |name: &str| values[names.iter().position(|n| *n == name).unwrap()].unwrap();
    assert!((of("Sq") / 1e-6 - 1.0).abs() < 0.3 && of("Sz") > of("Sp") && (of("H") - 0.8).abs() < 0.2);
    let spectrum = read("spectrum.csv");
    for name in ["wavenumber", "density", "low", "high"] {
        assert!(
            spectrum.numbers(name).unwrap().iter().flatten().all(|v| v.is_finite() && *v > 0.0),
            "{name}"
        );
    }
    assert!(dir.path().join("out/height-difference.svg").exists());
    // Asked for no more, they go.
    let page = report(dir.path(), "rough.toml", &SCENE.replace("CELLS", "64"));
    assert!(!page.contains("Hurst exponent of") && !dir.path().join("out/statistics.csv").exists());
}
