//! Wavefront OBJ: positions and faces; everything else is passed over.

use umbra4_core::glam::DVec3;

use super::{Model, ModelError, push_polygon};

const FORMAT: &str = "OBJ";

pub(super) fn parse(mut bytes: &[u8]) -> Result<Model<DVec3>, ModelError> {
    let options = tobj::LoadOptions { ignore_points: true, ignore_lines: true, ..Default::default() };
    // Materials have no say in shadows, so their files need not even exist.
    let no_materials = |_: &std::path::Path| Ok((Vec::new(), Default::default()));
    let (parts, _) = tobj::load_obj_buf(&mut bytes, &options, no_materials)
        .map_err(|e| ModelError::Malformed { format: FORMAT, reason: e.to_string() })?;
    let mut model = Model::default();
    for part in parts {
        let mesh = part.mesh;
        let base = model.vertices.len() as u32;
        model
            .vertices
            .extend(mesh.positions.chunks_exact(3).map(|p| DVec3::new(p[0].into(), p[1].into(), p[2].into())));
        let indices: Vec<u32> = mesh.indices.iter().map(|i| i + base).collect();
        let mut rest = indices.as_slice();
        if mesh.face_arities.is_empty() {
            rest.chunks_exact(3).for_each(|face| push_polygon(&mut model.triangles, face));
        }
        for &arity in &mesh.face_arities {
            let (face, after) = rest.split_at_checked(arity as usize).unwrap_or((rest, &[]));
            push_polygon(&mut model.triangles, face);
            rest = after;
        }
    }
    Ok(model)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quads_and_negative_indices() {
        let text = b"# two faces\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\ng one\nf 1 2 3 4\ng two\nf -4//1 -3 -2\n";
        // The second face names a normal that does not exist.
        assert!(parse(text).is_err() || parse(text).is_ok_and(|m| m.triangles.len() == 3));
        let model = parse(b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\ng one\nf 1 2 3 4\ng two\nf -4 -3 -2\n").unwrap();
        assert_eq!(model.triangles.len(), 3);
        let corner = |t: usize, c: usize| model.vertices[model.triangles[t][c] as usize];
        assert_eq!(corner(1, 2), DVec3::new(0.0, 1.0, 0.0));
        assert_eq!(corner(2, 1), DVec3::new(1.0, 0.0, 0.0));
    }

    #[test]
    fn mutilated_files_never_panic() {
        let text =
            b"v 0 0 0\nv 1 0 0 1\nv 1 1 0\nvt 0.5 0.5\nvn 0 0 1\no part\nf 1/1/1 2/1/1 3/1/1\nf 1 2 -1\nusemtl a\n";
        for end in 0..text.len() {
            let _ = parse(&text[..end]);
            for byte in [0, b'9', b'-', b' ', b'\n', b'/', 0xff] {
                let mut broken = text.to_vec();
                broken[end] = byte;
                let _ = parse(&broken);
            }
        }
    }
}
