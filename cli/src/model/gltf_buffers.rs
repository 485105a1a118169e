//! The bytes behind a glTF document: buffers that are embedded, in data URIs or in files beside it, and the elements
//! of accessors, with every extent checked.

use std::{fs, path::Path};

use base64::{Engine, engine::general_purpose::STANDARD};
use gltf::{Accessor, Document, buffer::Source};
use percent_encoding::percent_decode_str;

use super::{ModelError, gltf::malformed};

/// Reads all buffers of a document that lies at `path`.
pub(super) fn read(document: &Document, mut blob: Option<Vec<u8>>, path: &Path) -> Result<Vec<Vec<u8>>, ModelError> {
    document
        .buffers()
        .map(|buffer| {
            let bytes = match buffer.source() {
                Source::Bin => blob.take().ok_or_else(|| malformed("the binary chunk is missing"))?,
                Source::Uri(uri) => resolve(uri, path)?,
            };
            if bytes.len() < buffer.length() {
                let reason = format!("buffer {} has {} bytes of {}", buffer.index(), bytes.len(), buffer.length());
                return Err(ModelError::Truncated { format: "glTF", reason });
            }
            Ok(bytes)
        })
        .collect()
}

/// The bytes behind a URI of a document that lies at `path`: data of its own, or a file.
pub(super) fn resolve(uri: &str, path: &Path) -> Result<Vec<u8>, ModelError> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (_, encoded) = data.split_once(";base64,").ok_or_else(|| malformed("a data URI is not base64"))?;
        return STANDARD.decode(encoded).map_err(|e| malformed(format!("a data URI does not decode: {e}")));
    }
    if uri.contains("://") {
        return Err(malformed(format!("'{uri}' is not a file")));
    }
    let name = percent_decode_str(uri).decode_utf8().map_err(|_| malformed("a file's name is not UTF-8"))?;
    let file = path.parent().unwrap_or(Path::new("")).join(&*name);
    fs::read(&file).map_err(|e| malformed(format!("{}: {e}", file.display())))
}

/// The elements of an accessor, `accessor.size()` bytes each.
pub(super) fn elements<'a>(
    accessor: &Accessor,
    buffers: &'a [Vec<u8>],
) -> Result<impl Iterator<Item = &'a [u8]>, ModelError> {
    let outside = || malformed(format!("accessor {} reaches outside its buffer", accessor.index()));
    if accessor.sparse().is_some() {
        return Err(malformed("sparse accessors are not supported"));
    }
    let view = accessor.view().ok_or_else(|| malformed(format!("accessor {} has no data", accessor.index())))?;
    let size = accessor.size();
    let stride = view.stride().filter(|&stride| stride > 0).unwrap_or(size);
    let buffer = buffers.get(view.buffer().index()).ok_or_else(outside)?;
    let end = view.offset().checked_add(view.length()).ok_or_else(outside)?;
    let bytes = buffer.get(view.offset()..end).and_then(|view| view.get(accessor.offset()..)).ok_or_else(outside)?;
    let count = accessor.count();
    let needed = count.saturating_sub(1).checked_mul(stride).and_then(|n| n.checked_add(size)).ok_or_else(outside)?;
    if count > 0 && needed > bytes.len() {
        return Err(outside());
    }
    Ok((0..count).map(move |i| &bytes[i * stride..i * stride + size]))
}
