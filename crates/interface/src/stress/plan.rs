//! The stress in planes below the surface, by transforms.

use super::cell::{RectangularCell, strip};
use super::load::{PeriodicLoad, StressedBody, SurfaceLoad, check_memory, scaled_depths};
use super::plane::StressField;
use super::potentials::{KERNEL_OF, KERNELS, ODD, PRESSURE_KERNELS, Potentials};
use super::wave::{CellWaves, wave};
use contact_model::{Boundary, Cells, Error, Field, Interrupted, Result, Stop, check_stop};
use numerics::fourier::{Complex64, ForwardTransform, InverseTransform, fast_length};
use numerics::parallel::{for_each_until, map, threads_for};

/// Distance of the copies across a line, over the period, beyond the map itself: the waves along the line
/// cause `exp(-2 pi 5.6)` = 5e-16 of their stress there.
const CLEARANCE: f64 = 5.6;
/// Work of the influence functions of a pair of cells, in elements of a vector loop.
const PAIR: usize = 64;
/// Influence functions, one of each parity at most, whose sum is transformed as one: even, odd in both, odd
/// in x, odd in y. The parts of the sum are told apart by the symmetries of its waves.
const GROUPS: [[Option<usize>; 4]; 5] = [
    [Some(0), Some(5), Some(4), Some(3)],
    [Some(1), Some(10), Some(6), Some(8)],
    [Some(2), None, Some(7), Some(11)],
    [Some(9), None, Some(13), Some(12)],
    [Some(14), None, None, None],
];
/// Groups that a pressure needs, which are the first ones.
const PRESSURE_GROUPS: usize = 3;

/// The stress below the surface of a body, planned once for any number of depths.
///
/// The plan holds the waves of the load. [`SubsurfaceStress::at_depth`] takes the influence functions of one
/// depth, multiplies and transforms back.
#[derive(Debug)]
pub struct SubsurfaceStress<'a> {
    load: &'a SurfaceLoad,
    body: StressedBody,
    /// The largest traction, in units of which the load is transformed.
    scale: f64,
    grid: TransformGrid,
    /// The axis along which each acts, and its waves.
    waves: Vec<(usize, Vec<Complex64>)>,
    inverse: InverseTransform,
}

/// The cells of a transform. A map that repeats itself along y alone is turned.
#[derive(Debug, Clone, Copy)]
struct TransformGrid {
    turned: bool,
    cells: Cells,
    /// Sides of a cell, in units of c.
    sides: [f64; 2],
    columns: usize,
    rows: usize,
}

impl TransformGrid {
    fn new(load: &SurfaceLoad, boundary: Boundary) -> Result<Self> {
        let turned = boundary == Boundary::PeriodicAlongY;
        let (_, [a, b]) = load.unit();
        let Cells { columns, rows } = load.cells();
        let (cells, sides) = if turned {
            (Cells { columns: rows, rows: columns }, [b, a])
        } else {
            (Cells { columns, rows }, [a, b])
        };
        let twice = |count: usize| fast_length(count.saturating_mul(2).saturating_sub(1), 1);
        let (columns, rows) = match boundary {
            Boundary::Free => (twice(cells.columns), twice(cells.rows)),
            Boundary::Periodic => (cells.columns, cells.rows),
            Boundary::PeriodicAlongX | Boundary::PeriodicAlongY => {
                let clear = (CLEARANCE * cells.columns as f64 * sides[0] / sides[1]).ceil();
                // Checked before a length is sought near such a number.
                check_memory(load.cells(), 8.0 * cells.columns as f64 * clear)?;
                (cells.columns, fast_length((cells.rows + clear as usize).max(2 * cells.rows - 1), 1))
            }
            // A boundary that this crate does not know.
            _ => return Err(Error::unsupported("stress below the surface", boundary.words())),
        };
        Ok(Self { turned, cells, sides, columns, rows })
    }

    /// Columns and rows of the waves that are not told by a symmetry.
    fn quarter(self) -> [usize; 2] {
        [self.columns / 2 + 1, self.rows / 2 + 1]
    }

    fn points(self) -> f64 {
        self.columns as f64 * self.rows as f64
    }

    /// The waves of the quarter along each axis.
    fn wave_numbers(self) -> [Vec<f64>; 2] {
        let along = |half: usize, points: usize, side: f64| {
            (0..half).map(|m| std::f64::consts::TAU * m as f64 / (points as f64 * side)).collect()
        };
        let [half_x, half_y] = self.quarter();
        [along(half_x, self.columns, self.sides[0]), along(half_y, self.rows, self.sides[1])]
    }
}

/// Values of the influence functions at the waves of a quarter, `[(mx * half + my) * count + kernel]`.
///
/// A function that is odd along an axis has a factor i for it, and changes its sign with the wave number.
struct Spectra {
    count: usize,
    values: Vec<f64>,
}

impl<'a> SubsurfaceStress<'a> {
    /// Plans the stress below a load.
    ///
    /// Cost: one real transform for each component of the load, of four times the cells of the map with free
    /// boundaries. [`SubsurfaceStress::memory`] has the bytes.
    ///
    /// # Errors
    /// [`Error::Domain`] for Poisson's ratio; [`Error::OutOfMemory`] where the memory cannot be had.
    pub fn new(load: &'a SurfaceLoad, body: StressedBody) -> Result<Self> {
        body.validate()?;
        let grid = TransformGrid::new(load, body.boundary)?;
        check_memory(load.cells(), memory(load, grid))?;
        let scale = load.largest();
        let forward = ForwardTransform::new(grid.columns, grid.rows);
        let waves = load.components().into_iter().map(|(axis, field)| {
            let axis = if grid.turned && axis < 2 { 1 - axis } else { axis };
            (axis, forward.of(|iy, row| fill(field, grid, scale, iy, row)))
        });
        let waves = if scale > 0.0 { waves.collect() } else { Vec::new() };
        let inverse = InverseTransform::new(grid.columns, grid.rows);
        Ok(Self { load, body, scale, grid, waves, inverse })
    }

    /// The load.
    pub fn load(&self) -> &SurfaceLoad {
        self.load
    }

    /// Bytes that the plan and one depth need at their peak, approximately. With free boundaries those are
    /// about 30 maps, and 60 with tractions; each further thread adds up to 4 of them.
    pub fn memory(&self) -> f64 {
        memory(self.load, self.grid)
    }

    /// The stress at the centres of all cells at a depth >= 0.
    ///
    /// Cost O(N log N) for N cells. The error is about 1e-14 of the largest stress at this depth.
    ///
    /// # Errors
    /// [`Error::Domain`] for a depth that is negative, not finite, or beyond 1e60 sides of a cell, and for a
    /// stress that no `f64` holds; [`Error::OutOfMemory`]; [`Error::Stopped`] where `stop` says so.
    pub fn at_depth(&self, depth: f64, stop: Stop<'_>) -> Result<StressField> {
        let z = scaled_depths(self.load, &[depth])?[0];
        check_stop(stop)?;
        check_memory(self.load.cells(), memory(self.load, self.grid))?;
        let (cells, size) = (self.load.cells(), self.load.size());
        if self.waves.is_empty() {
            return StressField::new(
                depth,
                cells,
                size,
                std::array::from_fn(|_| vec![0.0; self.load.pressure().values().len()]),
            );
        }
        let spectra = self.spectra(z, stop)?;
        let mut components: [Vec<f64>; 6] = Default::default();
        for (component, to) in components.iter_mut().enumerate() {
            *to = self.component(component, &spectra, stop)?;
        }
        if self.grid.turned {
            let [xx, yy, zz, yz, xz, xy] = components.map(|values| transposed(&values, self.grid.cells));
            components = [yy, xx, zz, xz, yz, xy];
        }
        if let Some(value) = components.iter().flatten().find(|value| !value.is_finite()) {
            return Err(Error::not_representable("stress", *value));
        }
        StressField::new(depth, cells, size, components)
    }

    fn tractions(&self) -> bool {
        self.waves.len() > 1
    }

    fn spectra(&self, z: f64, stop: Stop<'_>) -> Result<Spectra> {
        match self.body.boundary {
            Boundary::Free => self.free(z, stop),
            Boundary::Periodic => {
                let mut spectra = self.periodic(z, stop)?;
                spectra.values[..spectra.count].copy_from_slice(&mean(self.body.poisson)[..spectra.count]);
                Ok(spectra)
            }
            _ => {
                let mut spectra = self.periodic(z, stop)?;
                self.replace_mean_along_line(&mut spectra, z);
                Ok(spectra)
            }
        }
    }

    /// The waves of the influence functions between cells.
    fn free(&self, z: f64, stop: Stop<'_>) -> Result<Spectra> {
        let TransformGrid { cells, sides, .. } = self.grid;
        let count = self.kernels();
        let cell = RectangularCell::new(sides);
        let mut table = vec![0.0; cells.columns * cells.rows * count];
        let mut threads = vec![(); threads_for(PAIR * cells.columns * cells.rows)];
        let rows = table.chunks_mut(cells.columns * count).enumerate();
        let all = for_each_until(&mut threads, rows, &|| stop.stops(), |(), (iy, row)| {
            for (ix, to) in row.chunks_exact_mut(count).enumerate() {
                let potentials = cell.potentials([ix as f64 * sides[0], iy as f64 * sides[1], z]);
                to.copy_from_slice(&potentials.kernels(self.body.poisson)[..count]);
            }
        });
        if !all {
            return Err(Interrupted.without_state());
        }
        let lags = Lags { cells, count, table };
        lags.transform([self.grid.columns, self.grid.rows], stop)
    }

    /// The influence functions of the waves of the grid with their aliases.
    fn periodic(&self, z: f64, stop: Stop<'_>) -> Result<Spectra> {
        let TransformGrid { sides, .. } = self.grid;
        let poisson = self.body.poisson;
        let (count, [_, half]) = (self.kernels(), self.grid.quarter());
        let numbers = self.grid.wave_numbers();
        let of_cells = self.body.periodic == PeriodicLoad::Cells;
        let cell_waves = CellWaves::new(sides, poisson);
        let aliases = if of_cells {
            let aliases = cell_waves.aliases([&numbers[0], &numbers[1]], z, count, stop);
            aliases.map_err(Interrupted::without_state)?
        } else {
            None
        };
        let mut values = vec![0.0; numbers[0].len() * half * count];
        let mut threads = vec![(); threads_for(PAIR * numbers[0].len() * half)];
        let columns = values.chunks_mut(half * count).enumerate();
        let all = for_each_until(&mut threads, columns, &|| stop.stops(), |(), (mx, column)| {
            if let Some(aliases) = &aliases {
                aliases.add(mx, column);
            }
            for (my, to) in column.chunks_exact_mut(count).enumerate().skip(usize::from(mx == 0)) {
                let k = [numbers[0][mx], numbers[1][my]];
                let factor = if of_cells { cell_waves.mean_over_cell(k) } else { 1.0 };
                let shortest = [2 * mx == self.grid.columns, 2 * my == self.grid.rows];
                for ((to, kernel), odd) in to.iter_mut().zip(wave(k, z).kernels(poisson)).zip(ODD) {
                    // At the centres of cells the shortest wave vanishes a quarter of its length further.
                    let vanishes = (odd[0] && shortest[0]) || (odd[1] && shortest[1]);
                    *to = if vanishes { 0.0 } else { factor * (*to + kernel) };
                }
            }
        });
        if all { Ok(Spectra { count, values }) } else { Err(Interrupted.without_state()) }
    }

    /// Puts endless strips, which the mean along the line consists of, in the place of waves along y alone.
    fn replace_mean_along_line(&self, spectra: &mut Spectra, z: f64) {
        let TransformGrid { cells, sides, rows, .. } = self.grid;
        let count = spectra.count;
        let mut table = Vec::with_capacity(cells.rows * count);
        for iy in 0..cells.rows {
            let kernels = strip(iy as f64 * sides[1], z, sides[1]).kernels(self.body.poisson);
            table.extend_from_slice(&kernels[..count]);
        }
        let lags = Lags { cells: Cells { columns: 1, rows: cells.rows }, count, table };
        let forward = ForwardTransform::new(1, rows);
        for group in &GROUPS[..lags.groups()] {
            let waves = forward.of(|iy, row| lags.fill(group, [1, rows], iy, row));
            lags.separate(group, rows, &waves, &mut spectra.values);
        }
    }

    fn kernels(&self) -> usize {
        if self.tractions() { KERNELS } else { PRESSURE_KERNELS }
    }

    /// One component of the stress on the cells of the grid.
    fn component(&self, component: usize, spectra: &Spectra, stop: Stop<'_>) -> Result<Vec<f64>> {
        let [half_x, half_y] = self.grid.quarter();
        let rows = self.grid.rows;
        let factor = 1.0 / self.grid.points();
        let fill = |mx: usize, column: &mut [Complex64]| {
            for (axis, waves) in &self.waves {
                let kernel = KERNEL_OF[component][*axis];
                let [odd_x, odd_y] = ODD[kernel];
                for (my, (to, load)) in column.iter_mut().zip(&waves[mx * rows..]).enumerate() {
                    let mirrored = my >= half_y;
                    let place = if mirrored { rows - my } else { my };
                    let value = factor * spectra.values[(mx * half_y + place) * spectra.count + kernel];
                    let value = if mirrored && odd_y { -value } else { value };
                    *to += match (odd_x, odd_y) {
                        (false, false) => load * value,
                        (true, true) => -load * value,
                        _ => Complex64::new(-load.im * value, load.re * value),
                    };
                }
            }
        };
        let padded = self.inverse.of_until(half_x, fill, &|| stop.stops());
        let padded = padded.ok_or_else(|| Interrupted.without_state())?;
        let Cells { columns, rows } = self.grid.cells;
        let inside = padded.chunks_exact(self.grid.columns).take(rows).flat_map(|row| &row[..columns]);
        Ok(inside.map(|value| self.scale * value).collect())
    }
}

/// Influence functions at the lags that are not negative, `[(iy * columns + ix) * count + kernel]`.
struct Lags {
    cells: Cells,
    count: usize,
    table: Vec<f64>,
}

impl Lags {
    fn groups(&self) -> usize {
        if self.count == PRESSURE_KERNELS { PRESSURE_GROUPS } else { GROUPS.len() }
    }

    fn transform(self, [columns, rows]: [usize; 2], stop: Stop<'_>) -> Result<Spectra> {
        let forward = ForwardTransform::new(columns, rows);
        let mut values = vec![0.0; (columns / 2 + 1) * (rows / 2 + 1) * self.count];
        let threads = threads_for(columns * rows);
        for batch in GROUPS[..self.groups()].chunks(threads) {
            check_stop(stop)?;
            let waves = map(columns * rows, batch.iter(), |group| {
                forward.of(|iy, row| self.fill(group, [columns, rows], iy, row))
            });
            for (group, waves) in batch.iter().zip(&waves) {
                self.separate(group, rows, waves, &mut values);
            }
        }
        Ok(Spectra { count: self.count, values })
    }

    /// The sum of a group at the lags of row `iy` of a transform.
    fn fill(&self, group: &[Option<usize>; 4], [columns, rows]: [usize; 2], iy: usize, row: &mut [f64]) {
        let Some((lag_y, sign_y)) = lag(iy, self.cells.rows, rows) else { return };
        for kernel in group.iter().flatten().filter(|kernel| **kernel < self.count) {
            let [odd_x, odd_y] = ODD[*kernel];
            let sign = if odd_y { sign_y } else { 1.0 };
            for (ix, to) in row.iter_mut().enumerate() {
                if let Some((lag_x, sign_x)) = lag(ix, self.cells.columns, columns) {
                    let value = self.table[(lag_y * self.cells.columns + lag_x) * self.count + kernel];
                    *to += sign * if odd_x { sign_x * value } else { value };
                }
            }
        }
    }

    /// The influence functions of a group from the waves of their sum: even ones have real waves that are
    /// even in my, and so on.
    fn separate(&self, group: &[Option<usize>; 4], rows: usize, waves: &[Complex64], values: &mut [f64]) {
        let half = rows / 2 + 1;
        for (mx, column) in waves.chunks_exact(rows).enumerate() {
            for my in 0..half {
                let (plus, minus) = (column[my], column[(rows - my) % rows]);
                let (even, odd) = (0.5 * (plus + minus), 0.5 * (plus - minus));
                // The last two are i times the real number; of the second one i^2 is taken out.
                let parts = [even.re, -odd.re, even.im, odd.im];
                let to = &mut values[(mx * half + my) * self.count..][..self.count];
                for (kernel, part) in group.iter().zip(parts) {
                    if let Some(to) = kernel.and_then(|kernel| to.get_mut(kernel)) {
                        *to = part;
                    }
                }
            }
        }
    }
}

/// The lag of a place of a transform and its sign, which is 0 at no lag; `None` between the lags of the map.
fn lag(place: usize, cells: usize, points: usize) -> Option<(usize, f64)> {
    if place < cells {
        Some((place, if place == 0 { 0.0 } else { 1.0 }))
    } else {
        let back = points - place;
        (back < cells).then_some((back, -1.0))
    }
}

/// Writes row `iy` of the load, turned as the grid, in units of `scale`.
fn fill(field: &Field, grid: TransformGrid, scale: f64, iy: usize, row: &mut [f64]) {
    if iy >= grid.cells.rows {
        return;
    }
    for (ix, to) in row[..grid.cells.columns].iter_mut().enumerate() {
        *to = if grid.turned { field.at(iy, ix) } else { field.at(ix, iy) } / scale;
    }
}

/// The influence functions of a uniform load on every copy of the map, of a body that cannot expand
/// laterally.
fn mean(poisson: f64) -> [f64; KERNELS] {
    let mut uniform = Potentials::default().kernels(poisson);
    uniform[0] = -poisson / (1.0 - poisson);
    uniform[1] = uniform[0];
    for shear_or_normal in [2, 9, 14] {
        uniform[shear_or_normal] = -1.0;
    }
    uniform
}

fn transposed(values: &[f64], Cells { columns, rows }: Cells) -> Vec<f64> {
    (0..columns).flat_map(|ix| (0..rows).map(move |iy| values[iy * columns + ix])).collect()
}

/// Bytes of a plan and one depth.
fn memory(load: &SurfaceLoad, grid: TransformGrid) -> f64 {
    let loads = load.components().len();
    let (kernels, maps) = if loads > 1 { (KERNELS, loads) } else { (PRESSURE_KERNELS, loads) };
    let (map, points) = (load.cells().map_bytes(), 8.0 * grid.points());
    // Lags and their waves, or the waves and two transforms; the load and its waves; the result.
    let table = if grid.columns > load.cells().columns { kernels as f64 * map } else { 0.0 };
    let spectra = 0.25 * kernels as f64 * points;
    let batch = threads_for(grid.points() as usize).min(GROUPS.len()) as f64 * points;
    let work = spectra + (table + batch).max(2.0 * points);
    work + maps as f64 * (map + points) + 7.0 * map
}
