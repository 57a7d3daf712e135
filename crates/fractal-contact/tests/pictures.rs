//! Pictures are read back: shares of the area and extrema are those of the NPY files and of the table.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use contact_model::HeightMap;
use fractal_contact::scenes::{Options, Plan, SceneFile, info_statistics, run};
use plots::ColourScale;
use runs::{CsvFile, Silent};
use std::path::Path;

/// Where the map of a picture begins, in pixels from the upper left corner.
const CORNER: [usize; 2] = [168, 124];
/// Deviation of a share of a picture with fewer pixels than cells, in parts of the area and for one pixel: at
/// most that of a random choice of the cells, about twice its standard deviation.
const REDUCED: f64 = 0.7;
/// A few roundings: a cell has whole pixels.
const WHOLE: f64 = 1e-12;

const SCENE: &str = r#"[scene]
models = ["bem3d"]
bodies = [{ young = "210 GPa", poisson = 0.3 }, { young = "210 GPa", poisson = 0.3 }]

[scene.surface]
SURFACE

[[scene.path]]
force = "FORCE"

[[scene.path]]
tangential_force = "TANGENTIAL"
states = 2

[effects]
friction = 0.3
BOUNDARY

[outputs]
area = true
stick_area = true
stick_slip = ["npy", "png", "pixels"]
pressure = ["npy", "png", "pixels"]
gap = ["npy", "png"]

[models.bem3d]
cells = COLUMNS
rows = ROWS
"#;

/// A picture: its width, and three bytes a pixel.
struct DecodedPicture {
    width: usize,
    pixels: Vec<[u8; 3]>,
}

impl DecodedPicture {
    fn decode(bytes: &[u8]) -> Self {
        let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        let mut samples = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut samples).unwrap();
        let each = info.color_type.samples();
        // Transparent pixels are undefined points.
        let pixel =
            |p: &[u8]| if each == 2 && p[1] == 0 { [1, 2, 3] } else { [0, 1, 2].map(|i| p[i.min(each - 1)]) };
        let pixels = samples[..info.buffer_size()].chunks(each).map(pixel).collect();
        Self { width: info.width as usize, pixels }
    }

    fn read(path: &Path) -> Self {
        Self::decode(&std::fs::read(path).unwrap())
    }

    /// The map inside the axes, with this number of pixels.
    fn map(&self, [width, height]: [usize; 2]) -> Self {
        let [left, top] = CORNER;
        let row = |y: usize| &self.pixels[(top + y) * self.width + left..][..width];
        Self { width, pixels: (0..height).flat_map(row).copied().collect() }
    }

    fn share(&self, of: impl Fn([u8; 3]) -> bool) -> f64 {
        self.pixels.iter().filter(|p| of(**p)).count() as f64 / self.pixels.len() as f64
    }
}

/// Values of an NPY file.
fn values(path: &Path, count: usize) -> Vec<f64> {
    let bytes = std::fs::read(path).unwrap();
    let (_, values) = bytes.split_at(bytes.len() - 8 * count);
    values.as_chunks().0.iter().map(|v| f64::from_le_bytes(*v)).collect()
}

/// The picture and the values of each field of a report, by the first word of its title.
fn figures(page: &str) -> Vec<(String, serde_json::Value, DecodedPicture)> {
    let figure = |part: &str| {
        let (data, rest) = part.split_once("\">").unwrap();
        let data = serde_json::from_str(&data.replace("&quot;", "\"")).unwrap();
        let png = rest.split_once("data:image/png;base64,").unwrap().1.split_once('"').unwrap().0;
        let title = rest.split_once("<figcaption><strong>").unwrap().1.split_once(',').unwrap().0;
        (title.to_owned(), data, DecodedPicture::decode(&STANDARD.decode(png).unwrap()))
    };
    page.split("<figure class=\"field\" data-field=\"").skip(1).map(figure).collect()
}

struct ComparedPicture<'a> {
    surface: &'a str,
    boundary: &'a str,
    load: [&'a str; 2],
    cells: [usize; 2],
    /// Pixels of the map in the picture with axes.
    pixels: [usize; 2],
}

/// Runs a scene and compares the shares of each picture of its last state with the field and the table.
fn compare(dir: &Path, case: &ComparedPicture<'_>) {
    let ComparedPicture { surface, boundary, load, cells: [columns, rows], pixels } = *case;
    let mut text = SCENE.replace("SURFACE", surface).replace("BOUNDARY", boundary);
    text = text.replace("FORCE", load[0]).replace("TANGENTIAL", load[1]);
    text = text.replace("COLUMNS", &columns.to_string()).replace("ROWS", &rows.to_string());
    if surface.contains("\"file\"") {
        text.truncate(text.find("[models.bem3d]").unwrap());
    } else {
        text += "[sampling]\nseed = 1\n";
    }
    let path = dir.join("scene.toml");
    std::fs::write(&path, text).unwrap();
    let scene = SceneFile::read(&path).unwrap_or_else(|e| panic!("{e}"));
    let plan = Plan::new(&scene).unwrap_or_else(|e| panic!("{e}"));
    let out = dir.join("out");
    let options = Options { out: out.clone(), threads: 2, fresh: false };
    run(&scene, &plan, &options, &Silent, &contact_model::never).unwrap_or_else(|e| panic!("{e}"));
    let count = columns * rows;
    let file = |field: &str, extension: &str| out.join(format!("{field}-bem3d-0-002.{extension}"));
    let classes = values(&file("stick_slip", "npy"), count);
    let share = |of: &dyn Fn(usize) -> bool| (0..count).filter(|i| of(*i)).count() as f64 / count as f64;
    let [open, stick, slip] = [0.0, 1.0, 2.0].map(|class| share(&|i| (classes[i] - class).abs() < 0.5));
    assert!(stick > 0.01 && slip > 0.01 && open > 0.1, "{open} {stick} {slip}");
    let tell = |found: f64, expected: f64, tolerance: f64, what: &str| {
        println!("{columns} x {rows}, {what}: {:.4} %, off by {:.1e}", 100.0 * expected, found - expected);
        assert!((found - expected).abs() <= tolerance, "{columns} x {rows}, {what}: {found} for {expected}");
    };

    // The table has the areas of the cells.
    let table = CsvFile::read(&out.join("results.csv")).unwrap();
    let last = |name: &str| table.numbers(name).unwrap().last().unwrap().unwrap();
    let area = scene.surface.size().x * scene.surface.size().y;
    tell(last("stick_area") / area, stick, 1e-9, "stick area of the table");
    tell(last("area") / area, stick + slip, 1e-9, "area of the table");

    // With axes.
    let whole = pixels[0] % columns == 0 && pixels[1] % rows == 0;
    let tolerance = if whole { WHOLE } else { REDUCED / (pixels[0] as f64 * pixels[1] as f64).sqrt() };
    let scale = ColourScale::new((0.0, 2.0), true, false);
    let map = DecodedPicture::read(&file("stick_slip", "png")).map(pixels);
    for (class, share) in [(0.0, open), (1.0, stick), (2.0, slip)] {
        tell(map.share(|p| p == scale.colour(class)), share, tolerance, "class");
    }
    let map = DecodedPicture::read(&file("pressure", "png")).map(pixels);
    tell(map.share(|p| p != [255; 3]), stick + slip, tolerance, "under pressure");
    // The contact is inside its outline, in the colour of the smallest gap to the tolerance of the solution.
    let gap = DecodedPicture::read(&file("gap", "png")).map(pixels);
    let inside = gap.share(|p| [0, 1, 2].iter().all(|i| p[*i].abs_diff(plots::viridis()[0][*i]) <= 2));
    assert!(inside >= stick + slip - tolerance, "{inside}");

    // Grey: open is white, slip black.
    let map = DecodedPicture::read(&file("stick_slip", "pixels.png"));
    for (grey, share) in [(255, open), (128, stick), (0, slip)] {
        tell(map.share(|p| p == [grey; 3]), share, WHOLE, "class, a pixel for each cell");
    }

    // The report.
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    // Over all states, which share a scale.
    let states = ["000", "001", "002"].map(|state| out.join(format!("pressure-bem3d-0-{state}.npy")));
    let largest = states.iter().flat_map(|file| values(file, count)).fold(0.0, f64::max);
    let mut seen = 0;
    for (title, data, picture) in figures(&page) {
        let reduced = picture.pixels.len() < count;
        assert_eq!(reduced, columns.max(rows) > 512);
        assert_eq!(page.contains("A pixel shows one of about"), reduced);
        let tolerance = if reduced { REDUCED / (picture.pixels.len() as f64).sqrt() } else { WHOLE };
        match title.as_str() {
            "Stick and slip" if picture.share(|p| p == scale.colour(2.0)) > 0.0 => {
                for (class, share) in [(0.0, open), (1.0, stick), (2.0, slip)] {
                    let found = picture.share(|p| p == scale.colour(class));
                    if (found - share).abs() < 0.5 * stick {
                        tell(found, share, tolerance, "class in the report");
                        seen += 1;
                    }
                }
            }
            "Pressure" => {
                tell(picture.share(|p| p != [255; 3]), stick + slip, tolerance, "pressure in the report");
                assert!((data["high"].as_f64().unwrap() / largest - 1.0).abs() < 1e-12);
                seen += 1;
            }
            _ => (),
        }
    }
    assert!(seen >= 4, "{seen}");
}

const ROUGH: &str =
    "kind = \"self_affine\"\nhurst = 0.8\nrms_height = \"0.8 um\"\nroll_off_wavelength = \"60 um\"";

#[test]
fn pictures_have_the_areas_of_the_table() {
    let rough = |size: &str| format!("{ROUGH}\n{size}\nshortest_wavelength = \"16 um\"");
    let periodic = "boundary = \"periodic\"";
    let dir = tempfile::tempdir().unwrap();
    for (i, (size, boundary, load, cells, pixels)) in [
        ("side = \"256 um\"", "", ["200 N", "40 N"], [64, 64], [1024, 1024]),
        ("size = [\"256 um\", \"128 um\"]", periodic, ["100 N", "20 N"], [96, 48], [1056, 528]),
        // More cells than a report has pixels.
        ("size = [\"640 um\", \"160 um\"]", periodic, ["300 N", "60 N"], [640, 160], [1280, 320]),
        // More cells than a picture has pixels.
        ("size = [\"1100 um\", \"44 um\"]", "", ["150 N", "30 N"], [1100, 44], [1040, 52]),
    ]
    .into_iter()
    .enumerate()
    {
        let dir = dir.path().join(i.to_string());
        std::fs::create_dir(&dir).unwrap();
        compare(&dir, &ComparedPicture { surface: &rough(size), boundary, load, cells, pixels });
    }
    // A measured map with holes.
    let surface = contact_model::SelfAffine::new(2.2, [90.0, 60.0], 0.8).unwrap();
    let map = surface_gen::self_affine_map(&surface, [90, 60], 5).unwrap();
    let hole = |i: usize| (i % 90 / 7 + i / 90 / 5).is_multiple_of(6);
    let heights = map.heights().iter().enumerate().map(|(i, h)| if hole(i) { f64::NAN } else { *h });
    let map = HeightMap::with_undefined([90, 60], [90.0, 60.0], heights.collect()).unwrap();
    let map = surface_io::map_file("npy", &map, surface_io::Metric::Unitless).unwrap();
    std::fs::write(dir.path().join("map.npy"), map).unwrap();
    let surface = "kind = \"file\"\npath = \"map.npy\"\nunit = \"um\"\nsize = [\"90 um\", \"60 um\"]\nundefined = \"no_contact\"";
    let load = ["20 N", "4 N"];
    compare(
        dir.path(),
        &ComparedPicture { surface, boundary: "", load, cells: [90, 60], pixels: [1080, 720] },
    );
}

/// Whether every tick of a map lies on its axis, and every number of its scale is one.
fn assert_axes(page: &str, cell: &str) {
    for (_, data, _) in figures(page) {
        for number in
            ["low", "high", "per"].map(|key| &data[key]).into_iter().chain(data["sides"].as_array().unwrap())
        {
            assert!(number.is_f64(), "{cell}: {data}");
        }
    }
    let mut ticks = 0;
    for edge in ["<span style=\"left:", "<span style=\"bottom:"] {
        for tick in page.split(edge).skip(1) {
            let at: f64 = tick.split_once('%').unwrap().0.parse().unwrap();
            assert!((0.0..=100.001).contains(&at), "{cell}: {at}");
            ticks += 1;
        }
    }
    assert!(ticks >= 6, "{cell}: {ticks}");
}

/// Maps whose sides are almost the largest and the smallest numbers have reports with axes. A contact whose
/// force is no number is refused.
#[test]
fn maps_of_any_size_are_drawn() {
    for (cell, height, approach) in
        [("1e307", "e305", "1e306"), ("1e-307", "e-309", "1e-309"), ("1e-318", "e-320", "1e-319")]
    {
        let dir = tempfile::tempdir().unwrap();
        let row = |i: usize| {
            (0..12).map(|j| format!("{}{height}", (i * 7 + j * 3) % 5)).collect::<Vec<_>>().join(" ")
        };
        let map = dir.path().join("map.txt");
        std::fs::write(&map, (0..12).map(row).collect::<Vec<_>>().join("\n")).unwrap();
        let text = format!(
            "[scene]\nunits = \"none\"\nmodels = [\"bem3d\"]\ncontact_modulus = 1.0\napproach = [{approach}]\n\
             [scene.surface]\nkind = \"file\"\npath = \"map.txt\"\ncell = {cell}\n[outputs]\n\
             pressure = [\"npy\", \"png\", \"pixels\", \"vti\"]\ngap = [\"png\"]\n"
        );
        let path = dir.path().join("scene.toml");
        std::fs::write(&path, text).unwrap();
        let scene = SceneFile::read(&path).unwrap_or_else(|e| panic!("{e}"));
        let out = dir.path().join("out");
        let options = Options { out: out.clone(), threads: 1, fresh: false };
        let solved =
            Plan::new(&scene).and_then(|plan| run(&scene, &plan, &options, &Silent, &contact_model::never));
        match solved {
            Ok(_) => assert_axes(&std::fs::read_to_string(out.join("report.html")).unwrap(), cell),
            Err(error) => assert!(error.to_string().contains("choose other units"), "{cell}: {error}"),
        }
        // A side below the normal numbers is refused by the reader.
        let Ok(size) = format!("{0} x {0}", 12.0 * cell.parse::<f64>().unwrap()).parse() else { continue };
        let declared = surface_io::ReadOptions {
            unit: Some("none".parse().unwrap()),
            size: Some(size),
            ..Default::default()
        };
        let out = dir.path().join("info");
        let preprocessing = surface_io::Preprocessing::default();
        match info_statistics(&map, &declared, &preprocessing, &out) {
            Ok(_) => assert_axes(&std::fs::read_to_string(out.join("report.html")).unwrap(), cell),
            // Of a spectrum, too.
            Err(error) => assert!(error.to_string().contains("finite"), "{cell}: {error}"),
        }
    }
}
