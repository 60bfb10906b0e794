//! One step of the Runge-Kutta pair of Dormand and Prince, for motion that the half-cycle map does not cover.

/// A state of motion: time (s), displacement and velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Moment {
    pub(super) time: f64,
    pub(super) q: f64,
    pub(super) v: f64,
}

/// Result of one step: its end, and the absolute difference of the pair's two velocities at the end.
pub(super) struct Step {
    pub(super) end: Moment,
    pub(super) error: f64,
}

/// The lower triangle of the tableau; its last row also holds the weights of the solution of order 5.
const A: [&[f64]; 6] = [
    &[1.0 / 5.0],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
    &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
    &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];

/// Weights of order 5 minus those of order 4.
const ERROR: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339_200.0, 22.0 / 525.0, -1.0 / 40.0];

/// One step of length `h` of q'' = `acceleration`(q, q') by the pair of orders 5 and 4 (J. R. Dormand and P. J.
/// Prince, J. Comput. Appl. Math. 6:19, 1980, doi:10.1016/0771-050X(80)90013-3).
pub(super) fn step(from: Moment, h: f64, acceleration: impl Fn(f64, f64) -> f64) -> Step {
    let Moment { time, q, v } = from;
    let mut slopes = [(v, acceleration(q, v)); 7];
    let mut end = (q, v);
    for (stage, row) in A.iter().enumerate() {
        let sum = row.iter().zip(&slopes).fold((0.0, 0.0), |s, (a, k)| (s.0 + a * k.0, s.1 + a * k.1));
        end = (q + h * sum.0, v + h * sum.1);
        slopes[stage + 1] = (end.1, acceleration(end.0, end.1));
    }
    let error: f64 = ERROR.iter().zip(&slopes).map(|(e, k)| e * k.1).sum();
    Step { end: Moment { time: time + h, q: end.0, v: end.1 }, error: libm::fabs(h * error) }
}
