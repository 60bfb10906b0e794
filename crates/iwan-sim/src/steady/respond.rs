//! Forced responses of modes with joints, with harmonics, along the whole curve.

use std::f64::consts::TAU;

use super::balance::Balance;
use super::continuation::{Follower, Node};
use super::curve::{SteadyCurve, SteadyPoint};
use super::jointed::JointedModes;
use super::one_mode::explicit_response;
use super::problems::{Problem, Task};
use super::receptance::{C, dynamic_stiffness};
use super::sweep::{Control, Sweep};
use crate::error::SimulationError;
use crate::mode::Mode;

/// The steady forced responses of one mode, one curve per level. With one harmonic the curve is explicit; with more harmonics it is
/// followed by arc length.
///
/// `shape_at_output` converts the modal displacement to the response that is held or returned (1 for the modal displacement itself). The
/// force acts through the mode's `shape_at_force`, which under base excitation is the mode's participation φᵀM1.
///
/// # Errors
/// [`SimulationError::Parameter`] for the mode, the band and the levels, or shapes of zero.
///
/// ```
/// use iwan_core::FourParameter;
/// use iwan_sim::{Control, JointLaw, Mode, Sweep, forced_response};
/// let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
/// let mode = Mode::new("bending 1", 124.0, Some(JointLaw::FourParameter(joint)));
/// let sweep = Sweep { from: 110.0, to: 130.0, control: Control::Force, levels: vec![20.0], harmonics: 1, points: 200 };
/// let curves = forced_response(&mode, &sweep, 1.0)?;
/// let peak = curves[0].peak().ok_or(iwan_core::Error::Unsupported { what: "no point" })?;
/// // The force balances friction: f = D/(π a).
/// use iwan_core::Backbone;
/// assert!((joint.dissipation(peak.amplitude) / (std::f64::consts::PI * peak.amplitude) / 20.0 - 1.0).abs() < 1e-9);
/// # Ok::<(), iwan_sim::SimulationError>(())
/// ```
pub fn forced_response(
    mode: &Mode,
    sweep: &Sweep,
    shape_at_output: f64,
) -> Result<Vec<SteadyCurve>, SimulationError> {
    // The explicit response checks all input; its remarks also serve the response with harmonics.
    let explicit = explicit_response(mode, sweep, shape_at_output)?;
    if sweep.harmonics == 1 || mode.joint.is_none() {
        return Ok(explicit);
    }
    let mut jointed = JointedModes::of_mode(mode, shape_at_output)?;
    if sweep.control == Control::BaseAcceleration {
        jointed.modes[0].at_force *= -1.0;
    }
    let mut curves = forced_response_of(&jointed, sweep)?;
    for (curve, explicit) in curves.iter_mut().zip(explicit) {
        curve.remarks.extend(explicit.remarks);
    }
    Ok(curves)
}

/// The steady forced responses of modes that joints couple, one curve per level, with odd harmonics up to `sweep.harmonics`.
///
/// Each curve begins at the lower end of the band, where the force is raised from zero to the level. From there it is followed by arc
/// length through all frequencies at which it turns back. If a curve cannot be followed to the upper end of the band, it is also followed
/// from that end, and a remark says where it ends.
///
/// # Errors
/// [`SimulationError::Parameter`] for the band and the levels.
pub fn forced_response_of(system: &JointedModes, sweep: &Sweep) -> Result<Vec<SteadyCurve>, SimulationError> {
    sweep.checked()?;
    sweep.levels.iter().map(|&level| one_level(system, sweep, level)).collect()
}

/// Largest number of points of a curve; a handful of resonances, each with some hundred points, stay far below. When it is reached, the
/// curve ends with a remark.
const MOST_POINTS: usize = 20_000;

/// Slip, over the strength of a joint, beyond which a curve ends with a remark: nothing but viscous damping limits the motion there.
const FARTHEST: f64 = 1e6;

fn one_level(system: &JointedModes, sweep: &Sweep, level: f64) -> Result<SteadyCurve, SimulationError> {
    let mut curve = SteadyCurve { control: sweep.control, level, points: Vec::new(), remarks: Vec::new() };
    let (up, whole) = from_edge(system, sweep, level, 1.0, &mut curve.remarks)?;
    curve.points = up;
    if !whole {
        let (mut down, _) = from_edge(system, sweep, level, -1.0, &mut curve.remarks)?;
        down.reverse();
        curve.points.extend(down);
    }
    Ok(curve)
}

/// The curve from the lower (`sign` = 1) or the upper (`sign` = -1) edge of the band, and whether it reached the other edge.
fn from_edge(
    system: &JointedModes,
    sweep: &Sweep,
    level: f64,
    sign: f64,
    remarks: &mut Vec<String>,
) -> Result<(Vec<SteadyPoint>, bool), SimulationError> {
    let (edge, other) = if sign > 0.0 { (sweep.from, sweep.to) } else { (sweep.to, sweep.from) };
    let unit = system.lowest();
    let Some((start, force)) = raised(system, sweep, level, TAU * edge)? else {
        remarks.push(format!("no steady motion was found at {edge} Hz by raising the force from nothing"));
        return Ok((Vec::new(), false));
    };
    let task = if sweep.control.holds_response() {
        Task::Held { control: sweep.control, level, force }
    } else {
        Task::Forced { force: level }
    };
    let mut problem = Problem::new(Balance::new(system, sweep.harmonics)?, task, unit);
    let count = problem.unknowns();
    let mut y = start;
    if sweep.control.holds_response() {
        y.push(1.0);
    }
    y.push(TAU * edge / unit);
    let mut follower = Follower::new(&mut problem, count);
    let mut sheet = Sheet { points: Vec::new(), sweep, edge: TAU * other / unit, sign, count };
    let found = follower.at_held(&y, count - 1)?;
    let first = match found {
        Some(y) => follower.first(y, count - 1, sign)?,
        None => None,
    };
    let Some(first) = first else {
        remarks.push(format!("no steady motion was found at {edge} Hz"));
        return Ok((Vec::new(), false));
    };
    let whole = sheet.follow(&mut follower, first, remarks)?;
    Ok((sheet.points, whole))
}

/// The amplitudes at one frequency, and the force that causes them. The force is raised from zero to the level, or, where the response is
/// held, until the response reaches the level.
fn raised(
    system: &JointedModes,
    sweep: &Sweep,
    level: f64,
    omega: f64,
) -> Result<Option<(Vec<f64>, f64)>, SimulationError> {
    /// First forces to try, over the level. At 1e-3 the motion is usually still linear; the smaller ones are for where it is not.
    const STARTS: [f64; 3] = [1e-3, 1e-6, 1e-9];
    /// Largest number of steps; a thousandfold increase of the force takes some hundred.
    const STEPS: usize = 5000;
    let held = sweep.control.holds_response();
    let force = if held { unit_force(system, sweep, level, omega) } else { level };
    let mut problem =
        Problem::new(Balance::new(system, sweep.harmonics)?, Task::Raise { omega, force }, omega);
    let count = problem.unknowns();
    for start in STARTS {
        let mut y = vec![0.0; count];
        y[count - 1] = start;
        let mut follower = Follower::new(&mut problem, count);
        let Some(y) = from_rest(&mut follower, &y)? else { continue };
        let Some(mut node) = follower.first(y, count - 1, 1.0)? else { continue };
        for _ in 0..STEPS {
            let Some((next, _)) = follower.next(&mut node)? else { break };
            let done = if held {
                let [a, b] = follower.curve.response(&next.y)?[0];
                a.hypot(b) >= sweep.control.displacement(level, omega)
            } else {
                next.y[count - 1] >= 1.0
            };
            node = next;
            if done {
                let mut y = node.y.clone();
                if !held {
                    y[count - 1] = 1.0;
                    let Some(exact) = follower.at_held(&y, count - 1)? else { break };
                    y = exact;
                }
                let force = force * y[count - 1];
                y.pop();
                return Ok(Some((y, force)));
            }
        }
    }
    Ok(None)
}

/// The motion under a small force, found from rest in two passes: first with the scales of macro-slip, then with the motion's own.
fn from_rest(
    follower: &mut Follower<'_, Problem<'_>>,
    y: &[f64],
) -> Result<Option<Vec<f64>>, SimulationError> {
    let held = y.len() - 1;
    match follower.at_held(y, held)? {
        Some(y) => follower.at_held(&y, held),
        None => Ok(None),
    }
}

/// The force that causes a response of the level in the stuck structure; it is the unit of the force where the response is held.
fn unit_force(system: &JointedModes, sweep: &Sweep, level: f64, omega: f64) -> f64 {
    let mut flexibility = C::new(system.residual.direct, 0.0);
    for (mode, own) in system.modes.iter().enumerate() {
        let [d, ..] = dynamic_stiffness(system, mode, 1.0, omega, 0.0);
        flexibility += d.inv() * own.at_force * own.at_output;
    }
    let force = sweep.control.displacement(level, omega) / flexibility.norm();
    // At an undamped resonance, or if the excitation does not reach the response, the unit is 1.
    if force > 0.0 && force.is_finite() { force } else { 1.0 }
}

/// A curve while its points are collected.
struct Sheet<'a> {
    points: Vec<SteadyPoint>,
    sweep: &'a Sweep,
    /// The frequency at which the curve ends, in units of the unknown frequency.
    edge: f64,
    sign: f64,
    count: usize,
}

impl Sheet<'_> {
    /// Follows the curve to the edge; returns whether the edge was reached.
    fn follow(
        &mut self,
        follower: &mut Follower<'_, Problem<'_>>,
        first: Node,
        remarks: &mut Vec<String>,
    ) -> Result<bool, SimulationError> {
        let begin = first.y[self.count - 1];
        let mut node = first;
        self.add(follower.curve, &node)?;
        for _ in 0..MOST_POINTS {
            let Some((next, step)) = follower.next(&mut node)? else {
                remarks.push(ended(follower.curve, &node, "the curve cannot be followed any further")?);
                return Ok(false);
            };
            let frequency = next.y[self.count - 1];
            if self.sign * (frequency - self.edge) >= 0.0 {
                let mut y = next.y.clone();
                y[self.count - 1] = self.edge;
                if let Some(y) = follower.at_held(&y, self.count - 1)? {
                    self.add(follower.curve, &Node { y, tangent: next.tangent })?;
                }
                return Ok(true);
            }
            self.between(follower, &node, &next, step)?;
            self.add(follower.curve, &next)?;
            node = next;
            if self.sign * (frequency - begin) < 0.0 {
                remarks.push(ended(follower.curve, &node, "the curve leaves the band")?);
                return Ok(false);
            }
            if slides(follower.curve, &node) {
                remarks.push(ended(follower.curve, &node, "friction and damping do not hold the motion")?);
                return Ok(false);
            }
        }
        remarks.push(ended(follower.curve, &node, "the curve has too many points")?);
        Ok(false)
    }

    /// Adds the maxima of amplitude and the turns of frequency that lie between two nodes.
    fn between(
        &mut self,
        follower: &mut Follower<'_, Problem<'_>>,
        from: &Node,
        to: &Node,
        step: f64,
    ) -> Result<(), SimulationError> {
        let last = self.count - 1;
        let mut found: Vec<(f64, Node)> = Vec::new();
        let turn = [from.tangent[last], to.tangent[last]];
        if turn[0] * turn[1] < 0.0 {
            found.extend(zero(follower, from, step, turn, |_, node| Ok(node.tangent[last]))?);
        }
        let growth =
            [follower.curve.growth(&from.y, &from.tangent)?, follower.curve.growth(&to.y, &to.tangent)?];
        if !self.sweep.control.holds_response() && growth[0] > 0.0 && growth[1] < 0.0 {
            found.extend(zero(follower, from, step, growth, |problem, node| {
                problem.growth(&node.y, &node.tangent)
            })?);
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, node) in &found {
            self.add(follower.curve, node)?;
        }
        Ok(())
    }

    fn add(&mut self, problem: &mut Problem<'_>, node: &Node) -> Result<(), SimulationError> {
        let pairs = problem.response(&node.y)?;
        let state = problem.state(&node.y);
        let polar = |[a, b]: [f64; 2]| [a.hypot(b), (-b).atan2(a)];
        let [amplitude, phase] = polar(pairs[0]);
        self.points.push(SteadyPoint {
            frequency: state.omega / TAU,
            amplitude,
            phase,
            excitation: state.force,
            harmonics: pairs[1..].iter().map(|pair| polar(*pair)).collect(),
            slips: (0..problem.balance.system.joints.len()).map(|j| problem.slip(&node.y, j)[0]).collect(),
        });
        Ok(())
    }
}

/// The remark that says where and why a curve ends.
fn ended(problem: &mut Problem<'_>, node: &Node, why: &str) -> Result<String, SimulationError> {
    let [a, b] = problem.response(&node.y)?[0];
    let frequency = problem.state(&node.y).omega / TAU;
    Ok(format!("{why}: it ends at {frequency:.6} Hz with the amplitude {:.4e}", a.hypot(b)))
}

/// Whether a joint slips by more than [`FARTHEST`] times its strength.
fn slides(problem: &Problem<'_>, node: &Node) -> bool {
    let each = problem.balance.each();
    problem.balance.system.joints.iter().enumerate().any(|(j, joint)| {
        let slip = node.y[j * each].hypot(node.y[j * each + 1]);
        slip > FARTHEST * joint.law.strengths().1
    })
}

/// The node between two nodes at which a quantity vanishes that changes its sign between them, by the Illinois method; with its distance
/// from the first node.
fn zero<'p>(
    follower: &mut Follower<'_, Problem<'p>>,
    from: &Node,
    step: f64,
    ends: [f64; 2],
    of: impl Fn(&mut Problem<'p>, &Node) -> Result<f64, SimulationError>,
) -> Result<Option<(f64, Node)>, SimulationError> {
    /// Largest number of rounds; usually five to seven suffice. The last node is used then.
    const ROUNDS: usize = 12;
    /// Size of the quantity, relative to its larger end value, at which the search ends: the node is then the extremum of its curve to
    /// rounding.
    const SMALL: f64 = 1e-9;
    let ([mut a, mut b], [mut fa, mut fb]) = ([0.0, step], ends);
    let size = fa.abs().max(fb.abs());
    let mut best = None;
    for _ in 0..ROUNDS {
        let at = (a * fb - b * fa) / (fb - fa);
        let Some((node, _)) = follower.at_distance(from, at)? else { break };
        let f = of(follower.curve, &node)?;
        best = Some((at, node));
        if f.abs() <= SMALL * size {
            break;
        }
        if f * fb < 0.0 {
            (a, fa) = (b, fb);
        } else {
            fa *= 0.5;
        }
        (b, fb) = (at, f);
    }
    Ok(best)
}
