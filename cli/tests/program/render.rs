//! `umbra4 render` and the program without arguments, at sizes that take no time.

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
fn what_is_about_to_be_done_is_said_first() {
    let folder = Folder::new();
    let said = folder.succeed("render --builtin foliage -o a.png --size 16x8 --samples 8 --threads 1");
    let first = said.lines().next().unwrap();
    let words = "rendering the built-in scene foliage, 43430 triangles, 16×8 pixels, on cpu, 1 threads";
    assert!(first.starts_with(words), "{first}");
    let said = folder.succeed("render model.obj -o b.png --size 16x8 --samples 8");
    assert!(said.starts_with("rendering model.obj, "), "{said}");
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

#[cfg(not(feature = "gpu"))]
mod without_gpus {
    use super::Folder;

    #[test]
    fn what_needs_gpus_is_refused_and_says_how_they_come() {
        let folder = Folder::new();
        let masks = "masks --model model.obj --light light.json --receivers receivers.npy --samples 8 -o out.npy";
        let how = "the feature `gpu` brings them, cargo run --release --features gpu -- ";
        for (options, option) in [
            ("--executor gpu", "--executor gpu"),
            ("--executor gpu --adapter llvmpipe", "--executor gpu"),
            ("--executor auto --adapter llvmpipe", "--adapter"),
            ("--adapter llvmpipe", "--adapter"),
        ] {
            for command in [masks, "render --builtin -o out.png --size 8x8"] {
                let command = format!("{command} {options}");
                folder.fail(&command, how);
                folder.fail(&command, &format!("error: {option} needs GPUs"));
            }
        }
        folder.fail("report --builtin --size 8x8 -o out --adapter llvmpipe", how);
    }

    #[test]
    fn what_does_not_need_gpus_takes_the_processor() {
        let folder = Folder::new();
        let said = folder.succeed("render model.obj -o out.png --size 8x8 --samples 8 --executor auto");
        assert!(said.contains("on cpu, "), "{said}");
        let text = folder.succeed("info");
        assert!(text.contains("GPUs             left out: the feature `gpu` brings them"), "{text}");
    }
}

#[cfg(feature = "gpu")]
mod with_gpus {
    use super::Folder;

    /// Whatever this machine has: what `info` says of an adapter is what happens to it.
    #[test]
    fn info_says_what_masks_do() {
        let folder = Folder::new();
        let output = folder.run("info");
        assert!(output.status.success() && output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains("not looked for on GL"), "{text}");
        let usable = |line: &str| line.ends_with(": usable");
        let lines: Vec<&str> = text.lines().filter(|line| line.starts_with("GPU  ")).collect();
        for line in &lines {
            let name = line.split_whitespace().nth(1).unwrap();
            // The first that has the word in its name and can be used is taken.
            let expected = lines.iter().any(|line| line.contains(name) && usable(line));
            let masks = "masks --model model.obj --light light.json --receivers receivers.npy --samples 8 -o out.npy";
            let output = folder.run(&format!("{masks} --executor gpu --adapter {name}"));
            let message = String::from_utf8(output.stderr).unwrap();
            assert_eq!(output.status.success(), expected, "{line}: {message}");
            assert_eq!(message.lines().count(), usize::from(!expected), "{line}: {message}");
        }
        folder.fail("render model.obj -o out.png --executor gpu --adapter nothing-is-called-so", "no adapter called");
    }
}
