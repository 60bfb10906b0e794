//! The amplitudes that the quasi-static curves of a mode cover.

use super::curves::ModalCurves;
use crate::error::{Error, check};
use crate::modes::{NamedMode, NamedModes};

/// Default range of displacements, over the displacement at which the first joint begins macro-slip. It covers three decades of micro-slip,
/// enough for the joint's power law, and one of macro-slip, in which the frequency approaches that of the slipping structure.
const RANGE: (f64, f64) = (1e-3, 10.0);

/// Numbers of memory per point of a curve: displacement, force, frequency, dissipation, values of each joint, and room for the vectors'
/// growth.
const NUMBERS_A_POINT: u64 = 32;

impl NamedModes {
    /// The modal displacement at which, by the linear mode shape, the first joint reaches the strength of its strongest slider; none if no
    /// joint slips in the mode.
    #[must_use]
    pub fn onset(&self, mode: &NamedMode) -> Option<f64> {
        let shape = self.stuck.shape(mode.pair.stuck);
        let reach = self.assembled.slips().iter().filter_map(|slip| {
            let law = slip.law.as_ref()?;
            Some(law.strengths().1 / shape[slip.unknown].abs())
        });
        Some(reach.fold(f64::INFINITY, f64::min)).filter(|q| q.is_finite())
    }

    /// `points` modal displacements, evenly spaced on a logarithmic scale; by default from a thousandth to ten times the
    /// [`onset`](Self::onset).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for an end that is not > 0, fewer than 2 points, or an empty range; [`Error::Analysis`] if no joint slips and
    /// an end is not given.
    pub fn amplitudes(
        &self,
        mode: &NamedMode,
        (from, to): (Option<f64>, Option<f64>),
        points: usize,
    ) -> Result<Vec<f64>, Error> {
        let onset = self.onset(mode);
        let end = |given: Option<f64>, share: f64| {
            given.or(onset.map(|q| share * q)).ok_or_else(|| Error::Analysis {
                analysis: "quasi-static analysis",
                finding: format!("no joint slips in {}", mode.name),
                remedy: "give both ends of the displacements, or choose other modes",
            })
        };
        let (from, to) = (end(from, RANGE.0)?, end(to, RANGE.1)?);
        check("smallest modal displacement", from, from > 0.0, "must be a finite number > 0")?;
        check(
            "largest modal displacement",
            to,
            to > from,
            "the range of modal displacements is empty; must be a finite number above the smallest",
        )?;
        check("points", points as f64, points >= 2, "must be at least 2")?;
        let bytes = (points as u64).saturating_mul(NUMBERS_A_POINT * 8);
        iwan_machine::memory::ask(format!("a curve of {points} points"), bytes, "ask for fewer points")?;
        let last = (points - 1) as f64;
        Ok((0..points).map(|i| from * (to / from).powf(i as f64 / last)).collect())
    }

    /// Quasi-static curves of a mode at the given modal displacements. Where parts begin to slide freely no static load holds them: the
    /// curves end there, or, if they must be `whole`, that is an error.
    ///
    /// # Errors
    /// The errors of [`Assembled::quasi_static`](crate::Assembled::quasi_static) and [`QuasiStatic::curves`](crate::QuasiStatic::curves).
    pub fn static_curves(
        &self,
        mode: &NamedMode,
        displacements: &[f64],
        whole: bool,
    ) -> Result<ModalCurves, Error> {
        let eigenvalue = self.slipping.eigenvalue(mode.pair.slipping);
        let analysis = self.assembled.quasi_static(&self.stuck, mode.pair.stuck, eigenvalue)?;
        if whole {
            return analysis.curves(displacements);
        }
        let mut curves = analysis.curves(&[])?;
        for displacement in displacements {
            match analysis.curves(&[*displacement]) {
                Ok(next) => append(&mut curves, next),
                Err(Error::Analysis { .. }) if !curves.displacement.is_empty() => break,
                Err(error) => return Err(error),
            }
        }
        Ok(curves)
    }
}

fn append(curves: &mut ModalCurves, next: ModalCurves) {
    curves.displacement.extend(next.displacement);
    curves.force.extend(next.force);
    curves.frequency.extend(next.frequency);
    curves.dissipation.extend(next.dissipation);
    curves.joint_force.extend(next.joint_force);
    for (slip, more) in curves.slips.iter_mut().zip(next.slips) {
        slip.extend(more);
    }
}
