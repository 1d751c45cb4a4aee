//! Whatever the bytes are: a mesh or an error that says something, never a panic.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use common::Random;
use common::files::*;

/// One change: a bit, a cut, a piece repeated or lost, a number replaced by a nasty one.
fn change(bytes: &mut Vec<u8>, random: &mut Random) {
    const NASTY: [&str; 14] = [
        "0",
        "-1",
        "-9223372036854775808",
        "18446744073709551615",
        "4294967296",
        "4294967295",
        "1e999",
        "nan",
        "-inf",
        "",
        "1000000000",
        "255",
        "1e-320",
        "2147483648",
    ];
    if bytes.is_empty() {
        return;
    }
    let at = random.below(bytes.len());
    let end = (at + random.below(60)).min(bytes.len());
    match random.below(6) {
        0 => bytes[at] ^= 1 << random.below(8),
        1 => bytes[at] = random.below(256) as u8,
        2 => bytes.truncate(at),
        3 => drop(bytes.drain(at..end)),
        4 => {
            let piece = bytes[at..end].to_vec();
            bytes.splice(at..at, piece);
        }
        _ => {
            let starts: Vec<usize> = (0..bytes.len())
                .filter(|&i| {
                    bytes[i].is_ascii_digit() && (i == 0 || !bytes[i - 1].is_ascii_digit())
                })
                .collect();
            let Some(&start) = starts.get(random.below(starts.len().max(1))) else {
                return;
            };
            let digits = bytes[start..]
                .iter()
                .take_while(|byte| byte.is_ascii_digit())
                .count();
            let nasty = NASTY[random.below(NASTY.len())];
            bytes.splice(start..start + digits, nasty.bytes());
        }
    }
}

#[test]
fn whatever_the_bytes_are_there_is_a_mesh_or_a_reason() {
    let mut random = Random(11);
    for (name, _, good) in files() {
        let (mut read_well, mut refused) = (0, 0);
        for _ in 0..2000 {
            let mut bytes = good.clone();
            for _ in 0..1 + random.below(3) {
                change(&mut bytes, &mut random);
            }
            match read(name, &bytes) {
                Ok(mesh) => {
                    read_well += 1;
                    assert!(mesh.positions().iter().all(|position| position.is_finite()));
                    assert!(
                        mesh.triangles()
                            .iter()
                            .flatten()
                            .all(|&i| (i as usize) < mesh.positions().len())
                    );
                    let _ = mesh.report().to_string();
                }
                Err(error) => {
                    refused += 1;
                    says_something(&error, name);
                }
            }
        }
        assert!(
            read_well > 50 && refused > 200,
            "{name}: {read_well} read, {refused} refused"
        );
    }
    for _ in 0..2000 {
        let start = [
            &b"ply\n"[..],
            b"solid \nfacet",
            b"v ",
            b"\x1f\x8b\x08\0",
            b"",
        ][random.below(5)];
        let mut bytes = start.to_vec();
        bytes.extend((0..random.below(200)).map(|_| random.below(256) as u8));
        if let Err(error) = read("a.stl", &bytes) {
            says_something(&error, "a.stl");
        }
    }
}
