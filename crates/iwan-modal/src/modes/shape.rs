//! From residues to modes: R = λ^d ψ_response ψ_force for each pair, with ψ = φ/√(2i ω_d) of mass-normalised φ.

use std::f64::consts::TAU;

use super::compare::phase_collinearity;
use crate::fit::Fitted;
use crate::measure::Freedom;
use crate::number::{Complex, I, complex};
use crate::responses::{FrequencyResponses, Function};

/// How the shapes of a fit are scaled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Mass-normalised, by a point at which force and response were both measured.
    DrivePoint,
    /// To a largest value of 1, where there is no such point.
    LargestIsOne,
}

/// A mode of vibration.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// Pole, 1/s.
    pub pole: nalgebra::Complex<f64>,
    /// Natural frequency |λ|/2π, Hz.
    pub frequency: f64,
    /// Damping ratio -Re λ/|λ|.
    pub damping_ratio: f64,
    /// Standard deviation of the frequency, Hz.
    pub frequency_sd: f64,
    /// Standard deviation of the damping ratio.
    pub damping_ratio_sd: f64,
    /// Complex shape, one value for each freedom of the fit.
    pub shape: Vec<nalgebra::Complex<f64>>,
    /// Real shape: the complex one projected onto the line in the complex plane along which it mainly lies.
    pub real_shape: Vec<f64>,
    /// Standard deviation of the real shape's values.
    pub shape_sd: Vec<f64>,
    /// Modal phase collinearity, 1 for a real shape.
    pub phase_collinearity: f64,
    /// Cosine of the angle between the drive point's residue and that of a point that moves with its force: 1 for real modes, -1 where a
    /// direction is reversed; none without a drive point.
    pub drive_phase: Option<f64>,
    /// Factor by which the shape was stretched because the start of the decay gives another scale than the whole of it; the mode is then not linear. None where it was not.
    pub stretch: Option<f64>,
    /// Largest relative difference between pairs of response and force that reciprocity makes equal, over the larger one; none where no pair was measured both ways.
    pub reciprocity: Option<f64>,
}

/// The point that the hammer hits, among the freedoms of the shapes; the first one where there are several.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Index of the freedom.
    pub freedom: usize,
    /// +1 where the freedom's direction is that of the force, -1 where it is opposite.
    pub sign: f64,
    /// Whether the hammer roved: the shape is then given at the points of force, as seen by one sensor.
    pub roving_hammer: bool,
}

/// Freedoms of the shapes, names of the channels there, scale, drive point, and the modes.
pub(crate) struct Shapes {
    pub(crate) freedoms: Vec<Freedom>,
    pub(crate) names: Vec<String>,
    pub(crate) scale: Scale,
    pub(crate) drive: Option<Drive>,
    pub(crate) modes: Vec<Mode>,
}

/// Shapes from the residues of a fit, for the poles for which `inside` holds.
pub(crate) fn modes(
    responses: &FrequencyResponses,
    fitted: &Fitted,
    inside: &dyn Fn(Complex) -> bool,
) -> Shapes {
    let pairs = Pairs::new(&responses.functions);
    let scale = if pairs.drives.is_empty() { Scale::LargestIsOne } else { Scale::DrivePoint };
    let chosen = (0..fitted.poles.len()).filter(|p| inside(fitted.poles[*p]));
    let modes = chosen.map(|p| mode(responses, fitted, &pairs, p)).collect();
    let (freedoms, names) = pairs.shape_side(&responses.functions);
    Shapes { freedoms, names, scale, drive: pairs.drive(), modes }
}

/// The functions as entries of a matrix, with rows for response freedoms and columns for force freedoms.
struct Pairs {
    rows: Vec<Freedom>,
    columns: Vec<Freedom>,
    /// Row and column of each function.
    places: Vec<(usize, usize)>,
    /// Row and column of each pair at the same point, and the sign between their directions.
    drives: Vec<(usize, usize, f64)>,
}

impl Pairs {
    fn new(functions: &[Function]) -> Self {
        let (mut rows, mut columns): (Vec<Freedom>, Vec<Freedom>) = (Vec::new(), Vec::new());
        let place = |list: &mut Vec<Freedom>, freedom: &Freedom| {
            list.iter().position(|f| f == freedom).unwrap_or_else(|| {
                list.push(freedom.clone());
                list.len() - 1
            })
        };
        let places: Vec<_> = functions
            .iter()
            .map(|f| (place(&mut rows, &f.response), place(&mut columns, &f.force)))
            .collect();
        let drive = |(i, j): &(usize, usize)| {
            let (r, c) = (&rows[*i], &columns[*j]);
            r.is_at(c).then(|| (*i, *j, r.direction.sign() * c.direction.sign()))
        };
        let drives = places.iter().filter_map(drive).collect();
        Self { rows, columns, places, drives }
    }

    /// Whether the shape is given at the points of force, because the hammer roves.
    fn by_force(&self) -> bool {
        self.columns.len() > self.rows.len()
    }

    fn drive(&self) -> Option<Drive> {
        let (row, column, sign) = *self.drives.first()?;
        let roving_hammer = self.by_force();
        // At the points of force the directions are those of the forces themselves.
        let (freedom, sign) = if roving_hammer { (column, 1.0) } else { (row, sign) };
        Some(Drive { freedom, sign, roving_hammer })
    }

    /// Freedoms of the shape, and the names of the channels there; the names of the points where two channels have the same name, or the hammer roves.
    fn shape_side(&self, functions: &[Function]) -> (Vec<Freedom>, Vec<String>) {
        if self.by_force() {
            return (self.columns.clone(), self.columns.iter().map(Freedom::to_string).collect());
        }
        let channel = |i: usize| {
            let function = self.places.iter().position(|(row, _)| *row == i);
            function.map_or_else(String::new, |k| functions[k].name.clone())
        };
        let names: Vec<String> = (0..self.rows.len()).map(channel).collect();
        let unlike = (0..names.len()).all(|i| !names[..i].contains(&names[i]));
        let names = if unlike { names } else { self.rows.iter().map(Freedom::to_string).collect() };
        (self.rows.clone(), names)
    }
}

/// Number of rounds of alternating least squares for the two factors of a matrix of rank one: complete matrices need one, those with missing entries a few.
const ROUNDS: usize = 20;

/// Values of rows and of columns whose products are the residues of displacement over force (`receptance`).
fn sides(pairs: &Pairs, receptance: &[Complex]) -> (Vec<Complex>, Vec<Complex>) {
    let zero = complex(0.0, 0.0);
    let (mut u, mut v) = (vec![zero; pairs.rows.len()], vec![complex(1.0, 0.0); pairs.columns.len()]);
    let solve = |known: &[Complex], sought: &mut [Complex], turned: bool| {
        let (mut product, mut power) = (vec![zero; sought.len()], vec![0.0; sought.len()]);
        for ((i, j), a) in pairs.places.iter().zip(receptance) {
            let (mine, other) = if turned { (*j, *i) } else { (*i, *j) };
            product[mine] += known[other].conj() * a;
            power[mine] += known[other].norm_sqr();
        }
        for (x, (p, n)) in sought.iter_mut().zip(product.iter().zip(&power)) {
            *x = if *n > 0.0 { p / *n } else { zero };
        }
    };
    let rounds = if pairs.columns.len() == 1 || pairs.rows.len() == 1 { 1 } else { ROUNDS };
    for _ in 0..rounds {
        solve(&v, &mut u, false);
        solve(&u, &mut v, true);
    }
    (u, v)
}

fn mode(responses: &FrequencyResponses, fitted: &Fitted, pairs: &Pairs, p: usize) -> Mode {
    let pole = fitted.poles[p];
    let factor = pole.powi(responses.motion.derivatives()).inv();
    let receptance: Vec<Complex> = fitted.residues[p].iter().map(|r| r * factor).collect();
    let (u, v) = sides(pairs, &receptance);
    // With α² the products u_i v_j become φ_i φ_j / (2i ω_d): at the drive point α u equals v/α.
    let root = (2.0 * I * pole.im).sqrt();
    let (mut above, mut below) = (complex(0.0, 0.0), 0.0);
    for (i, j, sign) in &pairs.drives {
        above += u[*i].conj() * v[*j] * *sign;
        below += u[*i].norm_sqr();
    }
    let alpha = if below > 0.0 { (above / below).sqrt() } else { complex(1.0, 0.0) };
    let raw: Vec<Complex> = if pairs.by_force() {
        v.iter().map(|x| x / alpha * root).collect()
    } else {
        u.iter().map(|x| x * alpha * root).collect()
    };
    let (shape, real_shape, unit) = oriented(raw, pairs.drives.is_empty());
    let certainty = fitted.certainty.pole(p);
    let (frequency_sd, damping_ratio_sd) = deviations(pole, certainty);
    Mode {
        pole,
        frequency: pole.norm() / TAU,
        damping_ratio: -pole.re / pole.norm(),
        frequency_sd,
        damping_ratio_sd,
        phase_collinearity: phase_collinearity(&shape),
        shape_sd: shape_deviations(
            fitted,
            pairs,
            p,
            &real_shape,
            unit * factor.norm() * root.norm(),
            (&u, &v, alpha),
        ),
        drive_phase: drive_phase(pairs, &receptance, pole),
        stretch: None,
        reciprocity: reciprocity(pairs, &receptance),
        shape,
        real_shape,
    }
}

/// The shape with its largest value positive, its real projection along its own line in the complex plane, and the factor by which a shape without a scale was stretched.
fn oriented(mut shape: Vec<Complex>, free: bool) -> (Vec<Complex>, Vec<f64>, f64) {
    let square: Complex = shape.iter().map(|x| x * x).sum();
    let turn = Complex::from_polar(1.0, -0.5 * square.arg());
    let largest =
        shape.iter().copied().max_by(|a, b| a.norm().total_cmp(&b.norm())).unwrap_or(complex(1.0, 0.0));
    let sign = if (largest * turn).re < 0.0 { -1.0 } else { 1.0 };
    let stretch = if free { largest.norm().max(f64::MIN_POSITIVE).recip() } else { 1.0 };
    // Mass-normalised complex shapes keep their phase, which belongs to the scale. Shapes without a scale are turned to the real axis.
    let factor = if free { turn * sign * stretch } else { complex(sign, 0.0) };
    let real = shape.iter().map(|x| (x * turn).re * sign * stretch).collect();
    for x in &mut shape {
        *x *= factor;
    }
    (shape, real, stretch)
}

/// Standard deviations of frequency (Hz) and damping ratio, from the covariance of the pole.
fn deviations(pole: Complex, [re, im, both]: [f64; 3]) -> (f64, f64) {
    let size = pole.norm();
    let (a, b) = (pole.re / size, pole.im / size);
    let frequency = (a * a * re + b * b * im + 2.0 * a * b * both).max(0.0).sqrt() / TAU;
    // ζ = -σ/|λ|: its gradient is (-ω²/|λ|³, σω/|λ|³).
    let (c, d) = (-b * b / size, a * b / size);
    let damping = (c * c * re + d * d * im + 2.0 * c * d * both).max(0.0).sqrt();
    (frequency, damping)
}

/// Standard deviation of each value of the real shape: from the residues at its own freedom, and from that of the drive point through the scale.
fn shape_deviations(
    fitted: &Fitted,
    pairs: &Pairs,
    p: usize,
    real: &[f64],
    factor: f64,
    (u, v, alpha): (&[Complex], &[Complex], Complex),
) -> Vec<f64> {
    let variance = |k: usize| {
        let [re, im, _] = fitted.certainty.residue(p, k);
        0.5 * (re + im)
    };
    let by_force = pairs.by_force();
    let mut own = vec![(0.0, 0.0); real.len()];
    for (k, (i, j)) in pairs.places.iter().enumerate() {
        let (mine, other) = if by_force { (*j, u[*i] * alpha) } else { (*i, v[*j] / alpha) };
        own[mine].0 += other.norm_sqr() * variance(k);
        own[mine].1 += other.norm_sqr();
    }
    // The scale is the root of a drive point's residue: half its relative deviation goes into all values.
    let drive = |(i, j, _): &(usize, usize, f64)| {
        let k = pairs.places.iter().position(|place| place == &(*i, *j)).unwrap_or(0);
        variance(k) / fitted.residues[p][k].norm_sqr().max(f64::MIN_POSITIVE)
    };
    let scale =
        0.25 * pairs.drives.iter().map(drive).sum::<f64>() / (pairs.drives.len().max(1) as f64).powi(2);
    let one = |(value, (product, power)): (&f64, &(f64, f64))| {
        let own = if *power > 0.0 { factor * factor * product / (power * power) } else { f64::INFINITY };
        (own + value * value * scale).sqrt()
    };
    real.iter().zip(&own).map(one).collect()
}

/// Cosine of the phase at the drive point, where a real mode's residue is φ²/(2i ω_d); none without a drive point.
fn drive_phase(pairs: &Pairs, receptance: &[Complex], pole: Complex) -> Option<f64> {
    let value = |(i, j, sign): &(usize, usize, f64)| {
        let k = pairs.places.iter().position(|place| place == &(*i, *j))?;
        Some(receptance[k] * 2.0 * I * pole.im * *sign)
    };
    let sum: Complex = pairs.drives.iter().filter_map(value).sum();
    (!pairs.drives.is_empty() && sum.norm() > 0.0).then(|| sum.re / sum.norm())
}

/// Largest relative difference of pairs measured both ways: response at a and force at b, response at b and force at a.
fn reciprocity(pairs: &Pairs, receptance: &[Complex]) -> Option<f64> {
    let mut largest: Option<f64> = None;
    for (k, (i, j)) in pairs.places.iter().enumerate() {
        let turned = pairs.places[..k].iter().position(|(a, b)| {
            pairs.rows[*a].is_at(&pairs.columns[*j]) && pairs.columns[*b].is_at(&pairs.rows[*i])
        });
        let Some(m) = turned else { continue };
        let sign =
            |(a, b): (usize, usize)| pairs.rows[a].direction.sign() * pairs.columns[b].direction.sign();
        let (x, y) = (receptance[k] * sign(pairs.places[k]), receptance[m] * sign(pairs.places[m]));
        let difference = (x - y).norm() / x.norm().max(y.norm()).max(f64::MIN_POSITIVE);
        largest = Some(largest.unwrap_or(0.0).max(difference));
    }
    largest
}
