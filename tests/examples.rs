//! Every example runs; each checks a number of its own.
//!
//! The files are modules here, which is why their `main` is `pub(crate)`.
#![allow(clippy::unwrap_used, reason = "a failed test may panic")]

macro_rules! examples {
    ($($name:ident $path:literal),*) => {
        $(
            #[path = $path]
            mod $name;

            #[test]
            fn $name() {
                $name::main().unwrap();
            }
        )*
    };
}

examples! {
    figures "../examples/figures/main.rs",
    first_ring_down "../examples/first_ring_down.rs",
    fit_a_record "../examples/fit_a_record.rs",
    half_cycles "../examples/half_cycles.rs",
    own_law "../examples/own_law.rs",
    structure_modes "../examples/structure_modes.rs",
    which_method "../examples/which_method.rs"
}
