//! Derivatives of the potentials of Boussinesq and Cerruti, and the stress that follows from them.
//!
//! A body fills z >= 0. With the distance r from a point of its surface, a load on the surface has the
//! potentials `V = int 1/r`, `W = int ln(r + z)` and `U = int z ln(r + z) - r`, each the derivative of the
//! next with respect to z. For a unit pressure, or a unit traction along x or y, in the place of the load all
//! stresses are sums of derivatives of these three (K. L. Johnson, Contact Mechanics, 1985, Eqs. 3.2 to 3.7,
//! with G, lambda and the displacements eliminated), for instance
//!
//! `2 pi sigma_xx = 2 nu V_z - (1 - 2 nu) W_xx - z V_xx` under a pressure, and
//! `2 pi sigma_xx = 2 (1 + nu) V_x + 2 nu U_xxx - z W_xxx` under a traction along x.
//!
//! The derivatives are known in closed form for a force on a point, a load on a rectangle, a load on an
//! endless strip, and a wave. Only they differ between these loads, and the elasticity stands here once.

/// Number of derivatives in [`Potentials`].
const DERIVATIVES: usize = 15;

/// Number of different influence functions: six of a pressure and nine of tractions.
///
/// There are eighteen components under three loads. By reciprocity sigma_zz of a traction is sigma_xz or
/// sigma_yz of a pressure, and both tractions cause the same shear across each other.
pub const KERNELS: usize = 15;

/// Number of influence functions of a pressure, which are the first ones.
pub const PRESSURE_KERNELS: usize = 6;

/// The influence function of each component (xx, yy, zz, yz, xz, xy) under a traction along x, one along y,
/// and a pressure.
pub const KERNEL_OF: [[usize; 3]; 6] =
    [[6, 11, 0], [7, 12, 1], [4, 3, 2], [10, 14, 3], [9, 10, 4], [8, 13, 5]];

/// Whether each influence function is odd in the distance along x, and along y.
pub const ODD: [[bool; 2]; KERNELS] = [
    [false, false],
    [false, false],
    [false, false],
    [false, true],
    [true, false],
    [true, true],
    [true, false],
    [true, false],
    [false, true],
    [false, false],
    [true, true],
    [false, true],
    [false, true],
    [true, false],
    [false, false],
];

/// `V_x, V_y, V_z, W_xx, W_yy, W_xy, z V_xx, z V_yy, z V_xy, z V_xz, z V_yz, z W_xxy, z W_xyy, U_xxy, U_xyy`,
/// in this order. The others follow from Laplace's equation.
#[derive(Debug, Clone, Copy, Default)]
pub struct Potentials(pub [f64; DERIVATIVES]);

impl Potentials {
    /// Adds `factor` times others.
    pub fn add(&mut self, factor: f64, others: &Self) {
        for (sum, term) in self.0.iter_mut().zip(&others.0) {
            *sum += factor * term;
        }
    }

    /// The influence functions, in the order of [`KERNEL_OF`].
    pub fn kernels(&self, poisson: f64) -> [f64; KERNELS] {
        let [vx, vy, vz, wxx, wyy, wxy, zvxx, zvyy, zvxy, zvxz, zvyz, zwxxy, zwxyy, uxxy, uxyy] = self.0;
        let (twice, rest) = (2.0 * poisson, 1.0 - 2.0 * poisson);
        // Common to the lateral components under a traction along x, and under one along y.
        let (along_x, along_y) = (twice * uxyy - zwxyy, twice * uxxy - zwxxy);
        let kernels = [
            twice * vz - rest * wxx - zvxx,
            twice * vz - rest * wyy - zvyy,
            vz + zvxx + zvyy,
            -zvyz,
            -zvxz,
            -rest * wxy - zvxy,
            2.0 * vx - along_x + zvxz,
            twice * vx + along_x,
            vy + along_y,
            vz - zvxx,
            -zvxy,
            twice * vy + along_y,
            2.0 * vy - along_y + zvyz,
            vx + along_x,
            vz - zvyy,
        ];
        kernels.map(|kernel| kernel / std::f64::consts::TAU)
    }
}

/// The stress under a traction along x, one along y and a pressure.
pub fn combine(kernels: &[f64; KERNELS], load: [f64; 3]) -> [f64; 6] {
    KERNEL_OF.map(|[x, y, z]| kernels[x] * load[0] + kernels[y] * load[1] + kernels[z] * load[2])
}
