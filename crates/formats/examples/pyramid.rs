//! Builds the pyramid of a volume and reads bricks of it at random: times, memory and rates.
//!
//! `cargo run --release -p volgraph-formats --example pyramid -- FILE [MiB] [shard chunks]`
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a measurement prints, and stops at the first error"
)]

use std::path::Path;
use std::time::Instant;

use rayon::prelude::*;
use volgraph_formats::bricks::{BrickStore, BuildOptions, StoreOptions, build, pyramid_path};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let source = Path::new(&arguments[0]);
    let mut options = BuildOptions::default();
    if let Some(limit) = arguments.get(1) {
        options.max_memory = limit.parse::<u64>().unwrap() << 20;
    }
    options.shard_chunks = arguments.get(2).map(|n| n.parse().unwrap());
    options.overwrite = true;
    let start = Instant::now();
    let built = build(source, &pyramid_path(source), &options).unwrap();
    println!(
        "{} levels ({} written) in {:.1?}, peak {} MiB",
        built.levels,
        built.written,
        start.elapsed(),
        peak() >> 10
    );
    for mapped in [true, false] {
        let store_options = StoreOptions {
            mapped,
            ..StoreOptions::default()
        };
        let start = Instant::now();
        let store = BrickStore::open(source, &store_options).unwrap();
        println!("mapped {mapped}: opened in {:.1?}", start.elapsed());
        for level in 0..store.levels().len() {
            let bricks = store.levels()[level].bricks;
            for order in ["random", "in order"] {
                let count = 2000_u64;
                let start = Instant::now();
                (0..count).into_par_iter().for_each(|i| {
                    let random = i.wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
                    let i = if order == "random" { random } else { i };
                    let [x, y, z] = bricks.map(u64::from);
                    let at = [i % x, i / x % y, i / (x * y) % z].map(|n| n as u32);
                    store.read_brick(level, at).unwrap();
                });
                let each = start.elapsed().as_secs_f64() / count as f64;
                println!("level {level} {order}: {:.0} bricks a second", 1.0 / each);
            }
        }
        for level in 0..store.levels().len() {
            println!(
                "brick 0 of {level}: {:?}",
                store.brick_info(level, [0; 3]).unwrap()
            );
        }
        println!("{:?}", store.statistics().range());
    }
}

/// Most memory so far, in KiB, where the system tells it.
fn peak() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM"));
    let number = line.and_then(|line| line.split_whitespace().nth(1));
    number.and_then(|number| number.parse().ok()).unwrap_or(0)
}
