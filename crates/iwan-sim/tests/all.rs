//! All tests of iwan-sim in one program: linked once, and run side by side.

mod five_parameter;
mod forced;
mod harmonics;
mod methods;
mod parts_and_curves;
mod printed_errors;
mod steady_peers;
