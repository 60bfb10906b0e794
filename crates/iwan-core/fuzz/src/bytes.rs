//! From bytes to parameters of laws and to displacements.

use iwan_core::{Backbone, DensityPoint, Error, FourParameter, Grid, Jenkins, Tabulated, Uniform};

/// Numbers read off a row of bytes; behind its end all bytes are 0.
pub struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    /// All of `bytes`.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    /// Whether all have been read.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The next byte.
    pub fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        *first
    }

    fn take<const N: usize>(&mut self) -> [u8; N] {
        std::array::from_fn(|_| self.byte())
    }

    /// Any number at all, infinities and NaN among them.
    pub fn number(&mut self) -> f64 {
        f64::from_bits(u64::from_le_bytes(self.take()))
    }

    /// A number from 0 to 1, both included.
    pub fn share(&mut self) -> f64 {
        f64::from(u16::from_le_bytes(self.take())) / f64::from(u16::MAX)
    }

    /// A number from 1e-32 to 1e32: parameters in any units that are in use.
    pub fn positive(&mut self) -> f64 {
        (0.1 + self.share()) * 10_f64.powi(i32::from(self.byte() % 62) - 31)
    }

    /// A displacement beside a law whose strongest slider has the strength `strongest`.
    pub fn displacement(&mut self, strongest: f64) -> f64 {
        let kind = self.byte();
        let sign = if kind & 1 == 0 { 1.0 } else { -1.0 };
        sign * match kind / 2 % 4 {
            0 => strongest * self.share(),
            1 => strongest * 2.0 * self.share(),
            2 => strongest * 10_f64.powi(i32::from(self.byte() % 40) - 30),
            _ => strongest * (1.0 + f64::EPSILON * f64::from(self.byte().cast_signed())),
        }
    }
}

/// The four parameters, each over its whole range.
///
/// # Errors
/// What the law refuses.
pub fn four_parameter(bytes: &mut Bytes<'_>) -> Result<FourParameter, Error> {
    let (k_t, f_s) = (bytes.positive(), bytes.positive());
    let chi = match bytes.byte() % 4 {
        0 => -1.0 + bytes.positive().min(2.0),
        _ => -1.0 + 2.0 * bytes.share(),
    };
    let beta = match bytes.byte() % 3 {
        0 => 0.0,
        1 => bytes.share(),
        _ => bytes.positive(),
    };
    FourParameter::new(k_t, f_s, chi, beta)
}

/// Strengths, densities and the stiffness at the last strength of a tabulated density.
pub fn table_of_density(bytes: &mut Bytes<'_>) -> (Vec<f64>, Vec<f64>, f64) {
    let (scale, height) = (bytes.positive(), bytes.positive());
    let count = 2 + usize::from(bytes.byte() % 8);
    let mut here = 0.0;
    let mut strengths = Vec::new();
    for _ in 0..count {
        here += scale * bytes.share();
        strengths.push(here);
    }
    let densities = (0..count).map(|_| height * bytes.share()).collect();
    let dirac = if bytes.byte() % 2 == 0 { 0.0 } else { height * scale * bytes.share() };
    (strengths, densities, dirac)
}

/// Any law in closed form.
///
/// # Errors
/// What the law refuses.
pub fn law(bytes: &mut Bytes<'_>) -> Result<Box<dyn Backbone>, Error> {
    Ok(match bytes.byte() % 4 {
        0 => Box::new(four_parameter(bytes)?),
        1 => Box::new(Jenkins::new(bytes.positive(), bytes.positive())?),
        2 => Box::new(Uniform::new(bytes.positive(), bytes.positive(), bytes.share())?),
        _ => {
            let (strength, density, dirac) = table_of_density(bytes);
            let points = vec![DensityPoint::default(); strength.len()];
            Box::new(Tabulated::new(&strength, &density, dirac, points)?)
        }
    })
}

/// Strengths, ascending with ties and some of no strength, and stiffnesses.
pub fn elements(bytes: &mut Bytes<'_>) -> (Vec<f64>, Vec<f64>) {
    let (scale, height) = (bytes.positive(), bytes.positive());
    let count = 1 + usize::from(bytes.byte() % 24);
    let mut strengths: Vec<f64> = (0..count).map(|_| scale * bytes.share()).collect();
    strengths.sort_by(f64::total_cmp);
    let stiffnesses = (0..count).map(|_| height * (0.01 + bytes.share())).collect();
    (strengths, stiffnesses)
}

/// Any grid.
pub fn grid(bytes: &mut Bytes<'_>) -> Grid {
    match bytes.byte() % 4 {
        0 => Grid::Uniform,
        1 => Grid::Graded { smallest: bytes.positive() },
        2 => Grid::Geometric { ratio: 1.0 + bytes.positive() },
        _ => Grid::graded(usize::from(bytes.byte())),
    }
}
