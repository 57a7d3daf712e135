//! Checks the links of the built pages: both file and anchor have to exist.

use runs::{Error, Result};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The result of a check.
pub struct BuiltCheck {
    /// Pages read.
    pub pages: usize,
    /// Links within the pages and to files beside them, pictures and scripts among them.
    pub links: usize,
    /// `page: link: what is wrong`.
    pub broken: Vec<String>,
}

/// Checks all pages below a folder.
pub fn check(folder: &Path) -> Result<BuiltCheck> {
    let mut texts = BTreeMap::new();
    collect(folder, &mut texts)?;
    let anchors: BTreeMap<&Path, BTreeSet<String>> = texts
        .iter()
        .map(|(page, text)| (page.as_path(), attributes(text, &["id", "name"]).into_iter().collect()))
        .collect();
    let mut found = BuiltCheck { pages: texts.len(), links: 0, broken: Vec::new() };
    for (page, text) in &texts {
        let links: BTreeSet<String> = attributes(text, &["href", "src"]).into_iter().collect();
        for link in links.iter().filter(|link| !leaves(link)) {
            found.links += 1;
            if let Some(wrong) = wrong(page, link, &anchors) {
                let name = page.strip_prefix(folder).unwrap_or(page).display();
                found.broken.push(format!("{name}: {link}: {wrong}"));
            }
        }
    }
    Ok(found)
}

fn collect(folder: &Path, texts: &mut BTreeMap<PathBuf, String>) -> Result<()> {
    for entry in fs::read_dir(folder).map_err(Error::file("list", folder))? {
        let path = entry.map_err(Error::file("list", folder))?.path();
        if path.is_dir() {
            collect(&path, texts)?;
        } else if path.extension().is_some_and(|extension| extension == "html") {
            let text = fs::read_to_string(&path).map_err(Error::file("read", &path))?;
            let path = path.canonicalize().map_err(Error::file("find", &path))?;
            texts.insert(path, text);
        }
    }
    Ok(())
}

/// Values of attributes of these names, without the escapes of HTML. Quotes in the words of a page are escaped.
fn attributes(text: &str, names: &[&str]) -> Vec<String> {
    let of = |name: &&str| {
        let begin = format!(" {name}=\"");
        let values = text.split(begin.as_str()).skip(1).filter_map(|after| after.split('"').next());
        values.map(|value| value.replace("&amp;", "&").replace("&#39;", "'")).collect::<Vec<_>>()
    };
    names.iter().flat_map(of).collect()
}

/// Whether a link leads to another site or holds its data itself.
fn leaves(link: &str) -> bool {
    link.contains("://") || ["data:", "mailto:", "javascript:"].iter().any(|scheme| link.starts_with(scheme))
}

fn wrong(page: &Path, link: &str, anchors: &BTreeMap<&Path, BTreeSet<String>>) -> Option<String> {
    let (path, anchor) = link.split_once('#').map_or((link, None), |(path, anchor)| (path, Some(anchor)));
    let path = path.split('?').next().unwrap_or_default();
    let target = match path {
        "" => page.to_owned(),
        path => match page.with_file_name("").join(decoded(path)).canonicalize() {
            Ok(target) => target,
            Err(_) => return Some("no such file".into()),
        },
    };
    // The top of a page has no name.
    let anchor = decoded(anchor.filter(|anchor| !anchor.is_empty())?);
    match anchors.get(target.as_path()) {
        Some(there) => (!there.contains(&anchor)).then(|| format!("no anchor #{anchor}")),
        None => Some("an anchor in a file that is no page".into()),
    }
}

/// `%20` as a space.
fn decoded(text: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = text.as_bytes();
    while let [first, after @ ..] = rest {
        let code = match (first, after) {
            (b'%', [a, b, ..]) => {
                std::str::from_utf8(&[*a, *b]).ok().and_then(|hex| u8::from_str_radix(hex, 16).ok())
            }
            _ => None,
        };
        bytes.push(code.unwrap_or(*first));
        rest = &after[if code.is_some() { 2 } else { 0 }..];
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dead_files_and_anchors_are_found() {
        let dir = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(dir.path().join(name), text).unwrap();
        write("b c.html", "<h1 id=\"über\">t</h1>");
        write(
            "a.html",
            "<a href=\"b%20c.html#%C3%BCber\"></a> <a href=\"#\"></a> <a href=\"https://x.org/y\"></a> &lt;a href=&quot;no&quot;&gt; \
             <a href=\"b%20c.html#gone\"></a> <img src=\"none.png\">",
        );
        let found = check(dir.path()).unwrap();
        assert_eq!((found.pages, found.links), (2, 4));
        let expected = ["a.html: b%20c.html#gone: no anchor #gone", "a.html: none.png: no such file"];
        assert_eq!(found.broken, expected);
    }
}
