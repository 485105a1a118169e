//! NumPy files: points in, masks and lattice coordinates out.

use std::{
    fs,
    io::{self, Seek, Write},
    path::Path,
};

use npyz::{DType, NpyFile, Order, WriterBuilder};
use umbra4_core::glam::{DVec3, IVec3};
use zip::{ZipWriter, write::SimpleFileOptions};

use crate::in_file::InFile;

/// Why an array file is refused.
#[derive(Debug, thiserror::Error)]
pub enum ArrayError {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Unreadable(io::Error),
    /// The file is not an .npy file.
    #[error("not a readable NPY file: {0}")]
    Malformed(String),
    /// The elements are not floats.
    #[error("the array holds {found}, expected float32 or float64")]
    Type {
        /// Type of the elements, as the file names it.
        found: String,
    },
    /// The shape is not the one called for.
    #[error("the array has shape {found:?}, expected (_, {})", expected.iter().map(u64::to_string).collect::<Vec<_>>().join(", "))]
    Shape {
        /// Shape of the array.
        found: Vec<u64>,
        /// Extents after the first, which is free.
        expected: Vec<u64>,
    },
    /// The file ends before its last element.
    #[error("the NPY file is truncated: {expected} bytes of data announced, {found} found")]
    Truncated {
        /// Bytes that shape and type call for.
        expected: u64,
        /// Bytes after the header.
        found: u64,
    },
}

/// Headers of plain arrays are far shorter; the limit keeps the expression parser's recursion shallow.
const LONGEST_HEADER: usize = 1024;
/// With no more digits than this in the header, the product of all extents is below 2^64.
const MOST_DIGITS: usize = 19;

/// Reads points from an array of float32 or float64 of shape (R, 3).
///
/// # Errors
/// See [`ArrayError`].
pub fn read_points(path: &Path) -> Result<Vec<DVec3>, InFile<ArrayError>> {
    let bytes = fs::read(path).map_err(ArrayError::Unreadable).map_err(InFile::at(path))?;
    parse_points(&bytes, &[3]).map_err(InFile::at(path))
}

/// The points in an array of shape (_, `inner`…), whose last extent is 3.
///
/// # Errors
/// See [`ArrayError`].
pub fn parse_points(bytes: &[u8], inner: &[u64]) -> Result<Vec<DVec3>, ArrayError> {
    check_header(bytes)?;
    let file = NpyFile::new(bytes).map_err(|e| ArrayError::Malformed(e.to_string()))?;
    let shape = file.shape().to_vec();
    if shape.len() != inner.len() + 1 || shape[1..] != *inner {
        return Err(ArrayError::Shape { found: shape, expected: inner.to_vec() });
    }
    let (order, dtype) = (file.order(), file.dtype());
    let (type_name, size) = match &dtype {
        DType::Plain(plain) => (plain.to_string(), plain.num_bytes().unwrap_or(0) as u64),
        _ => (dtype.descr(), 0),
    };
    let count: u64 = shape.iter().product();
    let wrong_type = |_| ArrayError::Type { found: type_name.clone() };
    let truncated = |found: usize| ArrayError::Truncated { expected: count.saturating_mul(size), found: found as u64 };
    let available = bytes.len() - data_start(bytes);
    if size == 0 || count.saturating_mul(size) > available as u64 {
        return Err(if matches!(size, 4 | 8) { truncated(available) } else { wrong_type(()) });
    }
    let values: Result<Vec<f64>, io::Error> = match size {
        4 => file.data::<f32>().map_err(|_| wrong_type(()))?.map(|v| v.map(f64::from)).collect(),
        _ => file.data::<f64>().map_err(|_| wrong_type(()))?.collect(),
    };
    let values = values.map_err(|_| truncated(available))?;
    let points = values.len() / 3;
    Ok(match order {
        Order::C => values.chunks_exact(3).map(DVec3::from_slice).collect(),
        Order::Fortran => {
            // The first index runs fastest: a point's coordinates lie `points` apart, its triangle's corners `T` apart.
            let first = shape[0] as usize;
            let middle = points.checked_div(first).unwrap_or(0);
            (0..points)
                .map(|p| (p / middle.max(1)) + first * (p % middle.max(1)))
                .map(|at| DVec3::new(values[at], values[at + points], values[at + 2 * points]))
                .collect()
        }
    })
}

/// Refuses what the header's parser must not see.
fn check_header(bytes: &[u8]) -> Result<(), ArrayError> {
    let header = bytes.get(..data_start(bytes)).unwrap_or_default();
    let malformed = |reason: &str| Err(ArrayError::Malformed(reason.to_owned()));
    if !bytes.starts_with(b"\x93NUMPY") {
        return malformed("it does not begin with the NPY magic");
    }
    if header.is_empty() || header.len() > LONGEST_HEADER {
        return malformed("the header is cut off or too long");
    }
    if header.get(10..).unwrap_or_default().iter().filter(|b| b.is_ascii_digit()).count() > MOST_DIGITS {
        return malformed("the shape is beyond any array");
    }
    Ok(())
}

/// Where the data begins: after magic, version, length and header. At most the length of the file.
fn data_start(bytes: &[u8]) -> usize {
    let start = match *bytes {
        [_, _, _, _, _, _, 1, _, a, b, ..] => 10 + usize::from(u16::from_le_bytes([a, b])),
        [_, _, _, _, _, _, _, _, a, b, c, d, ..] => 12_usize.saturating_add(u32::from_le_bytes([a, b, c, d]) as usize),
        _ => 0,
    };
    start.min(bytes.len())
}

/// Writes an array in C order.
///
/// # Errors
/// The writer's.
pub fn write_array<T: npyz::AutoSerialize + Copy>(
    writer: impl Write,
    shape: &[u64],
    values: impl IntoIterator<Item = T>,
) -> io::Result<()> {
    let mut array = npyz::WriteOptions::new().default_dtype().shape(shape).writer(writer).begin_nd()?;
    array.extend(values)?;
    array.finish()
}

/// Writes named int32 arrays as an uncompressed .npz file.
///
/// # Errors
/// The writer's.
pub fn write_lattice_points(writer: impl Write + Seek, arrays: &[(&str, &[u64], &[IVec3])]) -> io::Result<()> {
    let mut archive = ZipWriter::new(writer);
    for (name, shape, points) in arrays {
        // Archives of 4 GB and more need wider fields from the start.
        let options = SimpleFileOptions::default().large_file(points.len() > 1 << 28);
        archive.start_file(format!("{name}.npy"), options).map_err(io::Error::from)?;
        write_array(&mut archive, shape, points.iter().flat_map(|p| p.to_array()))?;
    }
    archive.finish().map_err(io::Error::from)?.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn array<T: npyz::AutoSerialize + Copy>(shape: &[u64], values: &[T]) -> Vec<u8> {
        let mut bytes = Vec::new();
        write_array(&mut bytes, shape, values.iter().copied()).unwrap();
        bytes
    }

    #[test]
    fn both_float_widths_are_read() {
        let single = array(&[2, 3], &[1.0_f32, 2.0, 3.0, 4.0, 5.0, 6.0]);
        let double = array(&[2, 3], &[1.0_f64, 2.0, 3.0, 4.0, 5.0, 6.0]);
        let points = parse_points(&single, &[3]).unwrap();
        assert_eq!(points, [DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0)]);
        assert_eq!(parse_points(&double, &[3]).unwrap(), points);
    }

    #[test]
    fn fortran_order_is_read() {
        // [triangle][corner][axis] = 100·triangle + 10·corner + axis, the first index fastest.
        let mut values = Vec::new();
        for axis in 0..3 {
            for corner in 0..3 {
                for triangle in 0..2 {
                    values.push((100 * triangle + 10 * corner + axis) as f32);
                }
            }
        }
        let mut bytes = Vec::new();
        let builder = npyz::WriteOptions::new().default_dtype().shape(&[2, 3, 3]).order(Order::Fortran);
        let mut writer = builder.writer(&mut bytes).begin_nd().unwrap();
        writer.extend(values).unwrap();
        writer.finish().unwrap();
        let points = parse_points(&bytes, &[3, 3]).unwrap();
        assert_eq!(points[1], DVec3::new(10.0, 11.0, 12.0));
        assert_eq!(points[3], DVec3::new(100.0, 101.0, 102.0));
    }

    #[test]
    fn no_points_is_an_array_too() {
        assert_eq!(parse_points(&array::<f32>(&[0, 3], &[]), &[3]).unwrap(), []);
    }

    #[test]
    fn each_fault_has_its_error() {
        assert!(matches!(parse_points(&array(&[3], &[1.0_f32; 3]), &[3]), Err(ArrayError::Shape { .. })));
        assert!(matches!(parse_points(&array(&[1, 3], &[1_i32; 3]), &[3]), Err(ArrayError::Type { .. })));
        assert!(matches!(parse_points(&array(&[1, 3], &[1_u8; 3]), &[3]), Err(ArrayError::Type { .. })));
        let good = array(&[1, 3], &[1.0_f32; 3]);
        assert!(matches!(parse_points(&good[..good.len() - 1], &[3]), Err(ArrayError::Truncated { .. })));
        assert!(matches!(parse_points(b"PK", &[3]), Err(ArrayError::Malformed(_))));
    }

    #[test]
    fn mutilated_files_never_panic() {
        let good = array(&[2, 3], &[1.0_f32; 6]);
        for position in 0..good.len() {
            assert!(parse_points(&good[..position], &[3]).is_err());
            for byte in [0, 1, 2, b'9', b'(', b'[', b'\'', 0xff] {
                let mut broken = good.clone();
                broken[position] = byte;
                let _ = parse_points(&broken, &[3]);
            }
        }
        let huge = String::from_utf8_lossy(&good).replace("(2, 3)", "(99999999999999, 3)");
        assert!(parse_points(huge.as_bytes(), &[3]).is_err());
    }
}
