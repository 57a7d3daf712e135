//! Names, units and tokens of files may hold commands of a terminal: nothing that is shown of a file does.

#![allow(clippy::unwrap_used)] // Tests, as a whole.

#[allow(dead_code)] // Shapes and heights are for the tests of reading.
mod files;

use surface_io::{ReadOptions, Scan, SurfaceFile};

/// Clears the screen, in both encodings of the control sequence.
const COMMANDS: [&[u8]; 3] = [b"\x1b[2J", "\u{9b}2J".as_bytes(), b"\x07\x08\r\n"];

fn harmless(shown: &str, lines: bool) -> bool {
    !shown.chars().any(|c| c.is_control() && !(lines && c == '\n'))
}

/// All that is shown of a file; how much of it holds an escaped command.
fn check(name: &str, bytes: &[u8]) -> usize {
    let mut escaped = 0;
    let mut see = |shown: &str, lines: bool| {
        assert!(harmless(shown, lines), "{name}: {shown:?}");
        escaped += usize::from(shown.contains("\\u{1b}[2J"));
    };
    let declared = ReadOptions::default();
    let mut error = |e: &surface_io::Error| see(&e.to_string(), false);
    match SurfaceFile::from_bytes(name, bytes, &declared) {
        Err(e) => error(&e),
        Ok(file) => {
            // Which channel is meant is an error that lists them.
            if let Err(e) = SurfaceFile::from_bytes(name, bytes, &declared).and_then(SurfaceFile::scan) {
                error(&e);
            }
            let none = ReadOptions { channel: "no such channel".parse().ok(), ..declared.clone() };
            if let Err(e) = SurfaceFile::from_bytes(name, bytes, &none).and_then(SurfaceFile::scan) {
                error(&e);
            }
            for scan in file.scans() {
                match scan {
                    Err(e) => see(&e.to_string(), false),
                    Ok(scan) => {
                        let metadata = scan.metadata();
                        see(&metadata.to_string(), true);
                        let texts =
                            [Some(&metadata.details), metadata.name.as_ref(), metadata.no_heights.as_ref()];
                        texts.into_iter().flatten().for_each(|text| see(text, false));
                    }
                }
            }
        }
    }
    escaped
}

#[test]
fn no_byte_of_an_instruments_file_becomes_a_command() {
    let mut shown = Vec::new();
    for small in files::all() {
        let mut escaped = 0;
        for command in COMMANDS {
            // Over any text of the file, and where text begins.
            for at in (0..small.bytes.len()).filter(|&at| small.bytes[at].is_ascii_graphic()) {
                let mut bytes = small.bytes.clone();
                let end = (at + command.len()).min(bytes.len());
                bytes[at..end].copy_from_slice(&command[..end - at]);
                escaped += check(small.name, &bytes);
            }
        }
        if escaped > 0 {
            shown.push(small.name);
        }
    }
    // The test would hold nothing if no name, unit or token came through.
    for format in ["gwy", "sur", "hdf5", "nanoscope", "sdf", "tiff"] {
        assert!(shown.iter().any(|name| name.contains(format)), "{format} is not among {shown:?}");
    }
}

#[test]
fn text_and_paths_do_not_either() {
    for text in [
        "# Channel: Height\x1b[2J\n# Width: 3 um\n1 2\n3 4\n",
        "# Channel: a\n# Width: 3 u\x1b[2Jm\n1 2\n3 4\n",
        "# Value units: \x1b[2J\n1 2\n3 4\n",
        "1 2\n3 \x1b[2J\n",
        "1 2\n3 4\u{9b}2J\n",
        "x\x1b[2J y z\n0 0 1\n1 0 2\n0 1 3\n1 1 4\n",
        "\x1b[2J",
    ] {
        for name in ["a.txt", "a.xyz", "a.npy", "a.x3p", "a\x1b[2J.txt", "a\n\x07"] {
            check(name, text.as_bytes());
            if let Err(e) = surface_io::profile_from_bytes(name, text.as_bytes(), &ReadOptions::default()) {
                assert!(harmless(&e.to_string(), false), "{e:?}");
            }
        }
    }
    let nowhere = std::path::Path::new("/nowhere\x1b[2J/a\n.npy");
    let said = Scan::read(nowhere, &ReadOptions::default()).unwrap_err().to_string();
    assert!(said.starts_with("cannot open /nowhere\\u{1b}[2J/a\\n.npy"), "{said:?}");
}

#[test]
fn a_channel_is_chosen_by_the_name_that_is_shown() {
    // The other control sequence does not occur in text.
    let text = "# Channel: Height\u{9b}2J\n# Width: 3 um\n1 2\n3 4\n".as_bytes();
    let declared = ReadOptions { channel: "Height\\u{9b}2J".parse().ok(), ..ReadOptions::default() };
    let scan = Scan::from_bytes("a.txt", text, &declared);
    assert_eq!(scan.unwrap().metadata().name.as_deref(), Some("Height\\u{9b}2J"));
}
