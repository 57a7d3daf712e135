//! Fig. 1: grey-scale maps of the surfaces.

use crate::evaluation::{FRACTAL_DIMENSION, Flag, Outcome, Run, Session, TableOf, header, list, read_rows};
use crate::judged::Judged;
use crate::output::{refused, save, write_npy};
use crate::{curves, words};
use contact_model::{HeightMap, SelfAffine};
use plots::{GreyMap, GreyScale, encode_grey, grey, grey_between, grey_maps, most};
use runs::{CsvFile, Error, Progress, Result, files, threads_for_memory};
use std::path::{Path, PathBuf};

/// The flags on which Fig. 1 depends.
pub const FLAGS: [Flag; 3] = [Flag::CELLS, Flag::FRACTAL_DIMENSIONS, Flag::SEED];

/// Largest side of a map in the CSV.
const CSV_SIDE: usize = 257;

/// Memory of drawing a surface and its pictures, bytes per cell.
const BYTES: f64 = 24.0;

/// Draws surface number 0 of each fractal dimension: `fig1.csv` (at most 257 x 257 a map), `fig1.svg`,
/// `fig1.png` (one grey scale for all maps), and at full size `fig1-df2.0.npy`, `fig1-df2.0.png`, ...
/// (darker = higher, the contrast of each map its own).
///
/// Source: Fig. 1 of the paper (2049 x 2049 cells, six fractal dimensions).
///
/// # Errors
/// Files that cannot be written, maps that do not fit in memory.
pub fn fig1(run: &Run, progress: &dyn Progress) -> Result<Judged> {
    threads_for_memory(1, BYTES * (run.cells as f64).powi(2), "cells", run.cells)?;
    let session = Session::open(&run.out, run.fresh)?;
    let dimensions = run.dimensions();
    let mut outcome = Outcome::new("fig1");
    let mut points = Vec::new();
    let seed = surface_gen::surface_seed(run.seed, 0);
    let (n, cost) = (run.cells, (run.cells * run.cells) as u64);
    progress
        .begin(&format!("{} surfaces of {n} x {n} cells", dimensions.len()), cost * dimensions.len() as u64);
    for &d in &dimensions {
        let map = SelfAffine::new(d, 1.0, 1.0)
            .and_then(|s| surface_gen::self_affine_map(&s, n, seed))
            .map_err(Error::model(format!("the surface of D_f = {d:?}")))?;
        sample(&mut points, d, &map);
        outcome.files.extend(full_size(&run.out, d, &map)?);
        progress.advance(cost, false);
    }
    progress.end();
    let table = TableOf::new("Fig. 1: self-affine surfaces", &points)
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |p| p[0])
        .column("x", "L", "centre of the cell", |p| p[1])
        .column("y", "L", "centre of the cell", |p| p[2])
        .column("height", "h", "in units of the rms height of the whole map, mean 0", |p| p[3])
        .table()?;
    let kept = n.min(CSV_SIDE);
    let header = header(run.command("reproduce-fig1", &FLAGS))
        .with_note(format!("fractal_dimensions: {}", list(&dimensions)))
        .with_note(format!("seed: {} (surface 0: {seed}; the same phases for every D_f)", run.seed))
        .with_note(format!(
            "map: {n} x {n} cells; here {kept} x {kept} of them, cell round(i ({n} - 1)/({kept} - 1)) in each direction, no smoothing"
        ));
    outcome.files.extend(curves::written(run, "fig1", &table, &header, |csv| draw(csv, &run.out))?);
    session.close(outcome).map(Judged::from)
}

/// The cells that the CSV keeps, along one direction.
fn kept(n: usize) -> Vec<usize> {
    let m = n.min(CSV_SIDE);
    (0..m).map(|i| (2 * i * (n - 1) + m - 1) / (2 * (m - 1).max(1))).collect()
}

/// Adds D_f, x, y and height of each cell that is kept.
fn sample(points: &mut Vec<[f64; 4]>, d: f64, map: &HeightMap) {
    let n = map.columns();
    let kept = kept(n);
    let centre = |i: usize| (i as f64 + 0.5) / n as f64;
    for &iy in &kept {
        points.extend(kept.iter().map(|&ix| [d, centre(ix), centre(iy), map.heights()[iy * n + ix]]));
    }
}

/// Rows from the top: y grows upwards in a picture.
fn flipped(values: &[u8], side: usize) -> Vec<u8> {
    values.chunks(side.max(1)).rev().flatten().copied().collect()
}

fn full_size(out: &Path, d: f64, map: &HeightMap) -> Result<[PathBuf; 2]> {
    let n = map.columns();
    let npy = out.join(format!("fig1-df{d:?}.npy"));
    write_npy(&npy, &[n, n], map.heights())?;
    let png = out.join(format!("fig1-df{d:?}.png"));
    let picture = encode_grey(&png.display().to_string(), n, &flipped(&grey(map.heights()), n));
    files::write_whole(&png, &picture.map_err(refused)?)?;
    Ok([npy, png])
}

/// Draws `fig1.svg` and `fig1.png` from the table.
pub(crate) fn draw(csv: &Path, out: &Path) -> Result<Vec<PathBuf>> {
    let file = CsvFile::read(csv)?;
    let rows: Vec<[f64; 4]> = read_rows(csv, &file)?;
    // One scale for all maps: each has the rms height 1.
    let ends = most(&rows.iter().map(|row| row[3]).collect::<Vec<_>>());
    let map = |cells: &[[f64; 4]]| {
        let side = cells.len().isqrt();
        let shades = grey_between(&cells.iter().map(|cell| cell[3]).collect::<Vec<_>>(), ends);
        GreyMap { label: words::dimension(cells[0][0]), shades: flipped(&shades, side), side }
    };
    let maps = rows.chunk_by(|a, b| a[0].total_cmp(&b[0]).is_eq()).map(map).collect();
    let cells = words::flag(&file, "--cells").map(|n| format!("{n} × {n} cells, "));
    let below =
        format!("{}sides $L$, the same phases for every $D_{{\\rm{{f}}}}$", cells.unwrap_or_default());
    let scale = GreyScale { ends, label: "height, in units of the rms height $h$".into() };
    save(grey_maps(maps, &scale, (&words::title(&file), &below), "fig1"), out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kept_cells_reach_both_edges() {
        assert_eq!(kept(4), [0, 1, 2, 3]);
        let k = kept(2049);
        assert_eq!((k.len(), k[0], k[1], k[256]), (257, 0, 8, 2048));
        assert!(kept(300).windows(2).all(|w| w[0] < w[1]));
    }
}
