//! Iwan friction models and modal single-degree-of-freedom ring-down.
#![no_std]
