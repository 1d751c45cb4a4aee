pub(crate) fn is_dicom(_: &[u8]) -> bool { false }
pub(crate) fn open<'a>(_: &[crate::input::Input<'a>], _: &crate::load::LoadOptions) -> Result<crate::contents::Opened<'a>, volgraph_volume::VolumeError> { unimplemented!() }
