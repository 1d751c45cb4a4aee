//! Pyramids of bricks against closed forms and brute force.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use glam::DVec3;
use volgraph_formats::bricks::{BrickStore, BuildOptions, StoreOptions, build, pyramid_path};
use volgraph_formats::{LoadOptions, WriteOptions, load, write};
use volgraph_volume::{Element, Grid, ScalarType, Volume, VolumeError, Voxels, for_voxels};

/// A volume in a raw file.
fn raw<T: Element>(folder: &Path, dims: [u32; 3], value: impl Fn([u32; 3]) -> T) -> PathBuf {
    let mut bytes: Vec<u8> = Vec::new();
    for z in 0..dims[2] {
        for y in 0..dims[1] {
            let row: Vec<T> = (0..dims[0]).map(|x| value([x, y, z])).collect();
            bytes.extend_from_slice(bytemuck::cast_slice(&row));
        }
    }
    let [x, y, z] = dims;
    let path = folder.join(format!("v_{x}x{y}x{z}_{}.raw", T::TYPE));
    fs::write(&path, bytes).unwrap();
    path
}

fn options(edge: u32) -> BuildOptions {
    BuildOptions {
        edge,
        ..BuildOptions::default()
    }
}

fn built(source: &Path, options: &BuildOptions) -> BrickStore {
    build(source, &pyramid_path(source), options).unwrap_or_else(|error| panic!("{error}"));
    BrickStore::open(source, &StoreOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// A number that looks random.
fn noise([x, y, z]: [u32; 3]) -> u32 {
    let mut h =
        x.wrapping_mul(0x85eb_ca6b) ^ y.wrapping_mul(0xc2b2_ae35) ^ z.wrapping_mul(0x27d4_eb2f);
    h ^= h >> 15;
    h = h.wrapping_mul(0x2c1b_3c6d);
    h ^ (h >> 13)
}

fn whole(store: &BrickStore, level: usize) -> Voxels {
    let dims = store.levels()[level].grid.dims;
    store.read_region(level, [0; 3], dims).unwrap()
}

fn mean(voxels: &Voxels) -> f64 {
    let mut sum = 0.0;
    voxels.for_each(|value| sum += value);
    sum / voxels.len() as f64
}

fn each(dims: [u32; 3]) -> impl Iterator<Item = [u32; 3]> {
    let [nx, ny, nz] = dims;
    (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])))
}

#[test]
fn a_trilinear_function_keeps_its_value_at_every_centre() {
    let folder = tempfile::tempdir().unwrap();
    let f = |p: DVec3| 3.0 + p.x - 2.0 * p.y + 0.5 * p.z + 0.01 * p.x * p.y * p.z;
    let source = raw(folder.path(), [64, 32, 16], |at| {
        f(DVec3::from_array(at.map(f64::from)))
    });
    let store = built(&source, &options(8));
    assert_eq!(store.levels().len(), 4);
    for (number, level) in store.levels().iter().enumerate() {
        let voxels = whole(&store, number);
        for (i, at) in each(level.grid.dims).enumerate() {
            // The world of a raw file is its own index space.
            let index = DVec3::from_array(at.map(f64::from));
            let world = level.grid.world_from_index.transform_point3(index);
            assert!((voxels.get(i) - f(world)).abs() < 1e-10, "{number} {at:?}");
        }
    }
    let corners = |grid: &Grid| grid.corners_world();
    assert_eq!(
        corners(&store.levels()[3].grid),
        corners(&store.levels()[0].grid)
    );
}

#[test]
fn levels_keep_the_mean_of_any_dimensions() {
    let folder = tempfile::tempdir().unwrap();
    for dims in [[37, 21, 11], [33, 1, 5], [64, 64, 64], [65, 17, 129]] {
        let source = raw(folder.path(), dims, |at| f64::from(noise(at) % 1000));
        let store = built(&source, &options(8));
        let want = mean(&whole(&store, 0));
        for level in 1..store.levels().len() {
            assert!(
                (mean(&whole(&store, level)) - want).abs() < 1e-9,
                "{dims:?} {level}"
            );
        }
        assert!((store.statistics().mean - want).abs() < 1e-9);
        assert!(store.levels().last().unwrap().bricks == [1; 3]);
    }
}

#[test]
fn aprons_are_the_cores_of_neighbours() {
    let folder = tempfile::tempdir().unwrap();
    let source = raw(folder.path(), [45, 30, 19], |at| noise(at) as u16);
    let store = built(&source, &options(8));
    let unmapped = StoreOptions {
        mapped: false,
        ..StoreOptions::default()
    };
    let unmapped = BrickStore::open(&source, &unmapped).unwrap();
    for (number, level) in store.levels().iter().enumerate() {
        let all = whole(&store, number);
        let dims = level.grid.dims;
        for brick in each(level.bricks) {
            let voxels = store.read_brick(number, brick).unwrap();
            assert_eq!(voxels, unmapped.read_brick(number, brick).unwrap());
            for (i, at) in each([10; 3]).enumerate() {
                let sample = [0, 1, 2]
                    .map(|a| (brick[a] * 8 + at[a]).saturating_sub(1).min(dims[a] - 1) as usize);
                let [x, y, z] = sample;
                let want = all.get((z * dims[1] as usize + y) * dims[0] as usize + x);
                assert_eq!(voxels.get(i), want, "{number} {brick:?} {at:?}");
            }
        }
    }
}

/// Ranges and errors of all bricks by the definition alone.
fn check_infos(store: &BrickStore) {
    let drawn = |voxels: Voxels, grid: Grid| {
        let values: Vec<f64> = for_voxels!(&voxels, values => values.iter().map(|v| store.drawn(v.to_f64())).collect());
        Volume::new("drawn", grid, values.into()).unwrap()
    };
    let levels = store.levels();
    let edge = store.edge();
    let fine = drawn(whole(store, 0), levels[0].grid);
    let dims = levels[0].grid.dims;
    for (number, level) in levels.iter().enumerate() {
        let shown = drawn(whole(store, number), level.grid);
        let m = level.grid.dims;
        for brick in each(level.bricks) {
            let info = store.brick_info(number, brick).unwrap();
            let (mut min, mut max) = (f64::INFINITY, f64::NEG_INFINITY);
            store.read_brick(number, brick).unwrap().for_each(|value| {
                (min, max) = (min.min(store.drawn(value)), max.max(store.drawn(value)));
            });
            let near = |a: f64, b: f64| (a - b).abs() <= 2e-6 * b.abs().max(1e-3);
            assert!(info.min <= min && near(info.min, min), "{info:?} {min}");
            assert!(info.max >= max && near(info.max, max), "{info:?} {max}");
            let (mut sum, mut most, mut count) = (0.0, 0.0_f64, 0.0_f64);
            for at in each(dims) {
                // The sample's centre in the level's index space.
                let place = [0, 1, 2]
                    .map(|a| (f64::from(at[a]) + 0.5) * f64::from(m[a]) / f64::from(dims[a]) - 0.5);
                let inside = (0..3).all(|a| {
                    ((place[a] + 0.5 + 1e-9) / f64::from(edge)).floor() == f64::from(brick[a])
                });
                if inside {
                    let error = shown.trilinear(DVec3::from_array(place)) - fine.voxel(at);
                    sum += error * error;
                    most = most.max(error.abs());
                    count += 1.0;
                }
            }
            let rms = (sum / count).sqrt();
            assert!(
                near(info.rms_error, rms),
                "{number} {brick:?}: {info:?} {rms}"
            );
            assert!(
                near(info.max_error, most),
                "{number} {brick:?}: {info:?} {most}"
            );
            assert_eq!(number == 0, info.max_error == 0.0);
        }
    }
}

#[test]
fn infos_are_what_brute_force_finds() {
    let folder = tempfile::tempdir().unwrap();
    let small = options(4);
    check_infos(&built(
        &raw(folder.path(), [11, 9, 7], |at| noise(at) as u8),
        &small,
    ));
    check_infos(&built(
        &raw(folder.path(), [8, 16, 5], |at| noise(at) as u16),
        &small,
    ));
    check_infos(&built(
        &raw(folder.path(), [13, 4, 10], |at| noise(at) as i16),
        &small,
    ));
    check_infos(&built(
        &raw(folder.path(), [17, 6, 3], |at| noise(at) as f32 / 1e9),
        &small,
    ));
    // What is not finite is compared as it is drawn.
    let broken = raw(folder.path(), [10, 9, 12], |at| match noise(at) % 7 {
        0 => f32::NAN,
        1 => f32::INFINITY,
        2 => f32::NEG_INFINITY,
        _ => noise(at) as f32 / 1e9,
    });
    check_infos(&built(&broken, &small));
}

#[test]
fn statistics_are_those_of_the_whole_volume() {
    let folder = tempfile::tempdir().unwrap();
    for (edge, dims) in [(4, [19, 11, 8]), (32, [19, 11, 8])] {
        let source = raw(folder.path(), dims, |at| match noise(at) % 9 {
            0 => f32::NAN,
            1 => f32::INFINITY,
            _ => noise(at) as f32,
        });
        let mut options = options(edge);
        options.overwrite = true;
        let store = built(&source, &options);
        let volume = load(&source, &LoadOptions::default()).unwrap();
        let (got, want) = (store.statistics(), volume.statistics());
        assert_eq!((got.min, got.max), (want.min, want.max));
        assert!((got.mean / want.mean - 1.0).abs() < 1e-12);
        assert!((got.standard_deviation / want.standard_deviation - 1.0).abs() < 1e-12);
        assert_eq!(got.finite_count, want.finite_count);
        assert_eq!(got.nan_count, want.nan_count);
        assert_eq!(got.positive_infinity_count, want.positive_infinity_count);
        assert_eq!(got.histogram, volume.histogram(4096));
    }
    let none = raw(folder.path(), [5, 5, 5], |_| f32::NAN);
    let store = built(&none, &options(4));
    assert_eq!(
        (store.statistics().range(), store.drawn(f64::NAN)),
        (None, 0.0)
    );
    assert_eq!(store.brick_info(1, [0; 3]).unwrap().max_error, 0.0);
}

#[test]
fn headers_with_one_run_are_read_where_their_voxels_lie() {
    let folder = tempfile::tempdir().unwrap();
    let values: Vec<i16> = each([20, 12, 9]).map(|at| noise(at) as i16).collect();
    let mut grid = Grid::axis_aligned([20, 12, 9], DVec3::new(1.0, 2.0, 3.0), DVec3::ONE);
    grid.world_from_index.matrix3.x_axis = DVec3::new(0.0, 1.0, 0.25);
    grid.world_from_index.matrix3.y_axis = DVec3::new(-2.0, 0.0, 0.0);
    let volume = Volume::new("v", grid, values.into()).unwrap();
    for name in ["v.nrrd", "v.nhdr", "v.mha", "w.mhd", "v.nii", "v.npy"] {
        let path = folder.path().join(name);
        write(&volume, &path, &WriteOptions::default()).unwrap();
        let store = built(&path, &options(8));
        let read = load(&path, &LoadOptions::default()).unwrap();
        assert_eq!(&whole(&store, 0), read.voxels(), "{name}");
        assert_eq!(&store.levels()[0].grid, read.grid(), "{name}");
        assert_eq!(store.about().format, read.about().format);
        // The coarser levels are a volume by themselves, in the same place.
        let coarse = load(&pyramid_path(&path), &LoadOptions::default()).unwrap();
        assert_eq!(coarse.voxels(), &whole(&store, 1), "{name}");
        let place = store.levels()[1].grid.world_from_index;
        assert!(
            coarse.grid().world_from_index.abs_diff_eq(place, 1e-12),
            "{name}"
        );
    }
    for name in ["v.nii.gz", "v.nrrd.tif"] {
        let path = folder.path().join(name);
        if name == "v.nii.gz" {
            write(&volume, &path, &WriteOptions::default()).unwrap();
            let error = build(&path, &pyramid_path(&path), &options(8)).unwrap_err();
            assert_eq!(error.code(), "volume-unsupported");
            assert!(
                error.trouble().remedy.contains("volgraph convert"),
                "{error}"
            );
            assert!(error.to_string().contains(name));
        } else {
            assert!(build(&path, &pyramid_path(&path), &options(8)).is_err());
        }
    }
}

#[test]
fn byte_order_and_rescaling_are_the_readers_own() {
    let folder = tempfile::tempdir().unwrap();
    let bytes: Vec<u8> = each([9, 8, 7])
        .flat_map(|at| (noise(at) as u16).to_be_bytes())
        .collect();
    let source = folder.path().join("v_9x8x7_uint16_be.raw");
    fs::write(&source, &bytes).unwrap();
    let store = built(&source, &options(4));
    let read = load(&source, &LoadOptions::default()).unwrap();
    assert_eq!(&whole(&store, 0), read.voxels());
    // NIfTI's slope and intercept: scl_slope at byte 112, scl_inter at 116.
    let nifti = folder.path().join("s.nii");
    write(&read, &nifti, &WriteOptions::default()).unwrap();
    let mut bytes = fs::read(&nifti).unwrap();
    bytes[112..116].copy_from_slice(&0.5_f32.to_le_bytes());
    bytes[116..120].copy_from_slice(&(-3.0_f32).to_le_bytes());
    fs::write(&nifti, bytes).unwrap();
    let read = load(&nifti, &LoadOptions::default()).unwrap();
    let store = built(&nifti, &options(4));
    assert_eq!(
        (store.scalar_type(), &whole(&store, 0)),
        (ScalarType::F32, read.voxels())
    );
}

#[test]
fn zarr_levels_that_halve_are_used_and_the_others_built() {
    let folder = tempfile::tempdir().unwrap();
    let values: Vec<u8> = each([50, 40, 33]).map(|at| noise(at) as u8).collect();
    let grid = Grid::axis_aligned([50, 40, 33], DVec3::splat(0.5), DVec3::ONE);
    let volume = Volume::new("v", grid, values.into()).unwrap();
    for (levels, written) in [(1, 3), (2, 2), (4, 0)] {
        let source = folder.path().join(format!("v{levels}.zarr"));
        let how = WriteOptions {
            levels,
            chunk: [8; 3],
            ..WriteOptions::default()
        };
        write(&volume, &source, &how).unwrap();
        let built = build(&source, &pyramid_path(&source), &options(8)).unwrap();
        assert_eq!((built.levels, built.written), (4, written), "{levels}");
        let store = BrickStore::open(&source, &StoreOptions::default()).unwrap();
        assert_eq!(&whole(&store, 0), volume.voxels());
        assert!(whole(&store, 3).len() == 7 * 5 * 5);
        assert!(store.brick_info(3, [0; 3]).unwrap().max_error > 10.0);
        let error = store.read_brick(1, [9, 0, 0]).unwrap_err();
        assert_eq!(error.code(), "volume-option");
    }
}

#[test]
fn a_copy_does_without_its_source_and_shards_hold_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let source = raw(folder.path(), [50, 21, 30], |at| noise(at) as u16);
    let plain = built(&source, &options(8));
    let out = folder.path().join("own.zarr");
    let how = BuildOptions {
        copy_level_0: true,
        shard_chunks: Some(2),
        ..options(8)
    };
    build(&source, &out, &how).unwrap();
    let with_source = BrickStore::open(&out, &StoreOptions::default()).unwrap();
    fs::rename(&source, folder.path().join("gone")).unwrap();
    let alone = BrickStore::open(&out, &StoreOptions::default()).unwrap();
    for store in [&with_source, &alone] {
        assert_eq!(store.statistics(), plain.statistics());
        for (number, level) in plain.levels().iter().enumerate() {
            let (a, b) = (store.levels()[number].grid, level.grid);
            assert!(a.world_from_index.abs_diff_eq(b.world_from_index, 1e-12));
            for brick in each(level.bricks) {
                assert_eq!(
                    store.brick_info(number, brick),
                    plain.brick_info(number, brick)
                );
                let voxels = |store: &BrickStore| store.read_brick(number, brick);
                assert_eq!(voxels(store), voxels(&plain));
            }
        }
    }
    // Without a copy nothing is left to read.
    let gone = BrickStore::open(&source, &StoreOptions::default())
        .err()
        .unwrap();
    assert_eq!(gone.code(), "volume-unreadable");
}

#[test]
fn labels_keep_their_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let values: Vec<u8> = each([16, 16, 16])
        .map(|[x, ..]| if x < 7 { 3 } else { 200 })
        .collect();
    let volume = Volume::new(
        "v",
        Grid::axis_aligned([16; 3], DVec3::ONE, DVec3::ZERO),
        values.into(),
    );
    let about = volgraph_volume::About {
        values: volgraph_volume::Values::Labels(std::collections::BTreeMap::new()),
        ..volgraph_volume::About::default()
    };
    let source = folder.path().join("labels.zarr");
    write(
        &volume.unwrap().with_about(about),
        &source,
        &WriteOptions::default(),
    )
    .unwrap();
    let store = built(&source, &options(4));
    for level in 0..store.levels().len() {
        whole(&store, level).for_each(|value| assert!(value == 3.0 || value == 200.0, "{value}"));
    }
}

#[test]
fn interrupted_builds_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let source = raw(folder.path(), [64, 64, 64], |at| noise(at) as u8);
    // Stopped at the first, a middle and the last report.
    for part in [0.0, 0.3, 0.6, 0.99] {
        let stop = Arc::new(AtomicBool::new(false));
        let mut how = options(8);
        how.watch.interrupt = Some(Arc::clone(&stop));
        let most = Arc::new(AtomicU64::new(0));
        let seen = Arc::clone(&most);
        how.watch.progress = Some(Arc::new(move |done, total| {
            assert!(done <= total);
            seen.fetch_max(done, Ordering::Relaxed);
            if done as f64 >= part * total as f64 {
                stop.store(true, Ordering::Relaxed);
            }
        }));
        let error = build(&source, &pyramid_path(&source), &how).unwrap_err();
        assert_eq!(error.code(), "volume-interrupted", "{part}");
        // It stops where it is, not at the end.
        assert!(
            part > 0.5 || most.load(Ordering::Relaxed) < 64 << 12,
            "{part}"
        );
        let left = fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(left, 1, "{part}");
    }
    let error = BrickStore::open(&source, &StoreOptions::default())
        .err()
        .unwrap();
    assert_eq!(error.code(), "volume-data-file");
    let most = Arc::new(AtomicU64::new(0));
    let seen = Arc::clone(&most);
    let mut how = options(8);
    how.watch.progress = Some(Arc::new(move |done, total| {
        seen.fetch_max(done, Ordering::Relaxed);
        // Level 0 twice, 1 and 2 too, 3 once.
        assert_eq!(total, 2 * (64 << 12) + 2 * (32 << 10) + 2 * (16 << 8) + 512);
    }));
    let target = pyramid_path(&source);
    build(&source, &target, &how).unwrap();
    assert_eq!(
        most.load(Ordering::Relaxed),
        2 * (64 << 12) + 2 * (32 << 10) + 2 * (16 << 8) + 512
    );
    // It is there now, and stays.
    let error = build(&source, &target, &options(8)).unwrap_err();
    assert_eq!(error.code(), "volume-write");
}

#[test]
fn a_pyramid_of_another_source_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let source = raw(folder.path(), [16, 16, 16], |at| noise(at) as u8);
    drop(built(&source, &options(8)));
    let open = |load: LoadOptions| {
        let options = StoreOptions {
            load,
            ..StoreOptions::default()
        };
        BrickStore::open(&source, &options).err()
    };
    let refused = |error: Option<VolumeError>| {
        let error = error.unwrap();
        assert_eq!(error.code(), "volume-data-corrupt", "{error}");
        assert!(error.trouble().remedy.contains("build the pyramid again"));
        assert!(error.to_string().contains(".pyramid.zarr"));
    };
    assert!(open(LoadOptions::default()).is_none());
    // Another placement is no other source.
    let spacing = LoadOptions {
        spacing: Some(DVec3::splat(2.0)),
        ..LoadOptions::default()
    };
    assert!(open(spacing).is_none());
    let dims = LoadOptions {
        dims: Some([32, 16, 8]),
        ..LoadOptions::default()
    };
    refused(open(dims));
    let modified = fs::metadata(&source).unwrap().modified().unwrap();
    let mut bytes = fs::read(&source).unwrap();
    bytes[0] ^= 1;
    fs::write(&source, &bytes).unwrap();
    fs::File::options()
        .write(true)
        .open(&source)
        .unwrap()
        .set_modified(modified)
        .unwrap();
    // Of the same length and time, yet another.
    refused(open(LoadOptions::default()));
    bytes[0] ^= 1;
    fs::write(&source, &bytes).unwrap();
    refused(open(LoadOptions::default()));
    bytes.truncate(100);
    fs::write(&source, &bytes).unwrap();
    assert_eq!(
        open(LoadOptions::default()).unwrap().code(),
        "volume-data-too-short"
    );
}

#[test]
fn a_file_that_is_cut_off_while_it_is_open_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let source = raw(folder.path(), [32, 32, 32], |at| noise(at) as u8);
    let store = built(&source, &options(8));
    assert!(store.read_brick(0, [3; 3]).is_ok());
    fs::File::options()
        .write(true)
        .open(&source)
        .unwrap()
        .set_len(5000)
        .unwrap();
    let error = store.read_brick(0, [3; 3]).unwrap_err();
    assert_eq!(error.code(), "volume-data-too-short");
    assert!(store.read_brick(1, [1; 3]).is_ok());
}

#[test]
fn forged_side_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let source = raw(folder.path(), [20, 9, 9], |at| noise(at) as i16);
    drop(built(&source, &options(4)));
    let file = pyramid_path(&source).join("bricks.bin");
    let good = fs::read(&file).unwrap();
    let open = |bytes: &[u8]| {
        fs::write(&file, bytes).unwrap();
        BrickStore::open(&source, &StoreOptions::default())
    };
    let sealed = |mut bytes: Vec<u8>| {
        let end = bytes.len() - 4;
        let sum = crc32c::crc32c(&bytes[..end]);
        bytes[end..].copy_from_slice(&sum.to_le_bytes());
        bytes
    };
    assert!(open(&good).is_ok());
    // Whatever is changed, the checksum sees it.
    for i in 0..400 {
        let at = (noise([i, 1, 2]) as usize) % good.len();
        let mut bytes = good.clone();
        if i % 4 == 0 {
            bytes.truncate(at);
        } else {
            bytes[at] ^= 1 << (i % 8);
        }
        let error = open(&bytes).err().unwrap();
        assert!(!error.trouble().remedy.is_empty() && error.to_string().contains("bricks.bin"));
    }
    // With the right checksum: an error or a store that works, never a panic; no allocation by its word.
    for i in 0..400 {
        let at = (noise([i, 3, 4]) as usize) % 400.min(good.len() - 4);
        let mut bytes = good.clone();
        bytes[at] = (noise([i, 5, 6]) >> 8) as u8;
        if let Ok(store) = open(&sealed(bytes)) {
            store.read_brick(0, [0; 3]).unwrap();
        }
    }
    let text = String::from_utf8_lossy(&good).into_owned();
    let header = &text[24..text.find('}').unwrap() + 1];
    for (from, to) in [
        (
            "\"dims\":[20,9,9]",
            "\"dims\":[4000000000,4000000000,4000000000]",
        ),
        ("\"dims\":[20,9,9]", "\"dims\":[0,9,9]"),
        ("\"dims\":[20,9,9]", "\"dims\":[21,9,9]"),
        ("\"edge\":4", "\"edge\":0"),
        ("\"edge\":4", "\"edge\":3"),
        ("\"edge\":4", "\"edge\":4294967296"),
        ("\"first\":1", "\"first\":2"),
        ("\"first\":1", "\"first\":99"),
        ("\"first\":1", "\"first\":0"),
        ("\"int16\"", "\"float32\""),
        ("\"digest\"", "\"nothing\""),
        ("{", "["),
    ] {
        let forged = header.replacen(from, to, 1);
        assert_ne!(forged, header, "{from}");
        let mut bytes = good[..20].to_vec();
        bytes.extend((forged.len() as u32).to_le_bytes());
        bytes.extend(forged.as_bytes());
        bytes.extend(&good[24 + header.len()..]);
        let error = open(&sealed(bytes)).err().unwrap_or_else(|| panic!("{to}"));
        assert!(!error.trouble().remedy.is_empty(), "{error}");
        assert!(error.to_string().contains("pyramid.zarr"), "{error}");
    }
    // The range of a brick upside down.
    let mut bytes = good.clone();
    let end = bytes.len() - 20;
    bytes[end..end + 4].copy_from_slice(&f32::MAX.to_le_bytes());
    assert_eq!(
        open(&sealed(bytes)).err().unwrap().code(),
        "volume-data-corrupt"
    );
    // A level that is missing or another one.
    open(&good).unwrap();
    let level = pyramid_path(&source).join("2/zarr.json");
    let text = fs::read_to_string(&level).unwrap();
    fs::write(&level, text.replace("\"int16\"", "\"int8\"")).unwrap();
    assert_eq!(open(&good).err().unwrap().code(), "volume-data-corrupt");
    fs::remove_file(&level).unwrap();
    assert!(open(&good).is_err());
}

#[test]
fn options_that_make_no_sense_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let source = raw(folder.path(), [16, 16, 16], |at| noise(at) as u8);
    let out = pyramid_path(&source);
    let code = |how: &BuildOptions| build(&source, &out, how).unwrap_err().code();
    for edge in [0, 1, 2, 3, 48, 512, u32::MAX] {
        assert_eq!(code(&options(edge)), "volume-option");
    }
    for (chunk_bricks, shard_chunks) in [(0, None), (1, Some(0)), (u32::MAX, None), (1, Some(65))] {
        let how = BuildOptions {
            chunk_bricks,
            shard_chunks,
            ..options(8)
        };
        assert_eq!(code(&how), "volume-option");
    }
    let how = BuildOptions {
        max_memory: 1000,
        ..options(8)
    };
    assert_eq!(code(&how), "volume-too-large");
    let error = build(&source, &source, &options(8)).unwrap_err();
    assert_eq!(error.code(), "volume-write");
    // Not over its own source, even where it may overwrite.
    let zarr = folder.path().join("v.zarr");
    write(
        &load(&source, &LoadOptions::default()).unwrap(),
        &zarr,
        &WriteOptions::default(),
    )
    .unwrap();
    let how = BuildOptions {
        overwrite: true,
        ..options(8)
    };
    assert_eq!(
        build(&zarr, &zarr, &how).unwrap_err().code(),
        "volume-write"
    );
    assert!(load(&zarr, &LoadOptions::default()).is_ok());
}
