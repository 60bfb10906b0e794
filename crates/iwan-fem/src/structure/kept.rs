//! Results for which a large structure needs factorisations, kept from an earlier run: modes in both limits, and the basis of a reduced
//! model.

/// Eigenvalues and mass-normalised vectors, one after the other.
#[derive(Debug, Clone, PartialEq)]
pub struct KeptModes {
    /// ω², 1/s², ascending.
    pub values: Vec<f64>,
    /// Vectors, one entry per unknown each, one vector after another.
    pub vectors: Vec<f64>,
    /// Number of zero modes among them.
    pub zero: usize,
}

/// Modes and a reduced basis of a structure, made by [`NamedModes::keep`](crate::NamedModes::keep). If a structure holds them in
/// [`Structure::kept`](crate::Structure::kept), nothing is factored where they suffice.
#[derive(Debug, Clone, PartialEq)]
pub struct Kept {
    /// Fingerprint of the matrices to which the results belong ([`Assembled::fingerprint`](crate::Assembled::fingerprint)).
    pub fingerprint: u64,
    /// Number of elastic modes that were requested and that get names.
    pub named: usize,
    /// Modes with all joints stuck.
    pub stuck: KeptModes,
    /// Modes with all joints slipping.
    pub slipping: KeptModes,
    /// The stuck modes of the basis.
    pub basis: KeptModes,
    /// Attachment vectors of the basis with their eigenvalues; there are no zero modes among them.
    pub attachments: KeptModes,
}
