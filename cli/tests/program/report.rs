//! `umbra4 report`, at a size that takes little time.

use std::fs;

use crate::common::Folder;

/// Methods on a machine without a GPU: two precisions, and jittered samples, at four resolutions; six numbers of frames; two
/// kinds of shadow maps of four sizes; and eight of rays.
const METHODS: usize = 34;

#[test]
fn the_built_in_scene() {
    let folder = Folder::new();
    let table = folder.succeed("report --builtin --size 48x48 --threads 2 -o out");
    assert!(table.contains("umbra4 exact, 8×8") && table.contains("wrote out"), "{table}");

    let html = fs::read_to_string(folder.path("out/index.html")).unwrap();
    // Letters of pictures may spell anything.
    let parts = html.split("base64,").enumerate();
    let text: String = parts.map(|(k, part)| if k == 0 { part } else { part.split_once('"').unwrap().1 }).collect();
    for words in ["http://", "https://", "NaN", "inf<"] {
        assert!(!text.contains(words), "the page holds {words}");
    }
    for words in
        ["<svg", "frames accumulated", "data:image/png;base64,", "umbra4 report", "128×128", "2 threads", "BVH"]
    {
        assert!(html.contains(words), "the page lacks {words}");
    }

    let csv = fs::read_to_string(folder.path("out/report.csv")).unwrap();
    let rows: Vec<Vec<&str>> = csv.lines().skip(1).map(fields).collect();
    assert!(rows.len() > METHODS, "{csv}");
    let names: std::collections::HashSet<&str> = rows.iter().map(|row| row[0]).collect();
    assert_eq!(names.len(), rows.len(), "{csv}");
    let columns: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let column = |name: &str| columns.iter().position(|c| *c == name).unwrap();
    let value = |row: &[&str], name: &str| row[column(name)].parse::<f64>().unwrap();
    assert!(rows.iter().all(|row| row.len() == columns.len()), "{csv}");

    let (reference, methods) = rows.split_last().unwrap();
    assert!(reference[0].starts_with("reference"));
    for name in ["mean_error", "max_error", "flip"] {
        assert_eq!(value(reference, name), 0.0, "{csv}");
    }
    for row in methods {
        let (mean, largest) = (value(row, "mean_error"), value(row, "max_error"));
        assert!(0.0 < mean && mean < largest && largest <= 1.0, "{row:?}");
        assert!(value(row, "seconds") > 0.0 && value(row, "flip") > 0.0, "{row:?}");
    }
    let of = |name: &str, column: &str| value(methods.iter().find(|row| row[0] == name).unwrap(), column);
    let error = |name: &str| of(name, "mean_error");
    let exact = [8, 16, 32, 64].map(|n| error(&format!("umbra4 exact, {n}×{n}")));
    assert!(exact.windows(2).all(|pair| pair[1] < pair[0]), "{exact:?}");
    let jittered = [4, 64, 1024].map(|n| error(&format!("BVH rays, jittered samples, {n}")));
    assert!(jittered.windows(2).all(|pair| pair[1] < pair[0]), "{jittered:?}");
    let once = [8, 16, 32, 64].map(|n| error(&format!("umbra4 exact, jittered, {n}×{n}")));
    assert!(once.windows(2).all(|pair| pair[1] < pair[0]), "{once:?}");
    assert!(once.iter().zip(exact).all(|(once, exact)| (0.3..3.0).contains(&(once / exact))), "{once:?}, {exact:?}");
    let names = [2, 4, 8, 16, 32, 64].map(|n| (n, format!("umbra4 exact, 8×8 jittered, {n} frames")));
    for (frames, name) in &names {
        assert_eq!((of(name, "frames"), of(name, "samples")), (f64::from(*frames), 64.0));
    }
    for column in ["mean_error", "flip"] {
        let falls = names.windows(2).all(|pair| of(&pair[1].1, column) < of(&pair[0].1, column));
        assert!(falls && of(&names[0].1, column) < of("umbra4 exact, jittered, 8×8", column), "{csv}");
    }
    assert!(names.windows(2).all(|pair| of(&pair[1].1, "seconds") > of(&pair[0].1, "seconds")), "{csv}");
    assert!(error(&names[5].1) < 0.2 * once[0], "{csv}");
    // Maps have texels, and no samples; and what they save is not accuracy.
    for name in ["microquads", "stochastic maps"] {
        let maps = [128, 256, 512, 1024].map(|n| format!("{name}, map of {n}×{n}"));
        for (name, texels) in maps.iter().zip([16_384.0, 65_536.0, 262_144.0, 1_048_576.0]) {
            let row = methods.iter().find(|row| row[0] == name).unwrap();
            assert!(row[column("samples")].is_empty() && value(row, "map_texels") == texels, "{row:?}");
        }
        assert!(error(&maps[3]) < error(&maps[0]) && error(&maps[3]) > exact[0], "{csv}");
    }
    assert!(
        methods.iter().all(|row| row[column("samples")].is_empty() != row[column("map_texels")].is_empty()),
        "{csv}"
    );
    let of_many = methods.iter().filter(|row| value(row, "frames") != 1.0).count();
    assert_eq!((of_many, value(reference, "frames")), (names.len(), 1.0));
    // The same samples: all but a few bits.
    assert!((error("BVH rays, regular samples, 16×16") / exact[1] - 1.0).abs() < 0.05);

    let plot = fs::read_to_string(folder.path("out/plot.svg")).unwrap();
    assert!(plot.starts_with("<svg xmlns=") && plot.contains("The price of accuracy") && !plot.contains("href"));
    check_plot(&folder, &table);
    let picture = image::open(folder.path("out/pictures/umbra4-exact-8x8-shaded.png")).unwrap();
    assert_eq!((picture.width(), picture.height()), (48, 48));
    let pictures = folder.path("out/pictures").read_dir().unwrap().count();
    assert_eq!(pictures, 2 * rows.len());

    // What is there is not touched.
    folder.fail("report --builtin --size 8x8 -o out", "out: is there already, and not an empty folder");
    assert_eq!(fs::read_to_string(folder.path("out/index.html")).unwrap(), html);
}

#[test]
fn what_cannot_be_reported_is_refused() {
    let folder = Folder::new();
    folder.write("file", "precious");
    folder.fail("report --builtin -o file", "file: is there already");
    folder.fail("report --builtin -o missing/out", "missing/out: cannot be written");
    folder.fail("report --builtin", "--output");
    folder.fail("report -o out", "required");
    folder.fail("report missing.obj -o out", "missing.obj: cannot be read");
    folder
        .fail("report --builtin --size 8x8 --camera-from 0,50,0 --camera-to 0,90,0 -o out", "the camera sees nothing");
    folder.write("light.json", r#"{"corner":[0,4,0],"edge_u":[1e-5,0,0],"edge_v":[0,0,1e-5]}"#);
    folder.fail("report model.obj --light light.json --size 8x8 -o out", "too fine");
    // Fine enough for regular samples, not for jittered ones.
    folder.write("light.json", r#"{"corner":[0,4,0],"edge_u":[2e-4,0,0],"edge_v":[0,0,2e-4]}"#);
    folder.fail("report model.obj --light light.json --size 8x8 --no-ground -o out", "too fine");
}

#[cfg(feature = "plot-png")]
fn check_plot(folder: &Folder, said: &str) {
    let plot = image::open(folder.path("out/plot.png")).unwrap().into_rgb8();
    assert!(plot.width() > 1000 && plot.pixels().filter(|p| p.0 != [255; 3]).count() > 10_000);
    assert!(said.contains("plot.svg, plot.png"), "{said}");
}

#[cfg(not(feature = "plot-png"))]
fn check_plot(folder: &Folder, said: &str) {
    assert!(!folder.path("out/plot.png").exists());
    assert!(said.contains("the feature `plot-png` draws plot.png too"), "{said}");
}

/// The fields of a line, without the quotes of those that have them.
fn fields(line: &str) -> Vec<&str> {
    let (mut fields, mut rest) = (Vec::new(), line);
    loop {
        let (field, after) = match rest.strip_prefix('"') {
            Some(quoted) => quoted.split_once('"').unwrap(),
            None => rest.split_at(rest.find(',').unwrap_or(rest.len())),
        };
        fields.push(field);
        let Some(next) = after.strip_prefix(',') else { return fields };
        rest = next;
    }
}
