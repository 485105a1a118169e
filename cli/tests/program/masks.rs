//! `umbra4 masks` against brute force in i128, on nothing but the integers that the program itself hands out.

use std::{fs::File, io::Read};

use crate::common::{Folder, array, parse_array, read_array};

type Point = [i128; 3];

fn minus(a: Point, b: Point) -> Point {
    std::array::from_fn(|i| a[i] - b[i])
}

fn determinant(a: Point, b: Point, c: Point) -> i128 {
    a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
}

/// The segment from `p` to `sample` meets the closed triangle, strictly between its ends.
fn blocked(p: Point, sample: Point, [a, b, c]: [Point; 3]) -> bool {
    let side = |q: Point| determinant(minus(b, a), minus(c, a), minus(q, a)).signum();
    let (near, far) = (side(p), side(sample));
    let around = |a: Point, b: Point| determinant(minus(a, p), minus(b, p), minus(sample, p)).signum();
    let edges = [around(a, b), around(b, c), around(c, a)];
    near * far < 0 && (edges.iter().all(|&e| e >= 0) || edges.iter().all(|&e| e <= 0))
}

fn archive(folder: &Folder) -> zip::ZipArchive<File> {
    zip::ZipArchive::new(File::open(folder.path("L.npz")).unwrap()).unwrap()
}

/// L.npz as points.
fn lattice(folder: &Folder, name: &str) -> Vec<Point> {
    shaped_lattice(folder, name).1
}

/// The same, and the shape of the array.
fn shaped_lattice(folder: &Folder, name: &str) -> (Vec<u64>, Vec<Point>) {
    let mut bytes = Vec::new();
    archive(folder).by_name(&format!("{name}.npy")).unwrap().read_to_end(&mut bytes).unwrap();
    let (shape, kind, values) = parse_array::<i32>(&bytes);
    assert_eq!(kind, "'<i4'");
    assert_eq!(shape.last(), Some(&3));
    (shape, values.chunks_exact(3).map(|p| [p[0].into(), p[1].into(), p[2].into()]).collect())
}

/// All samples, row by row: from the steps, or, where they are jittered, as they are listed.
fn light_samples(folder: &Folder, samples: usize) -> Vec<Point> {
    let [origin, u, v] = ["origin", "step_u", "step_v"].map(|name| lattice(folder, name)[0]);
    if archive(folder).index_for_name("samples.npy").is_none() {
        let point =
            |k: usize| std::array::from_fn(|i| origin[i] + v[i] * (k / samples) as i128 + u[i] * (k % samples) as i128);
        return (0..samples * samples).map(point).collect();
    }
    let (shape, points) = shaped_lattice(folder, "samples");
    assert_eq!(shape, [samples as u64, samples as u64, 3]);
    points
}

fn check<T: npyz::Deserialize + Into<u64> + Copy>(folder: &Folder, samples: usize, kind: &str) {
    let (shape, found, words) = read_array::<T>(&folder.path("masks.npy"));
    let (receivers, corners) = (lattice(folder, "receivers"), lattice(folder, "triangles"));
    let [origin, u, v] = ["origin", "step_u", "step_v"].map(|name| lattice(folder, name)[0]);
    assert_eq!((shape, found.as_str()), (vec![receivers.len() as u64, samples as u64], kind));
    let light = light_samples(folder, samples);
    let mut blocked_bits = 0;
    for (r, &p) in receivers.iter().enumerate() {
        let behind = determinant(u, v, minus(p, origin)) <= 0;
        for row in 0..samples {
            let word: u64 = words[r * samples + row].into();
            assert_eq!(word.checked_shr(samples as u32).unwrap_or(0), 0);
            for column in 0..samples {
                let sample = light[row * samples + column];
                let triangles = corners.as_chunks::<3>().0;
                let expected = behind || triangles.iter().any(|&t| blocked(p, sample, t));
                assert_eq!(word >> column & 1 == 1, expected, "receiver {r}, sample ({row}, {column})");
                blocked_bits += u32::from(expected);
            }
        }
    }
    assert!(blocked_bits > 0 || receivers.is_empty());
}

const MASKS: &str =
    "masks --model model.obj --light light.json --receivers receivers.npy -o masks.npy --lattice-out L.npz";

#[test]
fn every_bit_is_right_in_every_word_width() {
    let folder = Folder::new();
    // The light shines down where edge_u × edge_v = +x × +z = −y.
    for (samples, kind) in [(1, "'<u2'"), (7, "'<u2'"), (16, "'<u2'")] {
        folder.succeed(&format!("{MASKS} --samples {samples}"));
        check::<u16>(&folder, samples, kind);
    }
    for samples in [17, 32] {
        folder.succeed(&format!("{MASKS} --samples {samples} --threads 1"));
        check::<u32>(&folder, samples, "'<u4'");
    }
    for samples in [33, 64] {
        folder.succeed(&format!("{MASKS} --samples {samples} --threads 2"));
        check::<u64>(&folder, samples, "'<u8'");
    }
}

#[test]
fn every_bit_of_jittered_samples_is_right() {
    let folder = Folder::new();
    let jittered = |samples: usize, pattern: u32| {
        folder.succeed(&format!("{MASKS} --samples {samples} --jitter {pattern}"));
        light_samples(&folder, samples)
    };
    let first = jittered(8, 0);
    check::<u16>(&folder, 8, "'<u2'");
    assert_ne!(jittered(8, 1), first);
    check::<u16>(&folder, 8, "'<u2'");
    jittered(1, 7);
    check::<u16>(&folder, 1, "'<u2'");
    jittered(21, 1000);
    check::<u32>(&folder, 21, "'<u4'");
    jittered(64, (1 << 30) - 1);
    check::<u64>(&folder, 64, "'<u8'");

    // Regular ones are not listed: their file is as it ever was.
    folder.succeed(&format!("{MASKS} --samples 8"));
    assert_ne!(light_samples(&folder, 8), first);
    let mut names: Vec<String> = archive(&folder).file_names().map(|name| name.unwrap().into_owned()).collect();
    names.sort();
    assert_eq!(names, ["origin.npy", "receivers.npy", "step_u.npy", "step_v.npy", "triangles.npy"]);
}

#[test]
fn an_f64_soup_far_away_keeps_its_details() {
    let folder = Folder::new();
    let far = 1e6;
    folder.write("light.json", r#"{"corner":[999999,4,-1],"edge_u":[2,0,0],"edge_v":[0,0,2]}"#);
    let soup = [far - 0.01, 1.0, -0.01, far + 0.01, 1.0, -0.01, far, 1.0, 0.013];
    folder.write("soup.npy", array(&[1, 3, 3], &soup));
    folder.write("receivers.npy", array(&[2, 3], &[far + 0.001, 0.99, 0.0, far + 0.02, 0.99, 0.0]));
    folder.succeed(&format!("{} --samples 32", MASKS.replace("model.obj", "soup.npy")));
    check::<u32>(&folder, 32, "'<u4'");
}

#[test]
fn no_receivers_and_degenerate_triangles_are_legal() {
    let folder = Folder::new();
    folder.write("model.obj", "v 0 1 0\nv 1 1 0\nv 2 1 0\nf 1 2 3\nf 1 1 2\n");
    folder.succeed(&format!("{MASKS} --samples 8"));
    let (_, _, words) = read_array::<u16>(&folder.path("masks.npy"));
    let behind = lattice(&folder, "receivers").iter().filter(|p| p[1] >= lattice(&folder, "origin")[0][1]).count();
    assert_eq!(words.iter().filter(|&&word| word != 0).count(), 8 * behind);
    folder.write("receivers.npy", array::<f32>(&[0, 3], &[]));
    folder.succeed(&format!("{MASKS} --samples 8"));
    check::<u16>(&folder, 8, "'<u2'");
}

#[test]
fn statistics_are_json() {
    let folder = Folder::new();
    let text = folder.succeed(&format!("{MASKS} --samples 16 --stats --precision fast"));
    let stats: serde_json::Value = serde_json::from_str(&text).unwrap();
    for key in ["seconds", "pairs_tested", "pairs_kept", "pairs_relevant", "fallbacks"] {
        assert!(stats[key].is_number(), "{key} in {text}");
    }
    assert!(stats["seconds_by_stage"].is_object());
    assert_eq!(stats["fallbacks"], 0);
}
