//! The embedded shaders are part of this crate: an edit of one builds it anew.

fn main() {
    println!("cargo::rerun-if-changed=../../shaders");
}
