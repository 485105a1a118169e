//! Scene files and the lights of glTF models: what they show, and what is said where they are wrong.

use crate::common::Folder;
use image::{GrayImage, Luma, Rgb, Rgb32FImage, RgbImage, Rgba, RgbaImage};

const RECTANGLE: &str = r#""kind":"rectangle","corner":[-1,4,-1],"edge_u":[2,0,0],"edge_v":[0,0,2],"samples":8"#;
const POINT: &str = r#""kind":"point","position":[1,3,1]"#;
const SUN: &str = r#""kind":"directional","towards":[-1,2,0.5]"#;

/// A scene with these lights, each without its braces.
fn scene(lights: &[&str]) -> String {
    let lights: Vec<String> = lights.iter().map(|light| format!("{{{light}}}")).collect();
    format!(r#"{{"model":"model.obj","lights":[{}]}}"#, lights.join(","))
}

/// The picture of a scene, in numbers.
fn picture(folder: &Folder, text: &str, options: &str) -> Rgb32FImage {
    folder.write("scene.json", text);
    folder.succeed(&format!("render scene.json -o p.exr --size 48x48 {options}"));
    image::open(folder.path("p.exr")).unwrap().into_rgb32f()
}

fn with(light: &str, fields: &str) -> String {
    format!("{light},{fields}")
}

#[test]
fn the_documented_example_renders() {
    let page = include_str!("../../../docs/scene-files.md");
    let example = page.split("```json").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let folder = Folder::new();
    let lit = picture(&folder, example, "");
    let folder_again = Folder::new();
    assert_eq!(picture(&folder_again, example, "--precision fast").dimensions(), lit.dimensions());
    let table = folder.succeed("render scene.json -o v.png --size 48x48 --view visibility");
    assert!(table.contains("6 lights"), "{table}");
    folder.succeed("render scene.json -o n.png --size 48x48 --view penumbra --no-ground --fov 20 --threads 1");
}

#[test]
fn every_kind_of_light_and_of_weights() {
    let folder = Folder::new();
    let eight = |x: u32, y: u32| [255, 32 * x as u8, 32 * y as u8];
    RgbImage::from_fn(8, 8, |x, y| Rgb(eight(x, y))).save(folder.path("texture.png")).unwrap();
    GrayImage::from_fn(8, 8, |x, _| Luma([if x < 4 { 255 } else { 0 }])).save(folder.path("stencil.png")).unwrap();
    let full = picture(&folder, &scene(&[RECTANGLE]), "");
    let mut others = Vec::new();
    for fields in [
        r#""shape":"disk""#,
        r#""shape":{"polygon":[[0,0],[1,0],[0,1]]}"#,
        r#""shape":{"stencil":"stencil.png"}"#,
        r#""texture":"texture.png""#,
        r#""texture":"texture.png","shape":{"stencil":"stencil.png"}"#,
        r#""color":[1,0.5,0]"#,
    ] {
        let other = picture(&folder, &scene(&[&with(RECTANGLE, fields)]), "");
        assert!(other != full && !others.contains(&other), "{fields}");
        others.push(other);
    }
    // What is written in numbers is what the picture of the stencil shows.
    let left: Vec<&str> = (0..64).map(|i| if i % 8 < 4 { "[1,1,1]" } else { "[0,0,0]" }).collect();
    let left = format!(r#""radiance":[{}]"#, left.join(","));
    assert_eq!(picture(&folder, &scene(&[&with(RECTANGLE, &left)]), ""), others[2]);
    for light in [POINT, SUN] {
        assert_ne!(picture(&folder, &scene(&[light]), ""), full);
    }
}

#[test]
fn two_equal_lights_are_one_of_doubled_intensity() {
    let folder = Folder::new();
    let lights = [POINT, RECTANGLE].map(|light| with(light, r#""color":[1,0.5,0.25]"#));
    for light in &lights {
        let one = picture(&folder, &scene(&[light, SUN]), "");
        let twice = picture(&folder, &scene(&[&with(light, r#""intensity":2"#), SUN]), "");
        let both = picture(&folder, &scene(&[light, light, SUN]), "");
        let apart = twice.iter().zip(both.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(apart < 1e-6 && one != twice, "{apart}");
    }
}

#[test]
fn a_lone_light_is_exposed_for_whatever_its_intensity() {
    let folder = Folder::new();
    let one = picture(&folder, &scene(&[RECTANGLE]), "");
    assert_eq!(picture(&folder, &scene(&[&with(RECTANGLE, r#""intensity":1024"#)]), ""), one);
}

#[test]
fn visibility_is_that_of_the_same_lights_on_the_command_line() {
    let folder = Folder::new();
    folder.write("light.json", r#"{"corner":[-1,4,-1],"edge_u":[2,0,0],"edge_v":[0,0,2]}"#);
    let of_file = |lights: &[&str]| picture(&folder, &scene(lights), "--view visibility");
    let of_options = |options: &str| {
        folder.succeed(&format!("render model.obj -o o.exr --size 48x48 --view visibility {options}"));
        image::open(folder.path("o.exr")).unwrap().into_rgb32f()
    };
    let area = of_options("--light light.json --samples 8");
    let lamp = of_options("--lamp 1,3,1");
    assert_eq!(of_file(&[RECTANGLE]), area);
    assert_eq!(of_file(&[POINT]), lamp);
    assert_eq!(of_file(&[SUN]), of_options("--sun -1,2,0.5"));
    // Of several, the mean.
    let mean = of_file(&[RECTANGLE, POINT]);
    assert!(mean.iter().zip(area.iter().zip(lamp.iter())).all(|(mean, (a, b))| *mean == (a + b) / 2.0));
    // Weights that are all the same change nothing.
    let even = with(RECTANGLE, r#""shape":{"polygon":[[-1,-1],[2,-1],[2,2],[-1,2]]}"#);
    assert_eq!(of_file(&[&even]), area);
}

#[test]
fn a_two_sided_light_shines_to_both_sides() {
    let folder = Folder::new();
    // A wall on either side of a light that stands between them.
    folder.write(
        "model.obj",
        "v -2 0 -1\nv -2 2 -1\nv -2 0 1\nv -2 2 1\nf 1 2 3\nf 2 4 3\n\
         v 2 0 -1\nv 2 2 -1\nv 2 0 1\nv 2 2 1\nf 5 6 7\nf 6 8 7\n",
    );
    let light = r#""kind":"rectangle","corner":[0,0.5,-0.5],"edge_u":[0,1,0],"edge_v":[0,0,1],"samples":[4,8]"#;
    let seen = |fields: &str, x: f64| {
        let text = scene(&[&with(light, fields)]).replacen('{', r#"{"ground":false,"#, 1);
        let camera = format!("--view visibility --camera-from {},1,0.2 --camera-to {x},1,0 --fov 20", -x * 0.5);
        let picture = picture(&folder, &text, &camera);
        let gray: Vec<f32> = picture.pixels().filter(|p| p.0[0] == p.0[1]).map(|p| p.0[0]).collect();
        assert!(gray.len() > 100);
        gray.iter().sum::<f32>() / gray.len() as f32
    };
    // edge_u × edge_v = +x.
    assert_eq!((seen(r#""name":"one""#, 2.0), seen(r#""name":"one""#, -2.0)), (1.0, 0.0));
    assert_eq!((seen(r#""two_sided":true"#, 2.0), seen(r#""two_sided":true"#, -2.0)), (1.0, 1.0));
    let disk = r#""two_sided":true,"shape":"disk""#;
    assert_eq!((seen(disk, 2.0), seen(disk, -2.0)), (1.0, 1.0));
}

#[test]
fn both_sides_of_a_light_carry_the_same_weights() {
    let folder = Folder::new();
    let light = r#""kind":"rectangle","corner":[-1,4,-1]"#;
    let (front, back) = (
        r#""samples":[2,3],"radiance":[[4,0,0],[0,1,0],[1,1,1],[0,0,2],[3,3,0],[1,0,1]]"#,
        r#""samples":[3,2],"radiance":[[4,0,0],[0,0,2],[0,1,0],[3,3,0],[1,1,1],[1,0,1]],"two_sided":true"#,
    );
    // Turned around, with its samples turned by hand, it is the back that shines on the model.
    let front = with(light, &with(front, r#""edge_u":[2,0,0],"edge_v":[0,0,2]"#));
    let back = with(light, &with(back, r#""edge_u":[0,0,2],"edge_v":[2,0,0]"#));
    let [front, back] = [front, back].map(|light| picture(&folder, &scene(&[&light]), ""));
    let apart = front.iter().zip(back.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(apart < 1e-5, "{apart}");
}

#[test]
fn jitter_and_pairs_take_plain_rectangles_of_any_number() {
    let folder = Folder::new();
    let two = with(RECTANGLE, r#""two_sided":true,"name":"lid""#);
    folder.write("scene.json", scene(&[RECTANGLE, &two]));
    let table = folder.succeed("render scene.json -o j.png --size 16x16 --jitter 2");
    assert!(table.contains("2 lights, 2 jittered frames"), "{table}");
    folder.succeed("render scene.json -o q.png --size 16x16 --view pairs");
    folder.succeed("render scene.json -o r.png --size 16x16 --view pairs --jitter 2");
    let disk = with(RECTANGLE, r#""shape":"disk","name":"disk""#);
    for (light, words) in [
        (POINT, "light 1 (a point, without extent)"),
        (disk.as_str(), "light 1 'disk' (a rectangle of 8×8 samples, with weights)"),
    ] {
        folder.write("scene.json", scene(&[RECTANGLE, light]));
        for option in ["--view pairs", "--jitter 2"] {
            let name = option.strip_suffix(" 2").unwrap_or(option);
            let message = format!("{name} is for lights with an area whose samples all emit the same, not for {words}");
            folder.fail(&format!("render scene.json -o out.png {option}"), &message);
        }
    }
}

#[test]
fn volumes_shine_to_all_sides() {
    let folder = Folder::new();
    let point = picture(&folder, &scene(&[r#""kind":"point","position":[1,4,1]"#]), "--view visibility");
    let sphere = r#""kind":"sphere","center":[1,4,1],"radius":0.5"#;
    let mut others = vec![point];
    for light in [
        sphere,
        r#""kind":"sphere","center":[1,4,1],"radius":0.5,"samples":64"#,
        r#""kind":"ellipsoid","center":[1,4,1],"axes":[[1,0,0],[0,0.2,0],[0,0,0.5]],"samples":128"#,
        r#""kind":"tube","from":[0,4,1],"to":[2,4,1],"radius":0.1,"samples":300"#,
        r#""kind":"cloud","points":[[1,4,1],[0,4,0],[2,4,1]]"#,
    ] {
        let other = picture(&folder, &scene(&[light]), "--view visibility");
        assert!(!others.contains(&other), "{light}");
        others.push(other);
    }
    // A cloud of one point is that point.
    let one = picture(&folder, &scene(&[r#""kind":"cloud","points":[[1,4,1]]"#]), "--view visibility");
    assert_eq!(one, others[0]);
    folder.write("scene.json", scene(&[sphere]));
    let plan = folder.succeed("info scene.json");
    assert!(plan.contains("+ resolve_cloud") && plan.contains("- resolve "), "{plan}");
    for (light, words) in [
        (r#""kind":"sphere","center":[1,4,1],"radius":0"#, "light 0: radius is 0"),
        (r#""kind":"sphere","center":[1,4,1],"radius":1e-12"#, "light 0: the light is too small for the lattice"),
        (r#""kind":"tube","from":[1,4,1],"to":[1,4,1],"radius":1"#, "light 0: the tube begins and ends at"),
    ] {
        folder.write("scene.json", scene(&[light]));
        folder.fail("render scene.json -o out.png", words);
    }
}

/// On the adapter that `UMBRA4_GPU` asks for; without it on a software driver.
#[cfg(feature = "gpu")]
#[test]
#[ignore = "needs an adapter: UMBRA4_GPU=software cargo test -p umbra4 --test program -- --ignored"]
fn volumes_are_the_same_on_a_gpu() {
    let folder = Folder::new();
    let lights = [
        r#""kind":"sphere","center":[1,4,1],"radius":0.5,"samples":100"#,
        r#""kind":"tube","from":[0,4,1],"to":[2,4,1],"radius":0.1,"samples":300"#,
        r#""kind":"ellipsoid","center":[0,1,0.5],"axes":[[0.3,0,0],[0,0.2,0],[0,0,0.5]],"samples":33"#,
        r#""kind":"cloud","points":[[1,4,1],[0,4,0],[2,4,1]]"#,
    ];
    folder.write("scene.json", scene(&lights));
    let adapter = match std::env::var("UMBRA4_GPU").as_deref() {
        Ok("hardware") => String::new(),
        Ok("software") | Err(_) => "--adapter llvmpipe".to_owned(),
        Ok(name) => format!("--adapter {name}"),
    };
    for view in ["visibility", "shaded"] {
        let render = |name: &str, executor: &str| {
            folder.run(&format!("render scene.json -o {name} --size 48x48 --view {view} --executor {executor}"))
        };
        let on_gpu = render("gpu.exr", &format!("gpu {adapter}"));
        assert!(on_gpu.status.success(), "{}", String::from_utf8_lossy(&on_gpu.stderr));
        assert!(String::from_utf8_lossy(&on_gpu.stdout).contains("resolve_cloud"));
        assert!(render("cpu.exr", "cpu").status.success());
        let [cpu, gpu] = ["cpu.exr", "gpu.exr"].map(|name| std::fs::read(folder.path(name)).unwrap());
        assert!(cpu == gpu, "{view}");
    }
}

#[test]
fn bad_descriptions_are_refused() {
    let folder = Folder::new();
    RgbImage::new(8, 7).save(folder.path("small.png")).unwrap();
    RgbImage::new(8, 8).save(folder.path("black.png")).unwrap();
    RgbaImage::from_pixel(8, 8, Rgba([255; 4])).save(folder.path("alpha.png")).unwrap();
    folder.write("noise.png", "noise");
    for (fields, words) in [
        (r#""color":[1,-1,1]"#, "light 1: field `color[1]` is -1"),
        (r#""color":[1,1,1e39]"#, "light 1: field `color[2]` is 1"),
        (r#""color":[1,1,1e999]"#, "light 1: field `color`: number out of range"),
        (r#""intensity":-2"#, "light 1: field `intensity` is -2"),
        (r#""intensity":1e300,"name":"sky""#, "light 1 'sky': field `intensity` is 1"),
        (r#""intensity":1e999"#, "field `intensity`: number out of range"),
        (r#""power":3"#, "field `power` is unknown"),
        (r#""color":[1,1,1],"color":[1,1,1]"#, "field `color` is there twice"),
        (r#""texture":"small.png""#, "field `texture`: small.png: a picture of 7 rows × 8 columns for a light of 8"),
        (r#""texture":"alpha.png""#, "field `texture`: alpha.png: pixels are Rgba8"),
        (r#""texture":"black.png""#, "field `texture`: no sample of the light emits anything"),
        (r#""texture":"noise.png""#, "field `texture`: noise.png: not a PNG"),
        (r#""texture":"missing.png""#, "field `texture`: missing.png: cannot be read"),
        (r#""texture":"a.png","radiance":[]"#, "fields `texture` and `radiance`"),
        (r#""shape":{"stencil":"black.png"}"#, "field `shape`: no sample of the light emits anything"),
        (r#""shape":{"stencil":"small.png"}"#, "field `shape`: small.png: a picture of 7 rows"),
        (r#""shape":{"polygon":[[0,0],[1,1]]}"#, "field `shape`: a polygon of 2 corners"),
        (r#""shape":{"polygon":[[0,0],[1,1],[0,1e999]]}"#, "field `shape`: number out of range"),
        (r#""shape":"star""#, "field `shape`: unknown variant `star`"),
        (r#""radiance":[[1,1,1]]"#, "field `radiance`: 1 radiances for a light of 8×8"),
        (r#""two_sided":1"#, "field `two_sided`: invalid type"),
    ] {
        folder.write("scene.json", scene(&[POINT, &with(RECTANGLE, fields)]));
        folder.fail("render scene.json -o out.png", words);
        folder.fail("info scene.json", "scene.json: light 1");
    }
    for (light, words) in [
        (RECTANGLE.replace("8", "0"), "light 0: light rows is 0, outside 1..=64"),
        (RECTANGLE.replace("8", "[8,65]"), "light 0: light columns is 65, outside 1..=64"),
        (RECTANGLE.replace("8", "[8,8,8]"), "field `samples`: a number of samples each way or [rows, columns]"),
        (RECTANGLE.replace("[2,0,0]", "[0,0,2]"), "light 0: the light has no area"),
        (RECTANGLE.replace("[2,0,0]", "[1e-8,0,0]"), "light 0: the light is too fine for the lattice"),
        (SUN.replace("[-1,2,0.5]", "[0,0,0]"), "light 0: light direction is [0, 0, 0]: it points nowhere"),
        (r#""kind":"moon""#.to_owned(), "light 0: field `kind` is 'moon'"),
        (POINT.replace("[1,3,1]", "[1,3,NaN]"), "scene.json: not a scene: expected"),
    ] {
        folder.write("scene.json", scene(&[&light]));
        folder.fail("render scene.json -o out.png", words);
        folder.fail("info scene.json --size 16x16", words);
    }
    for (text, words) in [
        ("{", "scene.json: not a scene"),
        (r#"{"lights":[]}"#, "scene.json: field `model` is missing"),
        (r#"{"model":"model.obj"}"#, "field `lights` is missing"),
        (r#"{"model":"model.obj","lights":[]}"#, "field `lights` is empty"),
        (r#"{"model":"model.obj","sky":1,"lights":[]}"#, "field `sky` is unknown"),
        (r#"{"model":"model.obj","camera":{"fov":180},"lights":[]}"#, "field `camera`: the field of view is 180"),
        (&scene(&[POINT]).replace("model.obj", "missing.obj"), "missing.obj: cannot be read"),
        (&scene(&[POINT]).replace("model.obj", "scene.json"), "unknown model format 'json'"),
    ] {
        folder.write("scene.json", text);
        folder.fail("render scene.json -o out.png", words);
    }
}

#[test]
fn the_command_line_brings_no_lights_to_a_scene() {
    let folder = Folder::new();
    folder.write("scene.json", scene(&[RECTANGLE]));
    for option in
        ["--samples 8", "--light light.json", "--light-size 1", "--light-distance 1", "--sun 0,1,0", "--lamp 0,3,0"]
    {
        let name = option.split(' ').next().unwrap();
        let message = format!("{name} is not for scene.json: it has lights of its own");
        folder.fail(&format!("render scene.json -o out.png {option}"), &message);
    }
    folder.fail("report scene.json -o out", "report is not for scene.json");
    folder.fail("render missing.json -o out.png", "missing.json: cannot be read");
    folder.fail("info missing.json", "missing.json: cannot be read");
}

#[test]
fn info_tells_the_plan_of_every_light() {
    let folder = Folder::new();
    let lid = with(RECTANGLE, r#""name":"lid","two_sided":true"#);
    // Below the ground, it shines on nothing.
    let buried = with(RECTANGLE, r#""name":"buried""#).replace("[-1,4,-1]", "[-1,-9,-1]");
    folder.write("scene.json", scene(&[&lid, &buried, &with(POINT, r#""name":"bulb""#), SUN]));
    let text = folder.succeed("info scene.json --size 48x48");
    for words in [
        "6 triangles\n",
        " receivers, of 48×48 pixels",
        "light 0 'lid': a rectangle of 8×8 samples, two-sided\nfront\n",
        "\nback\n",
        "light 1 'buried': a rectangle of 8×8 samples\n",
        "no receiver lies before the light",
        "light 2 'bulb': a point, without extent\n",
        "the light has no extent",
        "light 3: a direction, without extent\n",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let text = folder.succeed("info model.obj --width 32 --height 16");
    assert!(text.contains("32×16 pixels") && text.contains("\nthe light: a rectangle of 32×32 samples"), "{text}");
}

/// The tetrahedron of `model.obj` as glTF, and these nodes beside it.
fn gltf(nodes: &str, list: &str, lights: &str) -> String {
    // -1 1 -1, 1 1 -1, 0 1 1, 0 2 0 as f32; 0 1 2, 0 1 3, 1 2 3, 2 0 3 as u8.
    let buffer = "AACAvwAAgD8AAIC/AACAPwAAgD8AAIC/AAAAAAAAgD8AAIA/AAAAAAAAAEAAAAAAAAECAAEDAQIDAgAD";
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0,{list}]}}],"nodes":[{{"mesh":0}},{nodes}],
        "extensionsUsed":["KHR_lights_punctual"],"extensions":{{"KHR_lights_punctual":{{"lights":[{lights}]}}}},
        "cameras":[{{"type":"perspective","perspective":{{"yfov":0.8,"znear":0.1}}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[-1,1,-1],"max":[1,2,1]}},
        {{"bufferView":1,"componentType":5121,"count":12,"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":12}}],
        "buffers":[{{"uri":"data:application/octet-stream;base64,{buffer}","byteLength":60}}]}}"#
    )
}

#[test]
fn lights_of_gltf_are_those_of_the_command_line_at_the_same_place() {
    let folder = Folder::new();
    let node = |place: &str, light: u32| {
        format!(r#"{{"name":"n",{place},"extensions":{{"KHR_lights_punctual":{{"light":{light}}}}}}}"#)
    };
    let render = |model: &str, options: &str| {
        folder.succeed(&format!("render {model} -o o.exr --size 48x48 --view visibility {options}"));
        image::open(folder.path("o.exr")).unwrap().into_rgb32f()
    };
    let lamp = render("model.obj", "--lamp 1,3,1");
    // A turn of half a circle about y and a doubling apply to the child's place.
    let parent = r#"{"rotation":[0,1,0,0],"scale":[2,2,2],"children":[2]}"#;
    let child = node(r#""translation":[-0.5,1.5,-0.5]"#, 0);
    for kind in [r#"{"type":"point"}"#, r#"{"type":"spot","spot":{"outerConeAngle":1.5}}"#] {
        folder.write("lamp.gltf", gltf(&format!("{parent},{child}"), "1", kind));
        assert_eq!(render("lamp.gltf", ""), lamp, "{kind}");
    }
    // Half a right angle about x: −z becomes down and forward.
    let turned = node(r#""rotation":[-0.3826834323650898,0,0,0.9238795325112867]"#, 0);
    folder.write("sun.gltf", gltf(&turned, "1", r#"{"type":"directional"}"#));
    assert_eq!(render("sun.gltf", ""), render("model.obj", "--sun 0,1,1"));
    // What the command line says goes before; a scene's lights do, too.
    assert_eq!(render("sun.gltf", "--lamp 1,3,1"), lamp);
    folder.write("scene.json", scene(&[POINT]).replace("model.obj", "sun.gltf"));
    assert_eq!(render("scene.json", ""), lamp);
    folder.fail("render sun.gltf -o out.png --samples 8", "--samples is not for sun.gltf: it has lights of its own");
    let text = folder.succeed("info sun.gltf");
    assert!(text.contains("light 0 'n': a direction, without extent"), "{text}");
}

#[test]
fn rectangles_and_cameras_of_gltf() {
    let folder = Folder::new();
    let render = |model: &str, options: &str| {
        folder.succeed(&format!("render {model} -o o.exr --size 48x48 --view visibility {options}"));
        image::open(folder.path("o.exr")).unwrap().into_rgb32f()
    };
    // A quarter turn about x: −z becomes down.
    let panel = r#"{"translation":[0,4,0],"rotation":[-0.7071067811865476,0,0,0.7071067811865476],
        "extras":{"umbra4":{"width":2,"height":2,"samples":8}}}"#;
    let camera = r#"{"translation":[0.5,1.5,6],"camera":0}"#;
    folder.write("panel.gltf", gltf(&format!("{panel},{camera}"), "1,2", ""));
    let options = "--camera-from 0.5,1.5,6 --camera-to 0.5,1.5,0 --fov 45.83662361046586";
    folder.write("light.json", r#"{"corner":[-1,4,-1],"edge_u":[2,0,0],"edge_v":[0,0,2]}"#);
    let expected = render("model.obj", &format!("--light light.json --samples 8 {options}"));
    let mean = |picture: &Rgb32FImage| picture.iter().map(|v| f64::from(*v)).sum::<f64>() / 6912.0;
    let got = render("panel.gltf", "");
    // Turned by f32 rotations, the light is not the same to the last bit.
    assert!((mean(&got) - mean(&expected)).abs() < 1e-3, "{} {}", mean(&got), mean(&expected));
    let apart = got.iter().zip(expected.iter()).filter(|(a, b)| (*a - *b).abs() > 0.05).count();
    assert!(apart < 30, "{apart}");
    assert_ne!(render("panel.gltf", "--camera-from 5,5,5"), got);

    folder.write("bad.gltf", gltf(&panel.replace("\"width\":2", "\"width\":-2"), "1", ""));
    folder.fail("render bad.gltf -o out.png", "bad.gltf: light 0: field `width` is -2");
    folder.succeed("render bad.gltf -o b.png --size 16x16 --sun 0,1,0");
}
