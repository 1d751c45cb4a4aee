//! What the gallery writes beside the pictures: a page for a browser, and a list in Markdown.

use std::fmt::Write as _;

use maud::html;

use super::Exhibit;
use crate::commands::html;

/// What a gallery shows.
pub struct Page<'g> {
    pub exhibits: &'g [Exhibit],
    pub left_out: &'g [String],
    pub failed: &'g [String],
    pub size: [u32; 2],
    pub adapter: &'g str,
}

const STYLE: &str = "
    main { display: grid; gap: 1.5rem; grid-template-columns: repeat(auto-fill, minmax(20rem, 1fr)); }
    article { background: #1f2226; border-radius: 6px; overflow: hidden; }
    article > div { padding: .6rem 1rem 1rem; }
    img { display: block; width: 100%; height: auto; background: #000; }
    .time { color: #93a0ad; }
";

impl Page<'_> {
    /// The page. It shows the pictures beside it and reads nothing else.
    pub fn html(&self) -> String {
        let [width, height] = self.size;
        let body = html! {
            h1 { "volgraph: gallery" }
            p { (self.exhibits.len()) " graphs of " (width) " × " (height) " pixels. \
                A frame's time is the median of some, reading back included." }
            @if !self.left_out.is_empty() {
                p { "Left out, as their volumes were not found: " (self.left_out.join(", ")) "." }
            }
            @if !self.failed.is_empty() {
                p { "Failed: " (self.failed.join(", ")) "." }
            }
            main {
                @for exhibit in self.exhibits {
                    article id=(exhibit.name) {
                        a href=(exhibit.picture) {
                            img src=(exhibit.picture) alt=(exhibit.draws) width=(width) height=(height) loading="lazy";
                        }
                        div {
                            h2 { (exhibit.name) }
                            p { (exhibit.draws) }
                            p class="time" { (format!("{:.1}", exhibit.frame_ms)) " ms a frame, "
                                (format!("{:.0}", exhibit.first_ms)) " ms to the first" }
                            details {
                                summary { "volgraph render " (exhibit.name) " -o " (exhibit.picture) }
                                pre { (exhibit.graph) }
                            }
                        }
                    }
                }
            }
        };
        let page = html::Page {
            title: "volgraph: gallery",
            style: STYLE,
            adapter: self.adapter,
        };
        page.around(&body)
    }

    /// The pictures with names and sentences, three in a row.
    pub fn markdown(&self) -> String {
        let mut text = String::from("| | | |\n| --- | --- | --- |\n");
        for row in self.exhibits.chunks(3) {
            let mut cells: Vec<String> = row
                .iter()
                .map(|exhibit| {
                    format!(
                        "![{}]({})<br>`{}`: {}",
                        exhibit.name, exhibit.picture, exhibit.name, exhibit.draws
                    )
                })
                .map(|cell| cell.replace('|', "\\|"))
                .collect();
            cells.resize(3, String::new());
            // Writing to a String does not fail.
            let _ = writeln!(text, "| {} |", cells.join(" | "));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_escaped_and_rows_are_whole() {
        let exhibit = |name: &str| Exhibit {
            name: name.to_owned(),
            draws: "a < b | c.".to_owned(),
            graph: "(a: \"<script>\")".to_owned(),
            picture: format!("{name}.png"),
            first_ms: 10.0,
            frame_ms: 1.0,
        };
        let exhibits = [exhibit("a"), exhibit("b"), exhibit("c"), exhibit("d")];
        let page = Page {
            exhibits: &exhibits,
            left_out: &["e".to_owned()],
            failed: &[],
            size: [8, 8],
            adapter: "some <adapter>",
        };
        let html = page.html();
        assert!(html.contains("&lt;script&gt;") && !html.contains("<script>"));
        assert!(html.contains("some &lt;adapter&gt;") && html.contains("not found: e."));
        assert!(!html.contains("Failed"));
        let markdown = page.markdown();
        assert_eq!(markdown.lines().count(), 4);
        assert!(
            markdown
                .lines()
                .all(|line| line.replace("\\|", "").matches('|').count() == 4)
        );
    }
}
