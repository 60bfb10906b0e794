//! Pages: numbers as text, axes and figures, pictures of meshes, and the HTML around them.

pub(crate) mod decimate;
pub(crate) mod numbers;
pub(crate) mod scale;

pub(crate) mod figure;
pub(crate) mod heat;
pub(crate) mod solid;

pub(crate) mod html;
