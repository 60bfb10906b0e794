//! What every evaluation of the hysteretic joint force can do.

/// A joint law with memory: parameters in `self`, the history in a state of its own.
///
/// One law drives any number of joints; a snapshot is a clone of the state.
///
/// `State` is what the joint remembers of its past.
pub trait Hysteresis<State> {
    /// The displacement u at which the state stands.
    fn displacement(&self, state: &State) -> f64;

    /// The joint force F at the state.
    fn joint_force(&self, state: &State) -> f64;

    /// Moves monotonically to the displacement `u` and returns the force there.
    ///
    /// A displacement that is not finite moves nothing; check inputs before.
    fn advance(&self, state: &mut State, u: f64) -> f64;

    /// Moves to the displacement u' with stiffness·(u' - u) + F(u') - F(u) = `load` and returns u' - u: one
    /// implicit time step. `stiffness` > 0 makes the solution unique; a load that is not finite gives NaN.
    fn solve(&self, state: &mut State, stiffness: f64, load: f64) -> f64;

    /// Elastic energy ½∫ρ x² stored in the sliders' springs: what the joint could give back.
    fn stored_energy(&self, state: &State) -> f64;
}

/// A joint law that tells the force ahead while its state stays where it is: what an iteration over several joints
/// needs, whose trial points must leave no trace in the memory.
pub trait Trial<State>: Hysteresis<State> {
    /// Force F and tangent dF/du that a monotone motion to the displacement `u` would end with.
    ///
    /// ```
    /// use iwan_core::{Hysteresis, Run, Slider, Sliders, Trial};
    /// let mut table = [Slider::default(); 3];
    /// let sliders = Sliders::from_elements(&[0.1, 0.3], &[2.0, 1.0], &mut table)?;
    /// let state = sliders.virgin([Run::default(); 2])?;
    /// assert_eq!(sliders.trial(&state, 0.2), (0.4, 1.0)); // the first slider would slip, the second hold
    /// assert_eq!(sliders.joint_force(&state), 0.0);
    /// # Ok::<(), iwan_core::Error>(())
    /// ```
    fn trial(&self, state: &State, u: f64) -> (f64, f64);

    /// The mean force over a monotone way to the displacement `u`, work over way, less the mean of the forces at its two ends,
    /// with its derivative: what a step of average acceleration leaves out. It is of second order in the step, and left out, where the
    /// force is continuous; where it jumps it is of first order.
    fn mean_beyond_ends(&self, state: &State, u: f64) -> (f64, f64) {
        let _ = (state, u);
        (0.0, 0.0)
    }
}
