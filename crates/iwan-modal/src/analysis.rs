//! From frequency responses to modes in one call.

use std::f64::consts::TAU;

use crate::error::{Error, check};
use crate::fit::{Band, Fitted, pruned};
use crate::measure::{Channel, Freedom};
use crate::modes::{Drive, Mode, Scale, modes};
use crate::number::{Complex, complex};
use crate::poles::{Isolation, Stabilisation, chart, isolation, isolation_alone, subspace};
use crate::responses::FrequencyResponses;

/// Without a band, lines count up to where the spectrum of the hammer's force falls below this fraction of its largest value: 30 dB, below which common hammers leave
/// nothing but noise.
const FORCE_LEFT: f64 = 0.03;
/// Without a band, lines also count no higher than this fraction of the Nyquist frequency, above which the filters of recorders act.
const BELOW_NYQUIST: f64 = 0.8;
/// Lowest frequency without a band, in cycles of the record: below, a record holds too few cycles.
const CYCLES: f64 = 10.0;
/// Largest number of modes that mode isolation adds to those of the chart.
const MORE: usize = 20;
/// Largest number of modes that mode isolation finds by itself.
const MOST: usize = 60;

/// The way in which the first poles are found; the fit that follows is the same for all.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Analysis {
    /// Stabilisation chart, then mode isolation on what the chart's modes leave.
    #[default]
    Chart,
    /// Mode isolation alone.
    Isolation,
    /// Poles near these frequencies (Hz), and no others.
    Given(Vec<f64>),
    /// These poles as start (1/s, upper half plane), such as those of another method or program, for instance [`subspace`](crate::poles::subspace); poles
    /// that the responses do not need are left out.
    From(Vec<nalgebra::Complex<f64>>),
}

/// The modes of a fit, with all that led to them.
#[derive(Debug)]
pub struct ModalFit {
    /// The modes, by ascending frequency.
    pub modes: Vec<Mode>,
    /// Points and directions of the shapes' values.
    pub freedoms: Vec<Freedom>,
    /// Names of the shapes' channels.
    pub names: Vec<String>,
    /// Whether the shapes are mass-normalised, or scaled to a largest value of 1.
    pub scale: Scale,
    /// The point that the hammer hits; none where no response was measured there.
    pub drive: Option<Drive>,
    /// Edges of the band, Hz.
    pub band: (f64, f64),
    /// The stabilisation chart; none where another way was chosen.
    pub stabilisation: Option<Stabilisation>,
    /// The modes that mode isolation found one after another; none where it was not used.
    pub isolation: Option<Isolation>,
    /// Poles, residues, and what the fit leaves of the responses.
    pub fitted: Fitted,
}

impl ModalFit {
    /// The modes among the fitted poles that lie in the band.
    fn of(band: &Band, fitted: Fitted) -> Result<Self, Error> {
        let (low, high) = band.edges();
        let inside = |p: Complex| (low..=high).contains(&(p.norm() / TAU));
        let shapes = modes(band.responses, &fitted, &inside);
        if shapes.modes.is_empty() {
            let finding = format!("no mode between {low:.6} and {high:.6} Hz");
            return Err(Error::refused(
                "modal fit",
                finding,
                "choose another --band, or give frequencies with --poles",
            ));
        }
        Ok(Self {
            modes: shapes.modes,
            freedoms: shapes.freedoms,
            names: shapes.names,
            scale: shapes.scale,
            drive: shapes.drive,
            band: (low, high),
            stabilisation: None,
            isolation: None,
            fitted,
        })
    }

    /// Index of the mode at a frequency (Hz), to within half of its half-power width and one line; none where there is no mode.
    #[must_use]
    pub fn mode_at(&self, frequency: f64, responses: &FrequencyResponses) -> Option<usize> {
        let distance = |m: &Mode| (m.frequency - frequency).abs();
        let nearest = self.modes.iter().enumerate().min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)));
        let (n, mode) = nearest?;
        (distance(mode) <= -mode.pole.re / TAU + responses.step).then_some(n)
    }

    /// The fit with modes at the frequencies `added` (Hz) and without those at `dropped` (Hz). All modes are fitted anew, and none is left out because it explains
    /// too little. `responses` are those of the fit.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a frequency to add that lies outside the band, and for one to leave out at which there is no mode;
    /// [`Error::Refused`] where no mode is left, or two cannot be told apart.
    pub fn overruled(
        self,
        responses: &FrequencyResponses,
        added: &[f64],
        dropped: &[f64],
    ) -> Result<Self, Error> {
        let band = Band::new(responses, self.band)?;
        let mut poles = self.fitted.poles.clone();
        for &frequency in dropped {
            let own = self.mode_at(frequency, responses);
            let listed: Vec<String> = self.modes.iter().map(|m| format!("{:.3}", m.frequency)).collect();
            let allowed = format!("there are modes at {} Hz", listed.join(", "));
            let remedy = "give the frequency of one of them";
            check("frequency of a mode to leave out", frequency, own.is_some(), allowed, remedy)?;
            poles.retain(|p| own.is_none_or(|n| *p != self.modes[n].pole));
        }
        poles.extend(given(&band, added)?);
        let fitted = Fitted::new(&band, &poles)?;
        let Self { stabilisation, isolation, .. } = self;
        Ok(Self { stabilisation, isolation, ..Self::of(&band, fitted)? })
    }

    /// Mass-normalised shape of a mode at the hammer, along its force; none without a drive point.
    #[must_use]
    pub fn shape_at_force(&self, mode: &Mode) -> Option<f64> {
        self.drive.map(|d| d.sign * mode.real_shape[d.freedom])
    }

    /// The fit with standard deviations of shapes that include those of the sensors' gains, `spread` relative (0.01 for 1 %). An error e of a sensor's
    /// gain goes into the shape at that sensor. An error e of the drive point's sensor, or of the hammer, goes as -e/2 into all values of a mass-normalised shape, because
    /// its scale is the root of the response at the drive point. Responses to one point of force do not show such errors.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a spread that is negative or not below 1.
    pub fn with_calibration(mut self, spread: f64) -> Result<Self, Error> {
        let remedy = "give the standard deviation of the sensors' gains, 0.01 for 1 %";
        check(
            "spread of calibrations",
            spread,
            (0.0..1.0).contains(&spread),
            "0 or more and below 1",
            remedy,
        )?;
        let (scale, drive) = (self.scale, self.drive);
        for mode in &mut self.modes {
            let largest = mode.real_shape.iter().map(|x| x.abs()).fold(0.0, f64::max);
            for (i, (value, sd)) in mode.real_shape.iter().zip(&mut mode.shape_sd).enumerate() {
                let parts = match (scale, drive) {
                    (Scale::DrivePoint, Some(d)) if d.roving_hammer || d.freedom == i => 0.5,
                    (Scale::DrivePoint, _) => 1.25_f64.sqrt(),
                    (Scale::LargestIsOne, _) if value.abs() == largest => 0.0,
                    (Scale::LargestIsOne, _) => 2.0_f64.sqrt(),
                };
                *sd = sd.hypot(parts * spread * value);
            }
        }
        Ok(self)
    }
}

/// Finds the modes of frequency responses in `band` (Hz), or without one as far up as the force reaches, by polynomials up to `order` (60 is a good choice).
///
/// # Errors
/// [`Error::OutOfRange`] for band, order and given frequencies; [`Error::Refused`] where no mode is found.
pub fn modal_fit(
    responses: &FrequencyResponses,
    band: Option<(f64, f64)>,
    analysis: &Analysis,
    order: usize,
) -> Result<ModalFit, Error> {
    let edges = band.unwrap_or_else(|| automatic_band(responses));
    let band = Band::new(responses, edges)?;
    let mut stabilisation = None;
    let mut steps = None;
    let fitted = match analysis {
        Analysis::Chart => {
            let chart = chart(&band, order)?;
            let start: Vec<Complex> = chart.candidates.iter().map(|c| c.pole).collect();
            stabilisation = Some(chart);
            let (first, linear) = pruned(&band, &start)?;
            let rest = linear.rest(&band);
            let (poles, first) = (first.poles.clone(), first.drawn(&band, &rest));
            let more = isolation(&band, poles, (linear, rest), MORE);
            let found = if more.steps.is_empty() { first } else { needed(&band, &more.poles)? };
            steps = Some(more);
            found
        }
        Analysis::Isolation => {
            let alone = isolation_alone(&band, MOST)?;
            let found = needed(&band, &alone.poles)?;
            steps = Some(alone);
            found
        }
        Analysis::From(poles) => needed(&band, poles)?,
        Analysis::Given(frequencies) => Fitted::new(&band, &given(&band, frequencies)?)?,
    };
    Ok(ModalFit { stabilisation, isolation: steps, ..ModalFit::of(&band, fitted)? })
}

/// Finds the modes of free decays, each a set of channels sampled together every `dt` seconds, by [`subspace`] with realizations up to `order`: in `band` (Hz), or without one up
/// to 0.8 of the Nyquist frequency. `responses` are the [`free_responses`](crate::responses::free_responses) of the same decays, to
/// which poles and shapes are fitted.
///
/// # Errors
/// As [`subspace`] and [`modal_fit`].
///
/// ```
/// use iwan_modal::measure::{Channel, Freedom, Motion};
/// let decay = (0..4096).map(|n| (-2e-4 * n as f64).exp() * (0.25 * n as f64).cos()).collect();
/// let decays = [vec![Channel { name: "tip".into(), freedom: Freedom::point("tip"), samples: decay }]];
/// let responses = iwan_modal::responses::free_responses(&decays, 1e-3, Motion::Acceleration)?;
/// let fit = iwan_modal::modal_fit_by_subspaces(&responses, &decays, 1e-3, Some((20.0, 80.0)), 12)?;
/// assert!((fit.modes[0].pole.im - 250.0).abs() < 1e-6);
/// # Ok::<(), iwan_modal::Error>(())
/// ```
pub fn modal_fit_by_subspaces(
    responses: &FrequencyResponses,
    decays: &[Vec<Channel>],
    dt: f64,
    band: Option<(f64, f64)>,
    order: usize,
) -> Result<ModalFit, Error> {
    let edges = band.unwrap_or_else(|| automatic_band(responses));
    let chart = subspace(decays, dt, edges, order)?;
    let poles = chart.candidates.iter().map(|c| c.pole).collect();
    let fit = modal_fit(responses, Some(edges), &Analysis::From(poles), order)?;
    Ok(ModalFit { stabilisation: Some(chart), ..fit })
}

/// The fit of those poles that the responses need, with its curves.
fn needed(band: &Band, start: &[Complex]) -> Result<Fitted, Error> {
    let (fitted, linear) = pruned(band, start)?;
    Ok(fitted.drawn(band, &linear.rest(band)))
}

/// The band (Hz) from ten cycles in a record up to where the force has fallen.
fn automatic_band(responses: &FrequencyResponses) -> (f64, f64) {
    let lines = responses.lines();
    let highest = (BELOW_NYQUIST * lines as f64) as usize;
    let strongest = responses.force.iter().copied().fold(0.0, f64::max);
    let falls = responses.force.iter().position(|f| *f < FORCE_LEFT * strongest);
    let last = falls.map_or(highest, |k| k.saturating_sub(1)).min(highest);
    (CYCLES * responses.step, responses.frequency(last))
}

/// Poles at the given frequencies (Hz); the damping of each is that of the peak there by its half-power width, with two lines at least.
fn given(band: &Band, frequencies: &[f64]) -> Result<Vec<Complex>, Error> {
    let (low, high) = band.edges();
    let composite = band.responses.composite();
    let one = |f: &f64| {
        let allowed = format!("within the band, {low:.6} to {high:.6} Hz");
        check(
            "frequency of a pole",
            *f,
            *f >= low && *f <= high,
            allowed,
            "choose another --band or frequency",
        )?;
        let line = (f / band.responses.step).round() as usize;
        let high = |k: &usize| composite.get(*k).is_some_and(|c| *c > 0.707 * composite[line]);
        let width = (line + 1..composite.len()).take_while(high).count()
            + (0..line).rev().take_while(high).count()
            + 1;
        Ok(complex(-std::f64::consts::PI * width as f64 * band.responses.step, TAU * f))
    };
    frequencies.iter().map(one).collect()
}
