//! What every page of volgraph's is: one document that reads nothing but the pictures beside it.
//!
//! A page gives its title, its body and what its own things look like; the head, the common look and the foot, which says
//! what the page was made with, are from here.

use maud::{DOCTYPE, Markup, PreEscaped, html};

/// The look that pages share; a page's own comes after it.
const STYLE: &str = "
    body { margin: 2rem; background: #15171a; color: #d8dce0; font: 15px/1.45 system-ui, sans-serif; }
    a { color: inherit; }
    h2 { margin: .2rem 0; font-size: 1.1rem; }
    p { margin: .3rem 0; }
    pre { overflow-x: auto; font-size: 12px; }
    footer { margin-top: 2.5rem; font-size: 13px; opacity: .7; }
";

/// A page without its body.
pub struct Page<'p> {
    pub title: &'p str,
    /// The look of the page's own things, CSS.
    pub style: &'p str,
    /// What the page's pictures were drawn on.
    pub adapter: &'p str,
}

impl Page<'_> {
    /// The document.
    pub fn around(&self, body: &Markup) -> String {
        html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    title { (self.title) }
                    style { (PreEscaped(STYLE)) (PreEscaped(self.style)) }
                }
                body {
                    (body)
                    footer { "volgraph " (env!("CARGO_PKG_VERSION")) " on " (self.adapter) }
                }
            }
        }
        .into_string()
    }
}
