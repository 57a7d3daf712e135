//! Self-affine rough surfaces and lines, deterministic indenters, and measures of them. Maps are rectangles
//! of equal cells, which need not be squares.
//!
//! How do you get a random rough surface that others can generate again? [`height_map`] and [`line()`] turn a
//! description ([`contact_model::Surface`]) and a seed into samples. Random surfaces follow Pohrt, Popov,
//! Filippov, Phys. Rev. E 86, 026710 (2012): Eqs. 2 to 5 for maps, and Eqs. 14 to 18 for lines.
//!
//! ```
//! use contact_model::SelfAffine;
//! use surface_gen::{rms_height, self_affine_map, surface_seed};
//! // Surface number 3 of an ensemble: D_f = 2.4, side 1, rms height 0.01, on 129 x 129 cells.
//! let map = self_affine_map(&SelfAffine::new(2.4, 1.0, 0.01)?, 129, surface_seed(1, 3))?;
//! assert!((rms_height(map.heights()) / 0.01 - 1.0).abs() < 1e-12);
//! # Ok::<(), contact_model::Error>(())
//! ```
//!
//! # Conventions
//!
//! * **Spectrum.** `C_2D(q)` is two-sided: its integral over the whole plane of wave vectors q is the
//!   variance of the heights. The field is the sum over *all* wave vectors, `h(x) = sum B cos(q x + phi)`,
//!   with the phases `phi(-q) = -phi(q)`. The amplitude is `B_2D = (2 pi / L) sqrt(C_2D)`, with
//!   `L = sqrt(Lx Ly)`.
//! * **Factor of 2.** The waves q and -q are one and the same cosine. They add to the amplitude 2 B, whose
//!   variance is 2 B^2. This is exactly the variance of the two cells of area `(2 pi)^2 / (Lx Ly)` that they
//!   represent. If all wave vectors are summed, Eqs. 4 and 5 therefore need no further factor. A sum over
//!   half of them needs `2 B`.
//! * **Line.** `C_1D = pi |q| C_2D` is two-sided as well. The length is `L_1D = (2 / sqrt(pi)) L`, and the
//!   amplitude is `B_1D = sqrt((2 pi / L_1D) C_1D)`. Eq. 15 as printed has the root over the first factor
//!   only, which has the wrong dimension.
//! * **Amplitudes are fixed**, and phases are random. With `Amplitude::RmsHeight(h)` every surface has the
//!   rms height h to rounding. With `Amplitude::Spectrum(c)`, c is `C_2D(2 pi / L)`, on the map and on the
//!   line that stands for it. A line and a map then have *different* rms heights, because their limits and
//!   lattices differ. Their ratio is 1.08 to 1.37 for 2^20 elements and N = 2048.
//! * **Waves.** The wave vectors are `q = 2 pi (i/Lx, j/Ly)` in the circle `0 < |q| <= pi / max(dx, dy)`, or
//!   up to the shorter `short_cutoff`. On a line the limit is pi / dx. Exponent, roll-off and cut-off act on
//!   |q|, so that surfaces are isotropic on any rectangle. Below `roll_off` the spectrum is constant. Nyquist
//!   waves of even grids are left out, because they cannot have a random phase. An axis of 1 or 2 cells
//!   carries no wave. If neither axis carries one, this is an error.
//! * **Sampling.** Samples are row-major, with x along a row. They are taken at the centres of the cells, and
//!   the phases have their origin in the corner of the rectangle. The same seed therefore gives the same
//!   surface on any grid, with more or fewer short waves. If the rms height is prescribed, the common factor
//!   changes too.
//! * **Given maps.** [`MapStatistics`] has the statistics that theories of rough contact need, and shows how
//!   well the map meets their assumptions. [`SelfAffineFit`] finds the Hurst exponent of a map, or the reason
//!   why it has none. [`LineGenerator::of_map`] draws the line that stands for a map. A map whose opposite
//!   edges differ is measured under Hann's window ([`windowed`]).
//! * **Other maps.** [`WaveGenerator`] draws maps with the amplitudes of any spectrum: artificial twins of a
//!   given map and anisotropic self-affine surfaces. [`PrescribedMap`] gives them a distribution of heights
//!   too.
//! * **Chance.** The phase of a wave is a function of (seed, i, j) alone. The random stream is specified in
//!   the source of [`map_phase`] and fixed by tests. It does not depend on the fractal dimension: surfaces of
//!   one seed and different D_f have the same phases.
//! * **Undefined points** are minus infinity in a given map. Rms height and slope leave them out. Spectra
//!   need every point.
//! * **Edges.** The field is periodic: a summit that an edge cuts continues at the opposite edge. This is not
//!   corrected.
//!
//! # Accuracy and speed
//!
//! The synthesis agrees with the direct sum over waves to 1e-12 of the rms height. The rms height has the
//! prescribed value to 1e-12. The bits do not depend on the number of threads. Another processor or another
//! version of the transform library may change the last digits.
//!
//! A map is drawn on the threads of the `rayon` pool in which it is called, or of the global pool outside of
//! any. On one core of a 2020s machine a map of 2049 x 2049 cells takes about 0.15 s, and a line of 2^20
//! elements about 6 ms. The memory is twice that of the map. To draw many surfaces, keep a [`MapGenerator`]
//! or a [`LineGenerator`].
//!
//! # What it does not do
//!
//! There are no Gaussian amplitudes, no resampling of given maps, no reading of files and no contact
//! mechanics. Parameters of standards, correlations and fits with intervals are in the crate
//! `surface-statistics`.

mod distribution;
mod hash;
mod indenter;
mod lattice;
mod line;
mod map;
mod measure;
mod memory;
#[doc(hidden)]
mod phases;
mod spectrum;
mod surface;
mod turn;
mod waves;

pub use distribution::{Exact, HeightDistribution, PrescribedMap};
pub use hash::surface_seed;
pub use line::{LineGenerator, self_affine_line};
pub use map::{MapGenerator, self_affine_map};
pub use measure::{
    Band, HeightMoments, MapEdges, MapPlane, MapStatistics, SelfAffineFit, Wave, boundary_edges,
    defined_everywhere, fit_range, full_contact_energy, hann_window, hurst_from_line_spectrum,
    hurst_from_spectrum, line_spectrum, patches, periodogram, radial_spectrum, rms_height, rms_slope,
    rms_slope_differences, windowed,
};
pub use memory::{height_map_memory, wave_map_memory};
pub use phases::{line_phase, map_phase};
pub use surface::{height_map, height_map_until, line};
pub use waves::{Anisotropy, TwinSpectrum, WaveGenerator};
