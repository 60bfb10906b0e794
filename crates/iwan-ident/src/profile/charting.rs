//! The same task in coordinates that a profile can walk along.

use crate::parameters::Parameter;
use crate::refine::Task;
use crate::search::{Chart, Minimum};

impl Task {
    /// The same task in the chart in which the parameter is a coordinate.
    pub(super) fn charting(&self, parameter: Parameter) -> Self {
        let coordinates: Vec<Parameter> = self.held().iter().copied().chain([parameter]).collect();
        let mut task = self.clone();
        task.chart = Chart::holding(&coordinates, self.chart.amplitude);
        task
    }

    /// A minimum of `other`, the same task in another chart, in the coordinates of this task.
    pub(super) fn from(&self, other: &Self, minimum: &Minimum) -> Minimum {
        Minimum { x: other.converted(&self.chart, &minimum.x), ..*minimum }
    }

    /// The point `x` in the coordinates of another chart; unchanged where its parameters are no model.
    fn converted(&self, chart: &Chart, x: &[f64]) -> Vec<f64> {
        let mut moved = x.to_vec();
        if let Ok(own) = chart.coordinates(&self.chart.parameters(x)) {
            moved[..own.len()].copy_from_slice(&own);
            Self::keep_days(x, &mut moved);
        }
        moved
    }
}
