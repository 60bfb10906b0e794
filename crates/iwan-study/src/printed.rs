//! Values that the paper prints: Deaner, Allen, Starr, Segalman, *Investigation of Modal Iwan Models for Structures with Bolted Joints*. Units are
//! pounds-force, inches and seconds; modal quantities are mass-normalised.
//!
//! Table 1, the joint of the beam's interfaces, is [`iwan_fem::paper::joint`]: the structure is built with it.

use iwan_core::FourParameter;

use crate::span::Span;

/// The four parameters of a modal joint as printed: K_T, F_S, χ, β.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrintedJoint {
    /// K_T, 1/s².
    pub k_t: f64,
    /// F_S, √(lbf·in)/s.
    pub f_s: f64,
    /// χ.
    pub chi: f64,
    /// β.
    pub beta: f64,
}

/// Table 2: the modal joints of bending modes 1 to 3.
///
/// ```
/// let first = iwan_study::printed::TABLE_2[0].law()?;
/// assert!((first.phi_max() - 0.009329393723670242).abs() < 1e-16); // √(lbf·in)·s
/// # Ok::<(), iwan_core::Error>(())
/// ```
pub const TABLE_2: [PrintedJoint; 3] = [
    PrintedJoint { k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 },
    PrintedJoint { k_t: 2.0e4, f_s: 1.0e5, chi: -0.999, beta: 3.0 },
    PrintedJoint { k_t: 8.73e5, f_s: 534.6, chi: -0.048, beta: 0.38 },
];

/// Table 3, with the link: damping ratios of the first three elastic modes with the bolts at 50 in-lbf and without bungees, and with the bolts
/// at 5 in-lbf on bungees.
pub const TABLE_3_WITH_LINK: [[f64; 2]; 3] = [[2.5e-4, 1.5e-3], [3e-4, 6e-4], [2.5e-4, 1.8e-3]];
/// Table 4: level of the impact over the hardest, and slope of ln D over ln force there.
pub const TABLE_4: [[f64; 2]; 3] = [[0.5, 2.096], [0.7, 2.168], [1.0, 2.398]];
/// Band of mode 1 in the laboratory, Hz (Sec. 4.4).
pub const BAND: Span = Span { from: 120.0, to: 135.0 };

impl PrintedJoint {
    /// The joint as a law.
    ///
    /// # Errors
    /// None for what is printed in [`TABLE_2`].
    pub fn law(&self) -> Result<FourParameter, iwan_core::Error> {
        FourParameter::new(self.k_t, self.f_s, self.chi, self.beta)
    }
}
