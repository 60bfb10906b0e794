//! What the paper prints: Deaner, Allen, Starr, Segalman, *Investigation of Modal Iwan Models for Structures with Bolted
//! Joints*. Pounds-force, inches, seconds; modal quantities mass-normalised.

/// The four parameters of a joint as printed: K_T, F_S, χ, β.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Joint {
    pub(crate) k_t: f64,
    pub(crate) f_s: f64,
    pub(crate) chi: f64,
    pub(crate) beta: f64,
}

/// Table 1: each discrete joint of the beam.
pub(crate) const TABLE_1: Joint = Joint { k_t: 2.75e5, f_s: 300.0, chi: -0.3, beta: 0.02 };

/// Table 2: the modal joints of bending modes 1 to 3.
pub(crate) const TABLE_2: [Joint; 3] = [
    Joint { k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 },
    Joint { k_t: 2.0e4, f_s: 1.0e5, chi: -0.999, beta: 3.0 },
    Joint { k_t: 8.73e5, f_s: 534.6, chi: -0.048, beta: 0.38 },
];

/// Band of mode 1 in the laboratory, Hz (Sec. 4.4).
pub(crate) const BAND: (f64, f64) = (120.0, 135.0);

impl Joint {
    /// The joint as a law.
    pub(crate) fn law(&self) -> Result<iwan_core::FourParameter, iwan_core::Error> {
        iwan_core::FourParameter::new(self.k_t, self.f_s, self.chi, self.beta)
    }
}
