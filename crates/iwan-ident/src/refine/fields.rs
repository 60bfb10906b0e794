//! What a model may miss: its dissipation and its frequency may be off by parts that vary slowly with amplitude.
//!
//! The truth is D(a) exp(d(ln a)) in place of D(a), and ω(a) (1 + w(ln a)) in place of ω(a), where d and w are Gaussian processes of zero mean (M. C.
//! Kennedy, A. O'Hagan, *Bayesian calibration of computer models*, J. R. Stat. Soc. B 63:425, 2001). Along a ring-down d ln a = -Λ dt, with the decay
//! rate Λ, so that the complex amplitudes of the model become z exp(g + iψ) with g = -∫ d(l) dl from ln a to its first value and ψ = ∫ ω w dt: the
//! logarithms of the amplitudes are linear in the values of d and w at nodes.
//!
//! The two processes have one cause, a hysteresis of another form. So they share one size: w relative to the frequency's shift over the amplitudes
//! seen is as large as d relative to the dissipation.

use nalgebra::DMatrix;
use rustfft::num_complex::Complex64;

use super::amplitudes::days::LEVEL;
use super::record::Windowed;
use super::task::{Task, Workspace};

/// Distance in ln amplitude over which a discrepancy changes: a factor of 1.35 in amplitude. With a factor of e, an even offset of 10 to 15 % of
/// dissipation counts as likelier than the small bends that measured curves have, and the best fit of the double beam's fifth hit misses dissipation
/// by that much.
const LENGTH: f64 = 0.3;
/// Distance of the nodes in ln amplitude, between which a discrepancy is linear: about `LENGTH`, so that each node tells what its neighbours do
/// not.
pub(super) const SPACING: f64 = 0.25;
/// The same distance for one record without noise. The sliders of a joint begin to slip one by one, at distances of 0.05 and more, and a process that
/// is linear between wider nodes would miss what they do. With more records the distance grows, because time grows with the cube of the number of
/// nodes.
pub(super) const FINEST: f64 = 0.05;
/// Windows below this part of the largest amplitude have the discrepancy of the last node: their weight is a thousandth, and noise hides what a slow
/// process does there.
const LOWEST: f64 = 1e-3;

/// Least relative shift of the frequency to which the discrepancy is related; a smaller shift is raised to it. Ring-downs of real structures do not
/// repeat better than a tenth of it.
const LEAST_SHIFT: f64 = 1e-4;

/// How many times larger an error of the frequency relative to its shift is than an error of dissipation that counts the same: by the limits of the
/// verdict, which are 3 % of dissipation and a tenth of the shift. With one in place of three, frequency is bought at the price of damping: the best
/// fit of the double beam's sixth hit then misses 18 % of dissipation in place of 5 %.
const PART_OF_SHIFT: f64 = 3.0;

/// Processes that share one size.
#[derive(Debug, Clone)]
pub(super) struct Component {
    pub(super) kind: Kind,
    /// Change of ln ω that goes with a change of one in ln D.
    pub(super) shift: f64,
    /// One process for each group of records; every record belongs to one group.
    pub(super) processes: Vec<Process>,
}

/// A process, and the records that share it.
#[derive(Debug, Clone)]
pub(super) struct Process {
    /// Number of independent values of variance one that make the process.
    pub(super) width: usize,
    /// Indices of the records.
    pub(super) records: Vec<usize>,
    /// Derivatives of each of these records' residuals in windows with respect to those values, one column each.
    pub(super) columns: Vec<DMatrix<f64>>,
}

impl Process {
    /// The columns of a record; none where it does not share this process.
    pub(super) fn of(&self, record: usize) -> Option<&DMatrix<f64>> {
        self.records.iter().position(|own| *own == record).map(|place| &self.columns[place])
    }
}

/// The records that share a process.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// All records share it.
    Shared,
    /// The records of a level share it.
    OfLevel,
    /// Every record has its own.
    OfRecord,
    /// Every record has its own offset of ln D, the same at all amplitudes: suspension and preload differ from hit to hit. Offsets of the frequency
    /// are those of the [`days`](super::amplitudes::days).
    Even,
}

/// Nodes in ln amplitude, from the smallest amplitude on.
struct Nodes {
    first: f64,
    spacing: f64,
    count: usize,
}

impl Nodes {
    fn over<'a>(logs: impl Iterator<Item = &'a [f64]>, spacing: f64) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for &log in logs.flatten() {
            (low, high) = (low.min(log), high.max(log));
        }
        let low = low.max(high + LOWEST.ln());
        let count = ((high - low) / spacing).ceil() as usize + 1;
        Self { first: low, spacing, count }
    }

    /// Values at `log` of the hat functions of all nodes.
    fn hats(&self, log: f64) -> Vec<f64> {
        let place = ((log - self.first) / self.spacing).clamp(0.0, (self.count - 1) as f64);
        (0..self.count).map(|i| (1.0 - (place - i as f64).abs()).max(0.0)).collect()
    }

    /// Lower triangular factor of the covariance of the nodes' values: an Ornstein-Uhlenbeck process of variance one.
    fn factor(&self) -> DMatrix<f64> {
        let covariance = DMatrix::from_fn(self.count, self.count, |i, j| {
            (-(self.spacing * i.abs_diff(j) as f64 / LENGTH)).exp()
        });
        covariance.cholesky().map_or_else(|| DMatrix::identity(self.count, self.count), |c| c.l())
    }
}

/// Groups records into levels by the amplitude that they begin with. `logs` are the ln amplitudes in each record's windows; each level lists the
/// indices of its records.
fn levels(logs: &[Vec<f64>]) -> Vec<Vec<usize>> {
    let first = |i: usize| logs[i].first().copied().unwrap_or(f64::NEG_INFINITY);
    let mut order: Vec<usize> = (0..logs.len()).collect();
    order.sort_by(|a, b| first(*a).total_cmp(&first(*b)));
    let mut levels: Vec<Vec<usize>> = Vec::new();
    for i in order {
        match levels.last_mut() {
            Some(level) if first(i) < first(level[0]) + LEVEL.ln() => level.push(i),
            _ => levels.push(vec![i]),
        }
    }
    levels
}

impl Task {
    /// The processes at a point, with nodes `spacing` apart in ln amplitude; none where there is no model.
    pub(super) fn components(&self, x: &[f64], spacing: f64, work: &mut Workspace) -> Option<Vec<Component>> {
        let models = self.models(x, work)?;
        let logs: Vec<Vec<f64>> =
            models.iter().zip(&self.records).map(|(m, r)| log_amplitudes(m, r)).collect();
        let shift = shift(&models, &self.records);
        // One process for each group of records, over the amplitudes that these hold.
        let component = |kind: Kind, groups: Vec<Vec<usize>>| {
            let of = |records: Vec<usize>| {
                let nodes = Nodes::over(records.iter().map(|i| logs[*i].as_slice()), spacing);
                let factor = nodes.factor();
                let one = |i: &usize| {
                    let [d, w] = derivatives(&self.records[*i], &models[*i], &logs[*i], &nodes);
                    let mut columns = DMatrix::zeros(d.nrows(), 2 * nodes.count);
                    columns.columns_mut(0, nodes.count).copy_from(&(d * &factor));
                    columns.columns_mut(nodes.count, nodes.count).copy_from(&(w * &factor * shift));
                    columns
                };
                Process { width: 2 * nodes.count, columns: records.iter().map(one).collect(), records }
            };
            Component { kind, shift, processes: groups.into_iter().map(of).collect() }
        };
        let records = models.len();
        let mut all = vec![component(Kind::Shared, vec![(0..records).collect()])];
        let levels = levels(&logs);
        if levels.len() > 1 && levels.len() < records {
            all.push(component(Kind::OfLevel, levels));
        }
        if records > 1 {
            all.push(component(Kind::OfRecord, (0..records).map(|i| vec![i]).collect()));
        }
        if self.has_days() {
            all.push(self.even(&models, &logs));
        }
        Some(all)
    }
}

impl Task {
    /// The process of each record's own offset of ln D, the same at all amplitudes.
    fn even(&self, models: &[Vec<Complex64>], logs: &[Vec<f64>]) -> Component {
        let of = |i: usize| {
            let one = column(&self.records[i], even(&models[i], &logs[i]));
            Process { width: 1, records: vec![i], columns: vec![DMatrix::from_vec(one.len(), 1, one)] }
        };
        Component { kind: Kind::Even, shift: 0.0, processes: (0..models.len()).map(of).collect() }
    }
}

/// Relative range of the frequency over the models' windows, times [`PART_OF_SHIFT`].
fn shift(models: &[Vec<Complex64>], records: &[Windowed]) -> f64 {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (model, record) in models.iter().zip(records) {
        let radians = record.windows.hop * record.windows.omega;
        for pair in model.windows(2) {
            let ratio = 1.0 + (pair[1] / pair[0]).arg() / radians;
            (low, high) = (low.min(ratio), high.max(ratio));
        }
    }
    PART_OF_SHIFT * (high - low).max(LEAST_SHIFT)
}

/// ln of the displacement amplitude in each window of a model, up to a constant that all windows share.
fn log_amplitudes(model: &[Complex64], record: &Windowed) -> Vec<f64> {
    let power = f64::from(record.quantity.power());
    // A window's amplitude is the amplitude of the motion times the integral of the window.
    let constant = power * record.windows.omega.ln() + record.windows.hop.ln();
    model.iter().map(|z| z.norm().max(f64::MIN_POSITIVE).ln() - constant).collect()
}

/// Derivatives of the logarithms of a record's complex amplitudes with respect to an offset of ln D that is the same at all amplitudes. With more
/// dissipation amplitudes are smaller, and with a joint that softens the phase runs ahead.
fn even(model: &[Complex64], logs: &[f64]) -> Vec<Complex64> {
    let mut turns = vec![Complex64::default(); model.len()];
    let (mut ahead, mut before) = (0.0, None::<f64>);
    for k in 1..model.len() {
        let (fallen, now) = (logs[k] - logs[0], (model[k] / model[k - 1]).arg());
        if let Some(before) = before.replace(now) {
            // The phase from window to window changes with ln amplitude by the slope of the curve of frequency over ln amplitude.
            let change = logs[k] - logs[k - 1];
            let slope = if change < 0.0 { (now - before) / change } else { 0.0 };
            ahead += slope * fallen;
        }
        turns[k] = Complex64::new(fallen, ahead);
    }
    turns
}

/// Change of a record's residuals where the logarithms of its amplitudes change by `turns`: real and imaginary part of each window, one after the
/// other.
fn column(record: &Windowed, mut turns: Vec<Complex64>) -> Vec<f64> {
    turns.iter_mut().zip(&record.amplitudes).for_each(|(turn, z)| *turn *= z);
    record.whitening.apply(&mut turns);
    turns
        .iter()
        .zip(&record.deviations)
        .flat_map(|(z, deviation)| [z.re / deviation, z.im / deviation])
        .collect()
}

/// Derivatives of a record's residuals with respect to the nodes' values of ln D (first matrix) and of ln ω (second), one column per node: real and
/// imaginary part of each window, one after the other.
fn derivatives(record: &Windowed, model: &[Complex64], logs: &[f64], nodes: &Nodes) -> [DMatrix<f64>; 2] {
    let radians = record.windows.hop * record.windows.omega;
    let mut out =
        [DMatrix::zeros(2 * model.len(), nodes.count), DMatrix::zeros(2 * model.len(), nodes.count)];
    let hats: Vec<Vec<f64>> = logs.iter().map(|l| nodes.hats(*l)).collect();
    for node in 0..nodes.count {
        for (which, out) in out.iter_mut().enumerate() {
            let (mut sum, mut turns) = (0.0, Vec::with_capacity(model.len()));
            for (k, hat) in hats.iter().enumerate() {
                if k > 0 {
                    let mean = 0.5 * (hat[node] + hats[k - 1][node]);
                    sum += mean * if which == 0 { logs[k] - logs[k - 1] } else { radians };
                }
                turns.push(if which == 0 { Complex64::new(sum, 0.0) } else { Complex64::new(0.0, sum) });
            }
            out.column_mut(node).copy_from_slice(&column(record, turns));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeats_make_a_level_and_harder_hits_another() {
        let logs = [1.0, 0.12, 1.1, 0.1, 0.11].map(|a: f64| vec![a.ln(), a.ln() - 1.0]);
        assert_eq!(levels(&logs), [vec![3, 4, 1], vec![0, 2]]);
    }
}
