//! Many channels to the record of one mode: modal filter, the shape that dominates in a band, combinations of channels.

mod modal;
mod combination;

pub use combination::{Combination, strangers};
pub use modal::{Average, DominantShape, ModalFilter, dominant_shape, scaled_average};
