//! Reduced model: stuck modes and the static attachment vectors of the slips.
//!
//! Modes alone cannot follow a local slip. The attachment vector z = (K_0 + σM)⁻¹ e of each slip adds the static flexibility of all modes
//! that are left out (R. R. Craig Jr. and C.-J. Chang, NASA CR-2893, 1977). Attachment vectors are made orthogonal to the modes and
//! diagonalised among themselves, so that mass and stuck stiffness of the reduced model are diagonal: q'' + Λ q + Bᵀ [F(s) - K_T s] = p(t)
//! Vᵀ g, s = B q. The first coordinates are the modal coordinates.

use faer::Mat;

use crate::algebra::{Cholesky, Symmetric, add_scaled, dot, product, scale, symmetric_eigen};
use crate::error::{Error, check};
use crate::matrices::Assembled;
use crate::modes::{Limit, Modes};
use crate::structure::Kept;
use iwan_core::Progress;
use iwan_core::progress::UNWATCHED;

/// The vectors that span the reduced model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Basis {
    /// Modes and attachment vectors of the slips.
    #[default]
    ModesAndAttachments,
    /// Modes alone. The result is wrong as soon as joints slip noticeably; the choice exists to show that.
    Modes,
}

/// A structure reduced to a few coordinates.
#[derive(Debug, Clone)]
pub struct Reduced<'a> {
    assembled: &'a Assembled,
    modes: Modes,
    /// Columns of V after the modes.
    attachments: Vec<Vec<f64>>,
    /// Λ, 1/s²: first those of the modes, then those of the attachment vectors.
    eigenvalues: Vec<f64>,
    /// 2ζω of each coordinate, 1/s.
    damping: Vec<f64>,
}

/// Limit below which an attachment vector is left out because it adds nothing to the modes and the other vectors, as when two joints act on
/// one motion. The limit holds for the squared length of the vector's independent part, relative to the whole, so 1e-6 of a length is still
/// kept. The vectors of the paper's beam are all above 4e-2.
const DEPENDENT: f64 = 1e-12;
/// Limit below which the part of an attachment vector outside the modes is rounding, also for the squared length relative to the whole:
/// where the modes span everything, the square of 1e-16 is left. Such a vector is left out, because normalised rounding would duplicate a
/// mode.
const ROUNDING: f64 = 1e-22;

impl Assembled {
    /// Reduces the structure to its lowest `modes` stuck modes, including zero modes, and the attachment vectors.
    ///
    /// # Errors
    /// The errors of [`modes`](Self::modes).
    pub fn reduce(&self, modes: usize, basis: Basis) -> Result<Reduced<'_>, Error> {
        self.reduce_observed(modes, basis, UNWATCHED)
    }

    /// [`reduce`](Self::reduce) with a progress report whose listener may stop it.
    ///
    /// # Errors
    /// The errors of [`modes_observed`](Self::modes_observed).
    pub fn reduce_observed(
        &self,
        modes: usize,
        basis: Basis,
        progress: Progress<'_>,
    ) -> Result<Reduced<'_>, Error> {
        if let Some(kept) = self.kept()?
            && (modes, basis) == (kept.basis.values.len(), Basis::ModesAndAttachments)
        {
            return Ok(Reduced::of_kept(self, kept));
        }
        let (modes, factor) = self.modes_and_factor(Limit::Stuck, modes, progress)?;
        Reduced::new(self, modes, &factor, basis)
    }
}

impl<'a> Reduced<'a> {
    fn new(assembled: &'a Assembled, modes: Modes, factor: &Cholesky, basis: Basis) -> Result<Self, Error> {
        let mut eigenvalues = eigenvalues_of(&modes);
        let mut attachments = Vec::new();
        if basis == Basis::ModesAndAttachments {
            let raw = attachment_vectors(assembled, &modes, factor);
            let (own, vectors) = diagonalise(assembled, &raw)?;
            eigenvalues.extend(own);
            attachments = vectors;
        }
        Ok(Self::damped(Self { assembled, modes, attachments, eigenvalues, damping: Vec::new() }))
    }

    fn of_kept(assembled: &'a Assembled, kept: &Kept) -> Self {
        let modes = Modes::of_kept(&kept.basis, Limit::Stuck, assembled.unknowns());
        let mut eigenvalues = eigenvalues_of(&modes);
        eigenvalues.extend(&kept.attachments.values);
        let vectors = kept.attachments.vectors.chunks_exact(assembled.unknowns());
        let attachments = vectors.map(<[f64]>::to_vec).collect();
        Self::damped(Self { assembled, modes, attachments, eigenvalues, damping: Vec::new() })
    }

    /// Adds the damping of given matrices: the diagonal of Vᵀ C V. The terms that couple coordinates are left out, as is usual where
    /// damping is light.
    fn damped(mut self) -> Self {
        let own = |k: usize| {
            self.assembled.damping().map_or(0.0, |c| c.form(self.column(k), self.column(k)).max(0.0))
        };
        self.damping = (0..self.coordinates()).map(own).collect();
        self
    }

    /// The same model with viscous modal damping in addition to that of given matrices. Every coordinate gets a term 2ζωq' with the ratio ζ
    /// that `ratio` returns for its frequency in Hz; rigid motions stay undamped. This represents losses besides the joints, such as those
    /// of a suspension or a sensor's cable.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a ratio that is negative or not finite.
    ///
    /// ```
    /// use iwan_fem::{Basis, mesh::beam::Configuration, paper};
    /// let assembled = paper::structure(Configuration::A, 1)?.assemble()?;
    /// let reduced = assembled.reduce(10, Basis::default())?.with_damping(|_| 2.5e-4)?;
    /// assert_eq!(reduced.damping()[0], 0.0);
    /// assert!((reduced.damping()[6] - 2.0 * 2.5e-4 * reduced.eigenvalues()[6].sqrt()).abs() < 1e-12);
    /// # Ok::<(), iwan_fem::Error>(())
    /// ```
    pub fn with_damping(mut self, ratio: impl Fn(f64) -> f64) -> Result<Self, Error> {
        for (damping, eigenvalue) in self.damping.iter_mut().zip(&self.eigenvalues) {
            let omega = eigenvalue.max(0.0).sqrt();
            let given = ratio(omega / std::f64::consts::TAU);
            check("modal damping ratio", given, given >= 0.0, "must be a finite number >= 0")?;
            *damping += 2.0 * given * omega;
        }
        Ok(self)
    }

    /// 2ζω of each coordinate, 1/s; zeros unless matrices with damping were given or [`with_damping`](Self::with_damping) was called.
    #[must_use]
    pub fn damping(&self) -> &[f64] {
        &self.damping
    }

    /// The structure that was reduced.
    #[must_use]
    pub fn assembled(&self) -> &'a Assembled {
        self.assembled
    }

    /// The stuck modes in the basis.
    #[must_use]
    pub fn modes(&self) -> &Modes {
        &self.modes
    }

    /// Number of coordinates: modes plus attachment vectors.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        self.eigenvalues.len()
    }

    /// Λ, 1/s²: ω² of the modes, then the eigenvalues of the attachment vectors.
    #[must_use]
    pub fn eigenvalues(&self) -> &[f64] {
        &self.eigenvalues
    }

    /// Column k of the basis V: one entry per unknown.
    ///
    /// # Panics
    /// When there is no such column.
    #[must_use]
    pub fn column(&self, k: usize) -> &[f64] {
        if k < self.modes.len() { self.modes.shape(k) } else { &self.attachments[k - self.modes.len()] }
    }

    /// Vᵀ f: the functional `f` of the unknowns, in terms of the coordinates.
    ///
    /// # Panics
    /// When `f` does not have one entry per unknown.
    #[must_use]
    pub fn project(&self, f: &[f64]) -> Vec<f64> {
        (0..self.coordinates()).map(|k| dot(self.column(k), f)).collect()
    }
}

/// Λ of the modes; those of rigid motions, which are rounding, are set to 0.
fn eigenvalues_of(modes: &Modes) -> Vec<f64> {
    (0..modes.len()).map(|i| if i < modes.zero_modes() { 0.0 } else { modes.eigenvalue(i) }).collect()
}

/// (K_0 + σM)⁻¹ e of each slip without its part in the modes. The shift σ is so far below the first mode left out that its effect lies
/// within the modes.
fn attachment_vectors(assembled: &Assembled, modes: &Modes, factor: &Cholesky) -> Vec<Vec<f64>> {
    let vector = |unknown: usize| -> Option<Vec<f64>> {
        let mut z = vec![0.0; assembled.unknowns()];
        z[unknown] = 1.0;
        factor.solve(&mut z);
        let whole = assembled.mass().form(&z, &z);
        // The part in the modes is removed twice, because the remainder is small compared with what is removed.
        for _ in 0..2 {
            let weighted = assembled.mass().times(&z);
            for i in 0..modes.len() {
                add_scaled(&mut z, -dot(modes.shape(i), &weighted), modes.shape(i));
            }
        }
        let left = assembled.mass().form(&z, &z);
        (left > ROUNDING * whole).then(|| {
            scale(&mut z, 1.0 / left.sqrt());
            z
        })
    };
    assembled.slips().iter().filter_map(|slip| vector(slip.unknown)).collect()
}

/// Combinations of vectors of unit mass that are M-orthonormal and K_0-orthogonal, with their eigenvalues.
fn diagonalise(assembled: &Assembled, vectors: &[Vec<f64>]) -> Result<(Vec<f64>, Vec<Vec<f64>>), Error> {
    let n = vectors.len();
    if n == 0 {
        return Ok((Vec::new(), Vec::new()));
    }
    let failed = || Error::Analysis {
        analysis: "reduction",
        finding: "the attachment vectors are not finite".into(),
        remedy: "check joints and units",
    };
    let projected = |matrix: &Symmetric| {
        let images: Vec<Vec<f64>> = vectors.iter().map(|z| matrix.times(z)).collect();
        Mat::from_fn(n, n, |i, j| 0.5 * (dot(&vectors[i], &images[j]) + dot(&vectors[j], &images[i])))
    };
    let (mass, stiffness) = (projected(assembled.mass()), projected(&assembled.stiffness(Limit::Stuck)));
    let of_mass = symmetric_eigen(&mass).ok_or_else(failed)?;
    let kept: Vec<usize> = (0..n).filter(|&i| of_mass.values[i] > DEPENDENT * n as f64).collect();
    let whiten =
        Mat::from_fn(n, kept.len(), |i, k| of_mass.vectors[(i, kept[k])] / of_mass.values[kept[k]].sqrt());
    let inner = product(product(whiten.transpose(), stiffness.as_ref()).as_ref(), whiten.as_ref());
    let of_stiffness = symmetric_eigen(&inner).ok_or_else(failed)?;
    let combinations = product(whiten.as_ref(), of_stiffness.vectors.as_ref());
    let combine = |k: usize| {
        let mut out = vec![0.0; assembled.unknowns()];
        vectors.iter().enumerate().for_each(|(i, z)| add_scaled(&mut out, combinations[(i, k)], z));
        out
    };
    let columns = (0..kept.len()).map(combine).collect();
    Ok((of_stiffness.values, columns))
}
