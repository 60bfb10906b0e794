//! `iwan modal`: hits of a hammer to frequency responses, mode shapes and modal records.

mod args;
mod geometry;
mod file_of_test;
mod hits;
mod analysis;
mod agreement;
mod linearity;
mod summary;
mod files;
mod figures;
mod shape_picture;
mod report;
mod command;

pub(crate) use args::ModalArgs;
pub(crate) use command::{MODAL, SHAPES, run};
pub(crate) use figures::composite;
