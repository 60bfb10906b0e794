//! What all pages share: a page is one self-contained file, begins with the verdict, and sets figures side by side.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::figure::Figure;

/// A self-contained HTML page.
pub(crate) fn page(title: &str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(include_str!("style.css"))) }
            }
            body { (body) }
        }
    };
    iwan_machine::harmless(&page.into_string()).into()
}

/// The warnings as a box; nothing where there are none.
pub(crate) fn warnings(warnings: &[String]) -> Markup {
    html! {
        @if !warnings.is_empty() {
            div.verdict.look { strong { "Please look at:" } ul { @for warning in warnings { li { (warning) } } } }
        }
    }
}

/// The verdict of a page: that all is well, or the warnings; then how exact the result is.
pub(crate) fn verdict(warnings: &[String], exactness: &Markup) -> Markup {
    html! {
        div class=(if warnings.is_empty() { "verdict" } else { "verdict look" }) {
            @if warnings.is_empty() {
                strong { "Nothing to worry about. " }
            } @else {
                strong { "Please look at:" }
                ul { @for warning in warnings { li { (warning) } } }
            }
            (exactness)
        }
    }
}

/// Figures side by side.
pub(crate) fn grid(figures: &[Figure]) -> Markup {
    html! { div.figures { @for figure in figures { (figure.draw()) } } }
}
