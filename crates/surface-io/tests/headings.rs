//! A heading that names the columns of a text table is believed or asked about, never ignored; and statements
//! in headings in the words of other programs and languages.

#![allow(clippy::unwrap_used)] // Tests, as a whole.

use surface_io::{Border, Format, Metadata, Quantity, ReadOptions, Scan, SurfaceFile};

/// The heights of the points below, row by row.
const HEIGHTS: [f64; 12] = [1.3, 2.9, 2.2, 4.1, 0.7, 5.2, 3.3, 1.8, 2.4, 0.2, 6.1, 3.7];

fn file(name: &str) -> Vec<u8> {
    std::fs::read(format!("{}/tests/files/texts/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

fn read_with(text: impl AsRef<[u8]>, options: &ReadOptions) -> surface_io::Result<Scan> {
    Scan::from_bytes("a.txt", text.as_ref(), options)
}

#[track_caller]
fn read(text: impl AsRef<[u8]>) -> Scan {
    read_with(text, &ReadOptions::default()).unwrap()
}

fn error(text: impl AsRef<[u8]>) -> String {
    read_with(text, &ReadOptions::default()).unwrap_err().to_string()
}

fn heights(scan: &Scan) -> Vec<f64> {
    let Metadata { rows, columns, .. } = *scan.metadata();
    (0..rows * columns).map(|i| scan.height(i / columns, i % columns).unwrap_or(f64::NAN)).collect()
}

fn unit(scan: &Scan) -> String {
    scan.metadata().unit.as_ref().map(|unit| unit.value.to_string()).unwrap_or_default()
}

/// Whether the map is that of [`HEIGHTS`] with cells of these sides.
#[track_caller]
fn is_map(scan: &Scan, unit_of_heights: &str, cell: Option<[f64; 2]>) {
    assert_eq!((scan.metadata().rows, scan.metadata().columns), (3, 4));
    assert_eq!((heights(scan), unit(scan)), (HEIGHTS.to_vec(), unit_of_heights.to_owned()));
    let found = scan.metadata().cell.as_ref().map(|cell| cell.value.map(Quantity::value));
    match (found, cell) {
        (Some(found), Some(cell)) => {
            assert!((0..2).all(|i| (found[i] / cell[i] - 1.0).abs() < 1e-12), "{found:?}");
        }
        (found, cell) => assert_eq!(found, cell),
    }
}

fn lines(count: usize, line: impl Fn(usize) -> String) -> String {
    (0..count).map(line).collect::<Vec<_>>().join("\n")
}

/// The points of [`HEIGHTS`] below a heading: the cells of a line by x, y and z, with a delimiter.
fn points(heading: &str, line: impl Fn([f64; 3]) -> String) -> String {
    let mut text = format!("{heading}\n");
    for (i, height) in HEIGHTS.into_iter().enumerate() {
        text += &line([(i % 4) as f64, (i / 4) as f64, height]);
        text.push('\n');
    }
    text
}

#[track_caller]
fn noted(scan: &Scan, words: &str) {
    let notes = &scan.metadata().notes;
    assert!(notes.iter().any(|note| note.contains(words)), "{words}: {notes:?}");
}

#[test]
fn columns_are_taken_by_their_names() {
    is_map(&read(file("yxz.csv")), "nm", Some([0.5e-6, 0.25e-6]));
    let plain = Some([1.0, 1.0]);
    for (heading, unit, cell) in [
        ("Y,X,Z", "", plain),
        ("\"y\",\"x\",\"height\"", "", plain),
        ("y_mm,x_mm,height_nm", "nm", Some([1e-3, 1e-3])),
        ("Y (um),X (mm),Z (\u{b5}m)", "\u{b5}m", Some([1e-3, 1e-6])),
        ("y/mm,x/mm,z/um", "um", Some([1e-3, 1e-3])),
        ("northing [m],easting [m],elevation [m]", "m", Some([1.0, 1.0])),
        ("y position in um,x position in um,height in microns", "um", Some([1e-6, 1e-6])),
        ("# y, x, z", "", plain),
        ("//Y;X;Z", "", plain),
        ("Measured on a Friday\n# y [um] x [um] z [nm]", "nm", Some([1e-6, 1e-6])),
        ("y,x,z\n[um],[um],[nm]", "nm", Some([1e-6, 1e-6])),
        ("y,x,z\num,um,nm", "nm", Some([1e-6, 1e-6])),
    ] {
        let text = points(heading, |[x, y, z]| format!("{y},{x},{z}"));
        let scan = read_with(&text, &ReadOptions::default());
        is_map(&scan.unwrap_or_else(|e| panic!("{heading}: {e}")), unit, cell);
    }
    is_map(&read(points("z\tx\ty", |[x, y, z]| format!("{z}\t{x}\t{y}"))), "", plain);
    is_map(&read(points("z (nm) x (um) y (um)", |[x, y, z]| format!("{z} {x} {y}"))), "nm", Some([1e-6; 2]));
    // The index of a data frame has no name.
    is_map(&read(points(",x,y,z", |[x, y, z]| format!("{},{x},{y},{z}", x + 4.0 * y))), "", plain);
    // As ParaView writes points.
    let paraview = "\"Points:0\",\"Points:1\",\"Points:2\"";
    is_map(&read(points(paraview, |[x, y, z]| format!("{x},{y},{z}"))), "", plain);
}

#[test]
fn further_columns_are_noted() {
    let scan = read(file("xyz-normals.txt"));
    is_map(&scan, "", Some([0.5, 0.25]));
    noted(&scan, "further columns, which are not used: Nx, Ny, Nz");
    let scan = read(points("x,y,z,sigma (nm)", |[x, y, z]| format!("{x},{y},{z},0.1")));
    is_map(&scan, "", Some([1.0, 1.0]));
    noted(&scan, "not used: sigma (nm)");
}

#[test]
fn numbers_of_rows_and_columns_have_no_length() {
    for heading in ["row,col,z [nm]", "Row,Column,height_nm", "y (px),x (px),z (nm)"] {
        let text = points(heading, |[x, y, z]| format!("{y},{x},{z}"));
        let scan = read(&text);
        is_map(&scan, "nm", None);
        noted(&scan, "cell says it");
        let cell = ReadOptions { cell: "2 um x 3 um".parse().ok(), ..ReadOptions::default() };
        is_map(&read_with(&text, &cell).unwrap(), "nm", Some([2e-6, 3e-6]));
        let lateral = ReadOptions { lateral_unit: "um".parse().ok(), ..ReadOptions::default() };
        let found = read_with(&text, &lateral).unwrap_err().to_string();
        assert!(found.contains("numbers of rows or columns"), "{found}");
    }
    let profile = format!("x (px),height (nm)\n{}", lines(12, |i| format!("{i},{}", HEIGHTS[i])));
    let cell = ReadOptions { cell: "2 um".parse().ok(), ..ReadOptions::default() };
    let scan = read_with(&profile, &cell).unwrap();
    assert!(scan.metadata().profile);
    assert_eq!(scan.metadata().size.unwrap()[0].to_string(), "24 um");
}

#[test]
fn columns_that_are_no_map_are_refused_by_their_names() {
    let found = error(file("force-curve.csv"));
    assert!(
        found.contains("the columns Extend Z (nm), Extend F (nN), Retract Z (nm), Retract F (nN)"),
        "{found}"
    );
    assert!(found.contains("expected coordinates x and y") && found.contains("skip_lines"), "{found}");
    let of = |heading: &str| error(points(heading, |[x, y, z]| format!("{y},{x},{z}")));
    for (heading, expected) in [
        ("lat,lon,elevation", "lat is an angle, and no length: project the points"),
        ("y (deg),x (deg),z (m)", "y (deg) is an angle"),
        ("x,x,z", "x and x are along one axis"),
        ("height (measured),vDeflection,z (m)", "expected coordinates x and y"),
        ("x (V),y (V),z (nm)", "x (V): expected a length as the unit of a coordinate"),
        ("y (um),x,z (nm)", "the unit of x and y is not known"),
        ("y,x,z (nm)", "the unit of x and y is not known"),
    ] {
        let found = of(heading);
        assert!(found.contains(expected), "{heading}: {found}");
    }
    let pair = format!("x,y\n{}", lines(12, |i| format!("{i},{}", HEIGHTS[i])));
    let found = error(&pair);
    assert!(found.contains("format = \"profile\" takes y for heights over x"), "{found}");
    let profile = ReadOptions { format: Some(Format::Profile), ..ReadOptions::default() };
    assert_eq!(heights(&read_with(&pair, &profile).unwrap()), HEIGHTS);
    // What is said about the format counts, and is checked against the heading.
    let text = ReadOptions { format: Some(Format::Text), ..ReadOptions::default() };
    let scan = read_with(file("force-curve.csv"), &text).unwrap();
    assert_eq!((scan.metadata().rows, scan.metadata().columns), (12, 4));
    noted(&scan, "Retract F (nN), which are all taken for heights");
    let xyz = ReadOptions { format: Some(Format::Xyz), ..ReadOptions::default() };
    let found = read_with(file("force-curve.csv"), &xyz).unwrap_err().to_string();
    assert!(found.contains("expected coordinates x and y"), "{found}");
    let found = read_with(file("yxz.csv"), &profile).unwrap_err().to_string();
    assert!(found.contains("a profile needs x and heights alone"), "{found}");
}

#[test]
fn several_profiles_are_channels() {
    let heading = "x (um),profile 1 (nm),profile 2 (nm),phase (deg)";
    let text = format!("{heading}\n{}", lines(10, |i| format!("{i},{},{},7", i * i, 3 * i)));
    let found = error(&text);
    assert!(found.contains("2 channels of the file have heights") && found.contains("profile 2"), "{found}");
    let second = ReadOptions { channel: "profile 2".parse().ok(), ..ReadOptions::default() };
    let scan = read_with(&text, &second).unwrap();
    assert_eq!((heights(&scan)[9], unit(&scan), scan.metadata().profile), (27.0, "nm".to_owned(), true));
    let line = surface_io::profile_from_bytes("a.csv", text.as_bytes(), &second).unwrap();
    assert_eq!((line.elements(), line.heights()[9].to_bits()), (10, 27e-9_f64.to_bits()));
    let all = SurfaceFile::from_bytes("a.csv", text.as_bytes(), &ReadOptions::default()).unwrap();
    let last = all.scans().last().unwrap().unwrap();
    assert_eq!(last.metadata().no_heights.as_deref(), Some("deg"));
    // Values at points of a map, without heights among them.
    let maps = points("x,y,topo (nm),phase (deg)", |[x, y, z]| format!("{x},{y},{z},1"));
    let micrometres = ReadOptions { lateral_unit: "um".parse().ok(), ..ReadOptions::default() };
    is_map(&read_with(&maps, &micrometres).unwrap(), "nm", Some([1e-6; 2]));
}

#[test]
fn other_lines_of_words_are_no_headings() {
    // Sentences of as many words as there are columns, and names that say nothing.
    for line in ["half way up", "Height map data", "# made by X"] {
        let scan = read(format!("{line}\n1 2 3\n4 5 6\n"));
        assert_eq!((scan.metadata().rows, scan.metadata().columns), (2, 3), "{line}");
    }
    let scan = read("a,b,c,d\n1,2,3,4\n5,6,7,9\n");
    assert_eq!(heights(&scan), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 9.0]);
    noted(&scan, "the heading names the columns a, b, c, d, which are all taken for heights");
    assert_eq!(heights(&read("1,2,3,4\n5,6,7,9\n")).len(), 8);
}

#[test]
fn reports_of_earlier_rounds() {
    let scan = read(file("esri-float.asc"));
    assert_eq!(scan.metadata().undefined, 1);
    let scan = read(file("lead-tab.txt"));
    assert_eq!((scan.metadata().columns, scan.metadata().undefined), (3, 0));
    let scan = read(file("div0.txt"));
    assert_eq!((scan.metadata().undefined, scan.height(2, 2)), (1, Some(9.5)));
}

#[test]
fn a_channel_without_heights_leaves_the_others() {
    let text = file("gwy-height-phase.txt");
    let scan = read(&text);
    is_map(&scan, "nm", Some([0.5e-6, 0.5e-6]));
    assert_eq!(scan.metadata().name.as_deref(), Some("Topography"));
    let all = SurfaceFile::from_bytes("a.txt", &text, &ReadOptions::default()).unwrap();
    let phase = all.scans().nth(1).unwrap().unwrap();
    assert_eq!(phase.metadata().no_heights.as_deref(), Some("deg"));
    // A statement that is wrong is an error of the file: its map may be the one that is meant.
    let found = error("# Channel: a\n# Width: -1 um\n1 2\n3 4\n\n# Channel: b\n5 6\n7 8\n");
    assert!(found.contains("width = -1 um"), "{found}");
    let found = error("# Value units: nm\n# Z unit: V\n1 2\n3 4\n");
    assert!(found.contains("line 2, z unit: V is a quantity"), "{found}");
}

#[test]
fn labels_in_other_languages() {
    is_map(&read(file("gwy-french.txt")), "nm", Some([0.5e-6, 0.5e-6]));
    for [channel, width, height, units] in [
        ["Kan\u{e1}l:", "\u{160}\u{ed}\u{159}ka:", "V\u{fd}\u{161}ka:", "Jednotky hodnot:"],
        ["Kanal:", "Breite:", "H\u{f6}he:", "Einheiten:"],
        ["Canal:", "Anchura:", "Altura:", "Value units:"],
        ["Canal :", "Largeur :", "Hauteur\u{a0}:", "Unit\u{e9}s :"],
        ["Canale:", "Larghezza:", "Altezza:", "unit\u{e0} valore:"],
        ["チャネル：", "幅:", "高さ：", "値の単位:"],
        ["채널:", "폭:", "높이:", "값 단위:"],
        ["Canal:", "Largura:", "Altura:", "Unidades de valor:"],
        ["Канал:", "Ширина:", "Высота:", "Единицы измерения:"],
    ] {
        let rows: String =
            HEIGHTS.chunks(4).map(|row| format!("{row:?}\n").replace(['[', ']', ','], " ")).collect();
        let text =
            format!("# {channel} Topo\n# {width} 2,0 \u{b5}m\n# {height} 1,5 \u{b5}m\n# {units} nm\n{rows}");
        let scan = read(&text);
        is_map(&scan, "nm", Some([0.5e-6, 0.5e-6]));
        assert_eq!(scan.metadata().name.as_deref(), Some("Topo"), "{text}");
    }
    // Words that are not known are each noted.
    let scan = read("# Leveys: 2.0 um\n# Korkeus: 1.5 um\n# Yksikk\u{f6}: nm\n# Kuvaaja: Matti\n1 2\n3 5\n");
    let notes = &scan.metadata().notes;
    assert_eq!(notes.len(), 3, "{notes:?}");
    assert!(notes[1].contains("Korkeus: 1.5 um") && notes[2].contains("nm"), "{notes:?}");
}

#[test]
fn coordinates_around_a_matrix_are_asked_about() {
    let axes = "0\t0\t0.5\t1.0\n0\t0.11\t0.12\t0.13\n0.5\t0.21\t0.22\t0.23\n1.0\t0.31\t0.32\t0.33\n";
    // As gnuplot writes it, with the number of columns in the corner; and downwards.
    let gnuplot = axes.replacen('0', "3", 1);
    let down = "0\t0\t0.5\t1.0\n1.0\t0.31\t0.32\t0.33\n0.5\t0.21\t0.22\t0.23\n0\t0.11\t0.12\t0.13\n";
    for text in [axes, &gnuplot, down] {
        let found = error(text);
        assert!(found.contains("say border = \"axes\" or border = \"heights\""), "{found}");
        let taken = ReadOptions {
            border: Some(Border::Axes),
            lateral_unit: "um".parse().ok(),
            unit: "um".parse().ok(),
            ..ReadOptions::default()
        };
        let scan = read_with(text, &taken).unwrap();
        assert_eq!(heights(&scan), [0.11, 0.12, 0.13, 0.21, 0.22, 0.23, 0.31, 0.32, 0.33]);
        assert_eq!(scan.metadata().cell.as_ref().unwrap().value[0].to_string(), "500 nm");
    }
    // A plane of heights is in equal steps everywhere.
    let plane = lines(5, |i| format!("{} {} {} {} {}", i, i + 2, i + 4, i + 6, i + 8));
    assert_eq!(read(&plane).metadata().rows, 5);
}

#[test]
fn tables_of_keyence() {
    let rows = "\"Height\";\n0,011;0,012\n0,021;0,022\n".replace(";\n0", "\n0");
    for (head, cell) in [
        ("\"XY Calibration\";\"7,41\";\"um\"\n\"Horizontal\";\"2\"\n\"Unit\";\"mm\"\n", 7.41e-6),
        ("\"XY calibration\";\"7413\";\"nm/pixel\"\n\"Unit\";\"mm\"\n", 7.413e-6),
        ("\"XY calibration\"\t\"277.5\"\t\"nm / pixel\"\n\"Unit\"\t\"mm\"\n", 277.5e-9),
        ("XY calibration;277.5;nm/pixel\nUnit;mm\n", 277.5e-9),
    ] {
        let scan = read(format!("{head}{rows}"));
        let found = scan.metadata().cell.as_ref().unwrap_or_else(|| panic!("{head}")).value[0].value();
        assert!((found / cell - 1.0).abs() < 1e-12, "{head}: {found}");
        assert_eq!((unit(&scan), scan.height(1, 0)), ("mm".to_owned(), Some(0.021)));
    }
}
