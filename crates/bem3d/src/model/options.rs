//! Numerics of the boundary-element model.

use crate::kernel::PeriodicKernel;
use contact_model::{Cells, Output, RequiredMemory, Scene, Size, Surface};

/// Name of the model.
pub const NAME: &str = "bem3d";

/// Memory of one surface under light loads, bytes for each cell, the drawing of the surface included: the
/// largest of `peak_memory_bytes` in `data/bench/scaling.csv`, rounded up.
pub const BYTES_PER_CELL: f64 = 50.0;

/// Numerics of the boundary-element model.
///
/// ```
/// use bem3d::Bem3d;
/// use contact_model::{ContactModel, Load, Scene, Surface};
/// // Two cells a side, all four in contact: k = 0.993186221 E* L (data/paper/VALUES.md).
/// let model = Bem3d { cells: 2, ..Bem3d::default() };
/// let scene = Scene::new(Surface::Flat { size: 1.0.into() }, 1.0);
/// let state = model.prepare(&scene, 0)?.solve(Load::force(1.0))?;
/// assert!((state.stiffness.unwrap() - 0.993186221).abs() < 1e-9);
/// # Ok::<(), contact_model::Error>(())
/// ```
///
/// A load is solved from no contact; a path is followed where an effect remembers it, a hardness or adhesion:
///
/// ```
/// use bem3d::{Bem3d, ContactModel, Hardness, Load, Scene, Step, Surface};
/// // A sphere is pressed until its middle flows, and unloaded: the indentation stays.
/// let mut scene = Scene::new(Surface::Sphere { radius: 1.0, size: 1.0.into() }, 1.0);
/// scene.effects.hardness = Hardness::Limit { pressure: 0.1 };
/// let mut contact = Bem3d { cells: 32, ..Bem3d::default() }.prepare(&scene, 0)?;
/// let loaded = contact.advance(Step::new(1.0, Load::force(0.02)))?.plastic.unwrap();
/// let unloaded = contact.advance(Step::new(2.0, Load::force(0.0)))?.plastic.unwrap();
/// assert!(loaded.area > 0.0 && unloaded.area == 0.0 && unloaded.volume == loaded.volume);
/// # Ok::<(), bem3d::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bem3d {
    /// Number of columns, N >= 1. Ignored where the scene brings its own map.
    pub cells: usize,
    /// Number of rows; `None`: as many as make the cells nearly square ([`Cells::nearly_square`]).
    pub rows: Option<usize>,
    /// Bound t of the certificate and of the estimated relative error of k
    /// ([`contact_model::Certificate::meets`]).
    ///
    /// The certificate measures gaps in rms heights, so that at a prescribed force the error of the approach
    /// is a few t (at worst about ten) times the rms height, not times the approach itself: a light load on a
    /// rough surface needs a smaller t for a precise d.
    pub tolerance: f64,
    /// Largest number of outer iterations (each needs a few operator applications).
    pub max_outer_iterations: usize,
    /// How small sets are solved.
    pub method: Method,
    /// The pressures for which the kernel of periodic boundaries is exact: uniform on cells, or waves.
    pub periodic_kernel: PeriodicKernel,
    /// Largest error that one step of time of a viscoelastic history may add, relative to the largest value of what is
    /// not prescribed, the force or the distance: steps are as long as it allows. States say how large the errors of all
    /// steps together are ([`contact_model::ViscoelasticState`]). Elastic contacts take no notice of it.
    pub time_tolerance: f64,
}

/// How the linear systems of one contact set are solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// Factorise small sets and iterate on large ones, whichever is cheaper.
    #[default]
    Auto,
    /// Iterate always.
    Iterative,
    /// One grid and one operator, for comparison: no factorisation, no two-level operator, no nested
    /// iteration.
    SingleLevel,
}

impl Method {
    /// All, in the order of tables.
    pub const ALL: [Self; 3] = [Self::Auto, Self::Iterative, Self::SingleLevel];

    /// Its word in scenes and tables.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Iterative => "iterative",
            Self::SingleLevel => "single_level",
        }
    }
}

impl Bem3d {
    /// The options that a scene has without its own.
    pub const DEFAULT: Self = Self {
        cells: 257,
        rows: None,
        tolerance: 1e-6,
        max_outer_iterations: 200,
        method: Method::Auto,
        periodic_kernel: PeriodicKernel::Cells,
        time_tolerance: 1e-3,
    };

    /// The grid on a rectangle of this size.
    pub fn grid(&self, size: Size) -> Cells {
        let nearly_square = Cells::nearly_square(self.cells, size);
        Cells { rows: self.rows.unwrap_or(nearly_square.rows), ..nearly_square }
    }

    /// The lowest memory need of planning and of a light load, with the requested fields.
    pub(super) fn memory(&self, scene: &Scene) -> RequiredMemory {
        let cells = match &scene.surface {
            Surface::Heights(map) | Surface::Profile(map) => map.cells(),
            surface => self.grid(surface.size()),
        };
        let fields = scene.outputs.asked().filter_map(Output::field);
        let fields = fields.map(|field| field.components).sum::<usize>() as f64;
        let Cells { columns, rows } = cells;
        RequiredMemory {
            what: format!("a contact of {columns} columns x {rows} rows").into(),
            bytes: columns as f64 * rows as f64 * BYTES_PER_CELL + fields * cells.map_bytes(),
        }
    }
}

impl Default for Bem3d {
    fn default() -> Self {
        Self::DEFAULT
    }
}
