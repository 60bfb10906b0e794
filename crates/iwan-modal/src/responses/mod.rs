//! From hits to frequency responses: windows, averages, coherence, and what the end of a record cuts off.

mod set;
mod transform;
mod estimate;
mod free;
mod shift;
mod agreement;

pub use agreement::{Disagreement, disagreements};
pub(crate) use estimate::early_responses;
pub use estimate::{Estimator, Windows, frequency_responses};
pub(crate) use free::common_length;
pub use free::free_responses;
pub use set::{FiniteRecord, FrequencyResponses, Function};
pub(crate) use set::{PoleInRecord, laplace};
