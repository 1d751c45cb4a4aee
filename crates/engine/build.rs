//! The embedded shaders and graphs are part of this crate: an edit of one builds it anew.

fn main() {
    for folder in ["../../shaders", "../../graphs"] {
        println!("cargo::rerun-if-changed={folder}");
    }
}
