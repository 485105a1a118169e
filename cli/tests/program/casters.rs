//! Pictures of surfaces that are cut out, let light through, or cast on some layers only, against those of models without
//! any of that which must look the same.

use crate::common::{Folder, gltf::card};
use image::{DynamicImage, Rgb32FImage, Rgba, RgbaImage};
use serde_json::{Value, json};

const LIGHT: &str = r#"{"kind":"rectangle","corner":[-0.7,4,-0.5],"edge_u":[1,0,0],"edge_v":[0,0,1],"samples":8}"#;
/// From under the card, which is not seen.
const CAMERA: &str = r#"{"from":[0.3,0.8,3.5],"to":[0.1,0,0.2],"fov":25}"#;

/// A picture of which the left half is cut out.
fn half() -> DynamicImage {
    RgbaImage::from_fn(2, 1, |x, _| Rgba([255, 255, 255, 255 * x as u8])).into()
}

fn opaque() -> Value {
    json!({"doubleSided": true})
}

fn mask() -> Value {
    json!({"doubleSided": true, "alphaMode": "MASK", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}})
}

/// A picture of a model, and what the program says; `casters` are those of a scene file.
fn render(folder: &Folder, document: &Value, casters: &str, options: &str) -> (Rgb32FImage, String) {
    folder.write("card.gltf", document.to_string());
    let scene =
        format!(r#"{{"model":"card.gltf","ground":false,"camera":{CAMERA},"casters":[{casters}],"lights":[{LIGHT}]}}"#);
    folder.write("scene.json", scene);
    let said = folder.succeed(&format!("render scene.json -o p.exr --size 40x32 {options}"));
    (image::open(folder.path("p.exr")).unwrap().into_rgb32f(), said)
}

/// The values of a channel where something is seen: there, that of another view is a gray.
fn channel(picture: &Rgb32FImage, seen: &Rgb32FImage, channel: usize) -> Vec<f32> {
    let is_seen = |p: &image::Rgb<f32>| p.0[0] == p.0[1] && p.0[1] == p.0[2];
    picture.pixels().zip(seen.pixels()).filter(|(_, seen)| is_seen(seen)).map(|(p, _)| p.0[channel]).collect()
}

#[test]
fn half_of_a_card_casts_the_shadow_of_half_a_card() {
    let folder = Folder::new();
    let mut smaller = card(opaque(), &half());
    smaller["nodes"][0]["translation"] = json!([0.5, 1, 0]);
    smaller["nodes"][0]["scale"] = json!([0.5, 1, 1]);
    for view in ["--view visibility", "--view visibility --camera-from 2,5,1 --camera-to 0,0.5,0"] {
        let (cut, said) = render(&folder, &card(mask(), &half()), "", view);
        let (small, plain) = render(&folder, &smaller, "", view);
        assert_eq!(cut, small, "{view}");
        let (whole, _) = render(&folder, &card(opaque(), &half()), "", view);
        assert!(whole != cut && cut.pixels().any(|p| p.0[0] > 0.0 && p.0[0] < 1.0));
        assert!(
            said.contains("casters: 1 opaque, 1 cut out or offset\n") && said.contains("\nresolve_cutout "),
            "{said}"
        );
        assert!(!plain.contains("casters") && !plain.contains("resolve_cutout"), "{plain}");
    }
}

#[test]
fn panes_let_through_their_fraction_of_what_they_cover() {
    let folder = Folder::new();
    let (seen, _) = render(&folder, &card(opaque(), &half()), "", "--view visibility");
    let lit = channel(&seen, &seen, 0);
    assert!(lit.contains(&0.0) && lit.contains(&1.0) && lit.iter().any(|lit| *lit > 0.0 && *lit < 1.0));
    let glass = json!({"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0, 1]},
        "extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.5}}});
    let veil = json!({"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.25]}});
    for (material, tint) in [(glass, [0.5, 0.25, 0.0]), (veil, [0.75; 3])] {
        let (light, said) = render(&folder, &card(material, &half()), "", "--view light");
        assert!(said.contains("casters: 1 opaque, 1 tinted\n") && said.contains("\nadd_tint "), "{said}");
        for (index, tint) in tint.into_iter().enumerate() {
            let through = channel(&light, &seen, index);
            assert_eq!(through.len(), lit.len());
            let apart = through.iter().zip(&lit).map(|(t, lit)| (t - (lit + (1.0 - lit) * tint)).abs());
            // Depths are rounded by 0.017 %.
            assert!(apart.fold(0.0, f32::max) < 3e-4, "channel {index}");
        }
    }
    // Two behind each other multiply.
    let mut twice =
        card(json!({"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]}}), &half());
    twice["scenes"][0]["nodes"] = json!([0, 1, 2]);
    twice["nodes"].as_array_mut().unwrap().push(json!({"mesh": 0, "translation": [0, 1.001, 0]}));
    let (light, _) = render(&folder, &twice, "", "--view light");
    let least = channel(&light, &seen, 0).into_iter().fold(1.0, f32::min);
    assert!((least - 0.25).abs() < 3e-4, "{least}");
    // What lies behind a pane is seen, in its colour.
    let above = "--camera-from 0,5,0.1 --camera-to 0,0,0 --fov 8";
    let red = json!({"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]},
        "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}}});
    let (through, _) = render(&folder, &card(red, &half()), "", above);
    assert!(through.pixels().all(|p| p.0[0] > 0.05 && p.0[1] == 0.0));
}

#[test]
fn layers_offsets_and_closed_meshes() {
    let folder = Folder::new();
    let document = card(opaque(), &half());
    let view = "--view visibility";
    let (shadowed, _) = render(&folder, &document, "", view);
    let mut without = document.clone();
    without["scenes"][0]["nodes"] = json!([1]);
    let (free, _) = render(&folder, &without, "", view);
    assert_ne!(shadowed, free);
    for (casters, expected) in [
        (r#"{"name":"card","caster_layers":[]}"#, &free),
        (r#"{"name":"card","caster_layers":[3]},{"name":"slab","receiver_layers":[0,31]}"#, &free),
        (r#"{"name":"card","caster_layers":[3]},{"name":"slab","receiver_layers":[3]}"#, &shadowed),
        (r#"{"caster_layers":[0]}"#, &shadowed),
    ] {
        let (picture, said) = render(&folder, &document, casters, view);
        assert!(picture == *expected && said.contains("casters:"), "{casters}: {said}");
    }
    // What is offset shadows itself.
    let (offset, said) = render(&folder, &document, r#"{"name":"floor","plane_offset":0.01}"#, view);
    assert!(channel(&offset, &free, 0).iter().all(|lit| *lit == 0.0) && said.contains("1 cut out or offset"), "{said}");
    // A tetrahedron casts the same shadow whichever side does.
    folder.write("model.obj", "v -1 1 -1\nv 1 1 -1\nv 0 1 1\nv 0 2 0\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n");
    let closed = |casters: &str| {
        folder.write(
            "scene.json",
            format!(r#"{{"model":"model.obj","ground":true,"casters":[{casters}],"lights":[{LIGHT}]}}"#),
        );
        let said = folder.succeed("render scene.json -o p.exr --size 40x32 --view visibility");
        (std::fs::read(folder.path("p.exr")).unwrap(), said)
    };
    let (as_ever, (said_so, said)) = (closed(""), closed(r#"{"closed":true}"#));
    assert!(as_ever.0 == said_so && said.contains("casters: 2 opaque, 1 of them closed"), "{said}");
    // An OBJ file does not say that its surfaces have one side.
    let (found, said) = closed(r#"{"closed":"found"}"#);
    assert!(as_ever.0 == found && !said.contains("closed"), "{said}");
}

#[test]
fn a_scene_file_has_the_last_word() {
    let folder = Folder::new();
    let mut document = card(json!({"alphaMode": "BLEND"}), &half());
    document["materials"][0]["pbrMetallicRoughness"] = json!({"baseColorFactor": [1, 1, 1, 0.5]});
    document["nodes"][0]["extras"] = json!({"umbra4_caster": {"plane_offset": 0.5}});
    let (_, said) = render(&folder, &document, r#"{"name":"card","plane_offset":0}"#, "--view visibility");
    assert!(said.contains("1 tinted"), "{said}");
    folder.fail("render card.gltf -o p.exr --size 16x16", "node 0 'card': field `plane_offset` is 0.5");
}

#[test]
fn what_does_not_go_with_casters_is_refused() {
    let folder = Folder::new();
    let scene = |light: &str, casters: &str| {
        folder.write("card.gltf", card(mask(), &half()).to_string());
        folder.write("scene.json", format!(r#"{{"model":"card.gltf","casters":[{casters}],"lights":[{light}]}}"#));
    };
    for (light, name) in [
        (r#"{"kind":"point","position":[0,3,0]}"#, "light 0 (a point, without extent)"),
        (r#"{"kind":"directional","towards":[0,1,0],"name":"sun"}"#, "light 0 'sun' (a direction, without extent)"),
        (r#"{"kind":"sphere","center":[0,3,0],"radius":0.5}"#, "light 0 (a sphere of 256 samples)"),
    ] {
        scene(light, "");
        let words = format!("plane offsets and closed meshes do not go with {name}");
        folder.fail("render scene.json -o out.png --size 16x16", &words);
        folder.fail("info scene.json --size 16x16", &words);
    }
    scene(LIGHT, "");
    folder.fail("render scene.json -o out.png --size 16x16 --jitter 2", "do not go with --jitter");
    folder.fail("render scene.json -o out.png --size 16x16 --view pairs", "do not go with --view pairs");
    scene(LIGHT, r#"{"name":"floor","closed":true}"#);
    folder.fail("render scene.json -o out.png --size 16x16", "node 1 'floor': the mesh is not closed: triangle 0");
    scene(LIGHT, r#"{"name":"floor","plane_offset":1e6}"#);
    folder.fail(
        "render scene.json -o out.png --size 16x16",
        "node 1 'floor': field `plane_offset` is 1000000: more than 16",
    );
}

/// On the adapter that `UMBRA4_GPU` asks for; without it on a software driver.
#[cfg(feature = "gpu")]
#[test]
#[ignore = "needs an adapter: UMBRA4_GPU=software cargo test -p umbra4 --test program -- --ignored"]
fn casters_are_the_same_on_a_gpu() {
    let folder = Folder::new();
    let adapter = match std::env::var("UMBRA4_GPU").as_deref() {
        Ok("hardware") => String::new(),
        Ok("software") | Err(_) => "--adapter llvmpipe".to_owned(),
        Ok(name) => format!("--adapter {name}"),
    };
    let glass = json!({"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]}});
    let layers = r#"{"name":"card","caster_layers":[3]},{"name":"slab","receiver_layers":[0,3]}"#;
    for (material, casters, view) in [(mask(), layers, "visibility"), (glass, "", "light")] {
        let (_, said) = render(&folder, &card(material, &half()), casters, &format!("--view {view}"));
        assert!(said.contains("casters:"), "{said}");
        let options = format!("render scene.json -o gpu.exr --size 40x32 --view {view} --executor gpu {adapter}");
        let on_gpu = folder.run(&options);
        assert!(on_gpu.status.success(), "{}", String::from_utf8_lossy(&on_gpu.stderr));
        let [cpu, gpu] = ["p.exr", "gpu.exr"].map(|name| std::fs::read(folder.path(name)).unwrap());
        assert!(cpu == gpu, "{view}");
    }
}

#[test]
fn masks_go_by_materials() {
    let folder = Folder::new();
    let points: Vec<f32> =
        (0..81).flat_map(|i| [(i % 9) as f32 * 0.3 - 1.2, 0.3, (i / 9) as f32 * 0.3 - 1.2]).collect();
    folder.write("receivers.npy", crate::common::array(&[81, 3], &points));
    let masks = |document: &Value| {
        folder.write("card.gltf", document.to_string());
        folder.succeed("masks --model card.gltf --light light.json --receivers receivers.npy --samples 8 -o m.npy");
        crate::common::read_array::<u16>(&folder.path("m.npy"))
    };
    let mut smaller = card(opaque(), &half());
    smaller["nodes"][0]["translation"] = json!([0.5, 1, 0]);
    smaller["nodes"][0]["scale"] = json!([0.5, 1, 1]);
    let (whole, cut) = (masks(&card(opaque(), &half())), masks(&card(mask(), &half())));
    assert!(cut == masks(&smaller) && cut != whole);
    folder.write("card.gltf", card(mask(), &half()).to_string());
    folder.fail(
        "masks --model card.gltf --light light.json --receivers receivers.npy --samples 8 -o n.npy --lattice-out l.npz",
        "do not go with --lattice-out",
    );
}

#[test]
fn info_tells_what_runs_for_casters() {
    let folder = Folder::new();
    folder.write("card.gltf", card(mask(), &half()).to_string());
    let text = folder.succeed("info card.gltf --size 16x16");
    assert!(text.contains("+ resolve_cutout") && text.contains("- add_tint"), "{text}");
}

#[test]
fn built_in_scenes_of_leaves_and_glass() {
    let folder = Folder::new();
    for (scene, stage) in [("foliage", "resolve_cutout"), ("stained-glass", "add_tint")] {
        let options = format!("--builtin {scene} --size 40x32 --samples 8");
        let said = folder.succeed(&format!("render -o p.exr {options} --view light"));
        assert!(said.contains(&format!("\n{stage} ")), "{said}");
        let picture = image::open(folder.path("p.exr")).unwrap().into_rgb32f();
        let coloured = picture.pixels().any(|p| (p.0[0] - p.0[2]).abs() > 0.2);
        assert_eq!(coloured, scene == "stained-glass");
        let between = picture.pixels().filter(|p| p.0[0] > 0.01 && p.0[0] < 0.99 && p.0[0] != p.0[2]).count();
        let gray = picture.pixels().filter(|p| p.0[0] > 0.01 && p.0[0] < 0.99 && p.0[0] == p.0[2]).count();
        assert!(if coloured { between } else { gray } > 100, "{scene}: {between} {gray}");
        folder.succeed(&format!("render -o p.png {options}"));
    }
    folder.fail("render --builtin dance -o out.png", "invalid value 'dance' for '--builtin [<SCENE>]'");
}
