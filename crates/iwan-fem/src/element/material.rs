//! Isotropic linear elasticity.

use crate::error::{Error, check};

/// Smallest modulus and density that is accepted. Values outside the range must be mistakes in the input: in every system of units in use
/// they lie between 1e-15 and 1e15. With the range, squares of their products stay far from the limits of floating point, where searches
/// for modes did not end.
const SMALLEST: f64 = 1e-30;
/// Largest modulus and density that is accepted.
const LARGEST: f64 = 1e30;

/// An isotropic linear elastic material in the user's consistent units.
///
/// ```
/// // Steel 304 of the paper's beam, in pounds-force, inches and seconds.
/// let steel = iwan_fem::Material::new(28.0e6, 0.29, 7.48e-4)?;
/// assert!((steel.shear_modulus() - 28.0e6 / 2.58).abs() < 1e-6);
/// # Ok::<(), iwan_fem::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    young: f64,
    poisson: f64,
    density: f64,
}

impl Material {
    /// Young's modulus `young` (force/length²), Poisson's ratio -1 < `poisson` < 0.5 and mass density
    /// `density` (mass/length³), both from 1e-30 to 1e30.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the quantity.
    pub fn new(young: f64, poisson: f64, density: f64) -> Result<Self, Error> {
        let sensible = |value: f64| (SMALLEST..=LARGEST).contains(&value);
        check("young", young, sensible(young), "Young's modulus must be a number from 1e-30 to 1e30")?;
        let stable = poisson > -1.0 && poisson < 0.5;
        check("poisson", poisson, stable, "Poisson's ratio must satisfy -1 < poisson < 0.5")?;
        check("density", density, sensible(density), "mass density must be a number from 1e-30 to 1e30")?;
        Ok(Self { young, poisson, density })
    }

    /// Young's modulus E.
    #[must_use]
    pub const fn young(&self) -> f64 {
        self.young
    }

    /// Poisson's ratio ν.
    #[must_use]
    pub const fn poisson(&self) -> f64 {
        self.poisson
    }

    /// Mass density ρ.
    #[must_use]
    pub const fn density(&self) -> f64 {
        self.density
    }

    /// Shear modulus μ = E / (2 (1 + ν)), Lamé's second parameter.
    #[must_use]
    pub fn shear_modulus(&self) -> f64 {
        0.5 * self.young / (1.0 + self.poisson)
    }

    /// Lamé's first parameter λ = E ν / ((1 + ν) (1 - 2ν)).
    #[must_use]
    pub fn lame(&self) -> f64 {
        self.young * self.poisson / ((1.0 + self.poisson) * (1.0 - 2.0 * self.poisson))
    }
}
