//! The interface of every evaluation of the hysteretic joint force.

/// A joint law with memory: parameters in `self`, the history in a separate state.
///
/// One law drives any number of joints; a snapshot is a clone of the state.
///
/// `State` holds what the joint remembers of its past.
pub trait Hysteresis<State> {
    /// The displacement u at which the state stands.
    fn displacement(&self, state: &State) -> f64;

    /// The joint force F at the state.
    fn joint_force(&self, state: &State) -> f64;

    /// Moves monotonically to the displacement `u` and returns the force there.
    ///
    /// A displacement that is not finite leaves the state unchanged; callers check inputs before.
    fn advance(&self, state: &mut State, u: f64) -> f64;

    /// One implicit time step: moves to the displacement u' at which stiffness·(u' - u) + F(u') - F(u) = `load`, and returns u' - u.
    /// `stiffness` > 0 makes the solution unique; a load that is not finite gives NaN.
    fn solve(&self, state: &mut State, stiffness: f64, load: f64) -> f64;

    /// Elastic energy ½∫ρ x² stored in the sliders' springs.
    fn stored_energy(&self, state: &State) -> f64;
}

/// A joint law that can evaluate the force at another displacement without moving its state. An iteration over several joints needs this,
/// because its trial points must leave no trace in the memory.
pub trait Trial<State>: Hysteresis<State> {
    /// Force F and tangent dF/du at the end of a monotone motion from the present state to the displacement `u`.
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

    /// Mean force over a monotone motion to the displacement `u` (work over distance) less the mean of the forces at its two ends, with its
    /// derivative. A step of average acceleration neglects this difference. Where the force is continuous, the difference is of second
    /// order in the step, and the default is 0; where the force jumps, it is of first order.
    fn mean_beyond_ends(&self, state: &State, u: f64) -> (f64, f64) {
        let _ = (state, u);
        (0.0, 0.0)
    }
}
