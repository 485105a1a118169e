//! `umbra4 render` and the program without arguments, at sizes that take no time.
#![allow(clippy::unwrap_used)] // in a test, a panic is the message

use crate::common::Folder;

#[test]
fn every_view_of_the_built_in_scene() {
    let folder = Folder::new();
    for view in ["shaded", "visibility", "penumbra", "pairs"] {
        folder.succeed(&format!("render --builtin -o {view}.png --size 48x32 --samples 8 --view {view}"));
        let picture = image::open(folder.path(&format!("{view}.png"))).unwrap().into_rgb8();
        assert_eq!(picture.dimensions(), (48, 32));
        let (low, high) = picture.iter().fold((255, 0), |(low, high), &v| (v.min(low), v.max(high)));
        assert!(high - low > 100, "{view} is flat: {low}..={high}");
    }
}

#[test]
fn all_kinds_of_shadow_are_seen() {
    let folder = Folder::new();
    folder.succeed("render --builtin -o v.exr --width 64 --height 64 --samples 16 --view visibility");
    let picture = image::open(folder.path("v.exr")).unwrap().into_rgb32f();
    let share = |class: fn(f32) -> bool| picture.pixels().filter(|p| class(p.0[0])).count() as f64 / 4096.0;
    let (umbra, penumbra, lit) = (share(|v| v <= 0.0), share(|v| v > 0.0 && v < 1.0), share(|v| v >= 1.0));
    assert!(umbra > 0.05 && penumbra > 0.15 && lit > 0.15, "{umbra} {penumbra} {lit}");
}

#[test]
fn lights_without_extent_cast_hard_shadows() {
    let folder = Folder::new();
    for (name, light) in [("sun", "--sun -1,2,0.5"), ("lamp", "--lamp -2,6,3")] {
        let options = format!("--builtin --size 64x64 {light}");
        let table = folder.succeed(&format!("render -o {name}.exr --view visibility {options}"));
        for word in ["resolve_punctual", name, "penumbra 0.0 %"] {
            assert!(table.contains(word), "{table}");
        }
        let picture = image::open(folder.path(&format!("{name}.exr"))).unwrap().into_rgb32f();
        let share = |class: fn(f32) -> bool| picture.pixels().filter(|p| class(p.0[0])).count() as f64 / 4096.0;
        assert!(share(|v| v <= 0.0) > 0.05 && share(|v| v >= 1.0) > 0.15, "{name}");
        folder.succeed(&format!("render -o {name}.png {options}"));
        folder.fail(&format!("render -o out.png --view pairs {options}"), "--view pairs is for lights with an area");
    }
    folder.fail("render --builtin -o out.png --sun 0,0,0", "points nowhere");
    folder.fail("render --builtin -o out.png --lamp nan,0,0", "NaN");
}

#[test]
fn a_model_gets_a_camera_a_light_and_a_ground() {
    let folder = Folder::new();
    let table = folder.succeed("render model.obj -o a.png --size 64x64 --samples 16");
    for word in ["seconds", "resolve", "pairs relevant", "umbra"] {
        assert!(table.contains(word), "{table}");
    }
    folder.succeed("render model.obj -o b.png --size 64x64 --samples 16 --no-ground --precision fast --threads 1");
    folder.succeed(
        "render model.obj -o c.png --size 32x32 --samples 8 --light light.json --camera-from -3,2,4 --camera-to 0,1,0 --fov 50 --oversample 2",
    );
    assert_eq!(image::open(folder.path("c.png")).unwrap().width(), 32);
    assert_ne!(std::fs::read(folder.path("a.png")).unwrap(), std::fs::read(folder.path("b.png")).unwrap());
}

#[test]
fn frames_of_jittered_samples_accumulate() {
    let folder = Folder::new();
    let render = |name: &str, options: &str| {
        let table = folder
            .succeed(&format!("render --builtin -o {name}.exr --size 48x32 --samples 8 --view visibility {options}"));
        (table, image::open(folder.path(&format!("{name}.exr"))).unwrap().into_rgb32f())
    };
    let (table, regular) = render("regular", "");
    assert!(table.contains("8×8 light samples,"), "{table}");
    let (table, one) = render("one", "--jitter 1");
    assert!(table.contains("8×8 jittered light samples, 1 frame,"), "{table}");
    let (table, four) = render("four", "--jitter 4");
    assert!(table.contains("8×8 jittered light samples, 4 frames,"), "{table}");
    assert!(one != regular && four != regular && one != four);
    // Four times as many steps of grey.
    let gray = |p: &&image::Rgb<f32>| p.0[0] == p.0[1]; // where something is seen
    let whole = |picture: &image::Rgb32FImage, steps: f32| {
        picture.pixels().filter(gray).all(|p| (p.0[0] * steps).fract() == 0.0)
    };
    assert!(whole(&one, 64.0) && whole(&four, 256.0) && !whole(&four, 64.0));
    // Stages are those of all frames together.
    for stage in ["snap", "resolve", "accumulate", "shade", "sum"] {
        assert_eq!(table.lines().filter(|line| line.split(' ').next() == Some(stage)).count(), 1, "{stage}: {table}");
    }

    let table = folder.succeed("render --builtin -o p.png --size 16x16 --samples 8 --view pairs --jitter 9");
    assert!(table.contains("jittered light samples, 1 frame,"), "{table}");
    folder.succeed("render model.obj -o many.png --size 2x2 --samples 64 --no-ground --jitter 4096");
}

#[test]
fn degenerate_models_and_empty_views_work() {
    let folder = Folder::new();
    folder.write("model.obj", "v 0 1 0\nv 1 1 0\nv 2 1 0\nf 1 2 3\n");
    folder.succeed("render model.obj -o a.png --size 16x16 --samples 8 --no-ground");
    folder.succeed("render model.obj -o b.png --size 16x16 --samples 8 --view pairs");
    folder.succeed("render --builtin -o c.png --size 16x16 --samples 8 --camera-from 0,50,0 --camera-to 0,90,0");
}

#[test]
fn info_tells_the_plan() {
    let text = Folder::new().succeed("info");
    assert!(text.contains("threads") && text.contains("resolve"), "{text}");
}
