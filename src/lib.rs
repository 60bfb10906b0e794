#![doc = include_str!("../README.md")]

pub use iwan_core as core;
pub use iwan_fem as fem;
pub use iwan_ident as ident;
pub use iwan_io as io;
pub use iwan_modal as modal;
pub use iwan_sim as sim;
pub use iwan_study as study;

/// The book: theory, use and validation. Its Rust code is compiled and run by `cargo test --doc`.
pub mod book {
    #[doc = include_str!("../book/src/introduction.md")]
    pub mod introduction {}

    #[doc = include_str!("../book/src/theory.md")]
    pub mod theory {}

    #[doc = include_str!("../book/src/memory.md")]
    pub mod memory {}

    #[doc = include_str!("../book/src/oscillator.md")]
    pub mod oscillator {}

    #[doc = include_str!("../book/src/steppers.md")]
    pub mod steppers {}

    #[doc = include_str!("../book/src/laws.md")]
    pub mod laws {}

    #[doc = include_str!("../book/src/identification.md")]
    pub mod identification {}

    #[doc = include_str!("../book/src/guide.md")]
    pub mod guide {}

    #[doc = include_str!("../book/src/coupled.md")]
    pub mod coupled {}

    #[doc = include_str!("../book/src/steady.md")]
    pub mod steady {}

    #[doc = include_str!("../book/src/records.md")]
    pub mod records {}

    #[doc = include_str!("../book/src/modal.md")]
    pub mod modal {}

    #[doc = include_str!("../book/src/python.md")]
    pub mod python {}
    #[doc = include_str!("../book/src/structures.md")]
    pub mod structures {}
    #[doc = include_str!("../book/src/update.md")]
    pub mod update {}
    #[doc = include_str!("../book/src/beam.md")]
    pub mod beam {}
    #[doc = include_str!("../book/src/matrices.md")]
    pub mod matrices {}
    #[doc = include_str!("../book/src/reproduce.md")]
    pub mod reproduce {}

    /// Short programs; `cargo run --release --example NAME` runs one.
    ///
    /// # A first ring-down
    /// ```
    #[doc = include_str!("../examples/first_ring_down.rs")]
    /// ```
    /// # Half cycles
    /// ```
    #[doc = include_str!("../examples/half_cycles.rs")]
    /// ```
    /// # A law of one's own
    /// ```
    #[doc = include_str!("../examples/own_law.rs")]
    /// ```
    /// # Modes of a bolted structure
    /// ```
    #[doc = include_str!("../examples/structure_modes.rs")]
    /// ```
    /// # Which method
    /// ```
    #[doc = include_str!("../examples/which_method.rs")]
    /// ```
    /// # A record to parameters
    /// ```
    #[doc = include_str!("../examples/fit_a_record.rs")]
    /// ```
    pub mod examples {}

    /// Virgin curve and loops, dissipation per cycle, and two ring-downs, all of mode 1 of the paper's Table 2.
    ///
    #[doc = include_str!("../book/src/img/loops.svg")]
    ///
    #[doc = include_str!("../book/src/img/loss.svg")]
    ///
    #[doc = include_str!("../book/src/img/ring_down.svg")]
    pub mod figures {}

    #[doc = include_str!("../book/src/errors.md")]
    pub mod errors {}

    #[doc = include_str!("../book/src/trust.md")]
    pub mod trust {}

    #[doc = include_str!("../book/src/validation.md")]
    pub mod validation {}
}
