//! Every mistake has its message: `data/scenes/bad/*.toml` beside the text that is stored for it. With
//! `BLESS=1` the texts are stored anew.

use fractal_contact::scenes::{Plan, SceneFile};
use std::path::{Path, PathBuf};

/// Lines and columns of a screen.
const SCREEN: (usize, usize) = (24, 300);

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/scenes/bad")
}

/// The message, with the folder left out of paths.
fn message(path: &Path) -> String {
    let error =
        SceneFile::read(path).and_then(|scene| Plan::new(&scene)).expect_err(&path.display().to_string());
    error.to_string().replace(&format!("{}/", folder().display()), "") + "\n"
}

#[test]
fn every_bad_scene_has_the_message_stored_for_it() {
    let bless = std::env::var_os("BLESS").is_some();
    let mut count = 0;
    for entry in std::fs::read_dir(folder()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        count += 1;
        let text = message(&path);
        assert!(
            text.lines().count() <= SCREEN.0 && text.lines().all(|l| l.chars().count() <= SCREEN.1),
            "{text}"
        );
        assert!(text.contains("= help: "), "no remedy: {text}");
        let stored = path.with_extension("txt");
        if bless {
            std::fs::write(&stored, &text).unwrap();
        }
        assert_eq!(std::fs::read_to_string(&stored).unwrap_or_default(), text, "{}", path.display());
    }
    assert!(count >= 30);
}

#[test]
fn all_but_whole_files_are_shown_at_their_line() {
    for name in
        ["unknown-effect", "negative-modulus", "missing-unit", "contradictory-loads", "surface-truncated"]
    {
        let text = message(&folder().join(name).with_extension("toml"));
        assert!(text.contains("^^") || text.contains(" ^\n"), "{text}");
        assert!(text.contains(&format!("--> {name}.toml:")), "{text}");
    }
}

/// A scene cut anywhere, or with any byte replaced, is read or refused, never a panic.
#[test]
fn mutilated_scenes_are_refused_or_read() {
    let whole = std::fs::read_to_string(folder().join("../cattaneo-mindlin-loop.toml")).unwrap();
    let path = Path::new("a.toml");
    for at in (0..whole.len()).filter(|i| whole.is_char_boundary(*i)) {
        let _ = SceneFile::parse(path, whole[..at].to_owned()).map_err(|e| e.to_string());
        for replaced in ["\"", "[", "\0", "é", "-", "9e999", "\n"] {
            let text = format!("{}{replaced}{}", &whole[..at], whole.get(at + 1..).unwrap_or_default());
            let _ = SceneFile::parse(path, text).map_err(|e| e.to_string());
        }
    }
}
