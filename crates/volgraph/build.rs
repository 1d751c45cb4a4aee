//! The embedded shaders, graphs and templates are part of this crate: an edit of one builds it anew.

fn main() {
    for folder in ["../../shaders", "../../graphs", "templates"] {
        println!("cargo::rerun-if-changed={folder}");
    }
}
