//! Which folders lie on file systems where another machine may write without an event here.

use std::path::Path;

/// The file systems' magic numbers, from Linux's `magic.h`, `statfs(2)` and coreutils' `stat`, with names for people.
#[cfg(any(target_os = "linux", target_os = "android"))]
const FILE_SYSTEMS: [(u32, &str); 21] = [
    (0x0000_6969, "NFS"),
    (0x0000_517b, "SMB"),
    (0xff53_4d42, "CIFS"),
    (0xfe53_4d42, "SMB2"),
    (0x0102_1997, "9P"),
    (0x6573_5546, "FUSE"),
    (0x00c3_6400, "Ceph"),
    (0x5346_414f, "AFS"),
    (0x6b41_4653, "kAFS"),
    (0x7375_7245, "Coda"),
    (0x0000_564c, "NCP"),
    (0x786f_4256, "vboxsf"),
    (0xbacb_acbc, "vmhgfs"),
    (0x7c7c_6673, "prl_fs"),
    (0x0bd0_0bd0, "Lustre"),
    (0x4750_4653, "GPFS"),
    (0x1983_0326, "BeeGFS"),
    (0x2003_0528, "OrangeFS"),
    (0xaad7_aaea, "PanFS"),
    (0x0116_1970, "GFS2"),
    (0x7461_636f, "OCFS2"),
];

/// The name of the network file system that the folder lies on.
#[cfg(any(target_os = "linux", target_os = "android"))]
pub(crate) fn file_system(folder: &Path) -> Option<&'static str> {
    // The type's width differs between machines; the numbers have 32 bits.
    name(rustix::fs::statfs(folder).ok()?.f_type as u32)
}

/// Elsewhere the recheck alone sees what another machine writes.
#[cfg(not(any(target_os = "linux", target_os = "android")))]
pub(crate) fn file_system(_: &Path) -> Option<&'static str> {
    None
}

#[cfg(any(target_os = "linux", target_os = "android"))]
fn name(magic: u32) -> Option<&'static str> {
    let found = FILE_SYSTEMS.iter().find(|(known, _)| *known == magic);
    found.map(|(_, name)| *name)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn file_systems_are_told_apart() {
        assert_eq!(name(0x6969), Some("NFS"));
        assert_eq!(name(0x0102_1997), Some("9P"));
        // ext, tmpfs, overlay.
        for local in [0xef53, 0x0102_1994, 0x794c_7630] {
            assert_eq!(name(local), None);
        }
        assert_eq!(file_system(Path::new("/proc")), None);
        assert_eq!(file_system(Path::new("/not/there")), None);
    }
}
