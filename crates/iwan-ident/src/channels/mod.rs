//! From many channels to the record of one mode: modal filter, the shape that dominates in a band, combinations of channels.

mod modal;
mod combination;
mod one_mode;

pub use combination::{Combination, strangers};
pub use modal::{Average, DominantShape, ModalFilter, dominant_shape, scaled_average};
pub use one_mode::{NoMode, OneMode, Recording, Shape, one_mode};
