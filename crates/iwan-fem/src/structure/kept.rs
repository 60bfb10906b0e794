//! What a large structure is factored for, kept from an earlier time: modes in both limits and the basis of a reduced model.

/// Eigenvalues and mass-normalised vectors, one after the other.
#[derive(Debug, Clone, PartialEq)]
pub struct KeptModes {
    /// ω², 1/s², ascending.
    pub values: Vec<f64>,
    /// Vectors in the unknowns.
    pub vectors: Vec<f64>,
    /// How many of them are zero modes.
    pub zero: usize,
}

/// Modes and a reduced basis of a structure, as [`NamedModes::keep`](crate::NamedModes::keep) made them: with them in
/// [`Structure::kept`](crate::Structure::kept) nothing is factored where they serve.
#[derive(Debug, Clone, PartialEq)]
pub struct Kept {
    /// That of the matrices to which all this belongs ([`Assembled::fingerprint`](crate::Assembled::fingerprint)).
    pub fingerprint: u64,
    /// Elastic modes that were asked for; those to be named.
    pub named: usize,
    /// Modes with all joints stuck.
    pub stuck: KeptModes,
    /// Modes with all joints slipping.
    pub slipping: KeptModes,
    /// The stuck modes of the basis.
    pub basis: KeptModes,
    /// Its attachment vectors, with their eigenvalues; no zero modes.
    pub attachments: KeptModes,
}
