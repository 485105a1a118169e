//! Every error: exit code 2, one line, no file left.

use crate::common::{Folder, array};

const MASKS: &str = "masks --model model.obj --light light.json --receivers receivers.npy --samples 8 -o out.npy";

#[test]
fn models() {
    let folder = Folder::new();
    for (name, bytes, words) in [
        ("empty.obj", &b"v 0 0 0\n"[..], "empty"),
        ("range.obj", b"v 0 0 0\nf 1 2 3\n", "out of bounds"),
        ("nan.obj", b"v 0 nan 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "vertex 0: coordinate y is NaN"),
        ("cut.ply", b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n", "truncated"),
        ("noise.ply.gz", b"noise", "gzip"),
        ("noise.gltf", b"{}", "glTF"),
        ("cut.glb", b"glTF\x02\0\0\0\xff\0\0\0", "truncated"),
        ("noise.npy", b"noise", "NPY"),
        ("model.stl", b"solid", "unknown model format 'stl'"),
    ] {
        folder.write(name, bytes);
        folder.fail(&MASKS.replace("model.obj", name), words);
        folder.fail(&format!("render {name} -o out.png"), words);
    }
    folder.fail(&MASKS.replace("model.obj", "missing.obj"), "cannot be read");
}

#[test]
fn lights() {
    let folder = Folder::new();
    for (text, words) in [
        ("{", "light.json: not a light"),
        (r#"{"corner":[0,4,0],"edge_u":[1,0,0]}"#, "edge_v"),
        (r#"{"corner":[0,4,0],"edge_u":[1,0,0],"edge_v":[0,0,1],"power":1}"#, "power"),
        (r#"{"corner":[0,4,0],"edge_u":[1,0,0],"edge_v":[1,0,0]}"#, "no area"),
        (r#"{"corner":[0,4,0],"edge_u":[1e-9,0,0],"edge_v":[0,0,1e-9]}"#, "too fine"),
        (r#"{"corner":[0,1e39,0],"edge_u":[1,0,0],"edge_v":[0,0,1]}"#, "beyond what the lattice can hold"),
        (r#"{"corner":[0,1e999,0],"edge_u":[1,0,0],"edge_v":[0,0,1]}"#, "out of range"),
    ] {
        folder.write("light.json", text);
        folder.fail(MASKS, words);
    }
    // Jittered samples need a larger light than regular ones.
    folder.write("light.json", r#"{"corner":[0,4,0],"edge_u":[2e-5,0,0],"edge_v":[0,0,2e-5]}"#);
    folder.fail(&format!("{MASKS} --jitter 0"), "too fine");
    folder.succeed(MASKS);
}

#[test]
fn receivers() {
    let folder = Folder::new();
    for (bytes, words) in [
        (array(&[1, 3], &[0.0_f32, f32::INFINITY, 0.0]), "receiver 0"),
        (array(&[3], &[0.0_f32; 3]), "shape"),
        (array(&[1, 3], &[0_i32; 3]), "expected float32"),
        (b"\x93NUMPY\x01\0".to_vec(), "NPY"),
    ] {
        folder.write("receivers.npy", bytes);
        folder.fail(MASKS, words);
    }
    let mut cut = array(&[9, 3], &[0.0_f32; 27]);
    cut.pop();
    folder.write("receivers.npy", cut);
    folder.fail(MASKS, "truncated");
}

#[test]
fn options() {
    let folder = Folder::new();
    folder.fail(&MASKS.replace("--samples 8", "--samples 0"), "outside 1..=64");
    folder.fail(&MASKS.replace("--samples 8", "--samples 65"), "outside 1..=64");
    folder.fail(&MASKS.replace("out.npy", "missing/out.npy"), "cannot be written");
    folder.fail("masks --model model.obj", "--light");
    folder.fail("render model.obj -o out.jpg", "unknown picture format");
    folder.fail("render model.obj -o out.png --samples 9", "--samples");
    for frames in ["0", "4097", "-1", "some"] {
        folder.fail(&format!("render model.obj -o out.png --jitter={frames}"), "--jitter <FRAMES>");
    }
    for pattern in ["2147483648", "-1", "some"] {
        folder.fail(&format!("{MASKS} --jitter={pattern}"), "--jitter <PATTERN>");
    }
    folder.fail("render model.obj -o out.png --size 0x9", "--size");
    folder.fail("render model.obj -o out.png --camera-from 1,2", "--camera-from");
    folder.fail("render model.obj -o out.png --camera-from 1,2,3 --camera-to 1,2,3", "camera");
    folder.fail("render model.obj -o out.png --light-size 0", "no area");
    folder.fail("render model.obj -o out.png --size 32768x32768 --oversample 8", "too many");
    folder.fail("render -o out.png", "required");
    folder.fail("dance", "dance");
}

#[test]
fn a_failed_second_file_leaves_the_first_as_it_was() {
    let folder = Folder::new();
    folder.fail(&format!("{MASKS} --lattice-out missing/L.npz"), "cannot be written");
    folder.write("out.npy", "precious");
    folder.fail(&format!("{MASKS} --lattice-out missing/L.npz"), "cannot be written");
    assert_eq!(std::fs::read(folder.path("out.npy")).unwrap(), b"precious");
}
