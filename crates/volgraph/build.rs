//! The embedded templates are part of this crate: an edit of one builds it anew.

fn main() {
    println!("cargo::rerun-if-changed=templates");
}
