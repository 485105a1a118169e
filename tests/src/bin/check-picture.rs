//! Checks what `umbra4` drew of its built-in scene: `check-picture SHADED.png PENUMBRA.png`, the same view shaded and with
//! `--view penumbra`. Exits with 1 where the pictures are not what they should be.

use std::{fs::File, io::BufReader, path::Path, process::ExitCode};

use png::{ColorType, Transformations};

/// Eight-bit RGB, row by row.
struct Picture {
    size: (u32, u32),
    pixels: Vec<[u8; 3]>,
}

/// What a pixel of the penumbra view says.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Nothing,
    Umbra,
    Penumbra,
    Lit,
}

/// Colours of the penumbra view, as the program documents them, times 255.
const COLORS: [(Kind, [u8; 3]); 3] =
    [(Kind::Nothing, [77, 87, 102]), (Kind::Umbra, [26, 28, 69]), (Kind::Lit, [245, 240, 219])];
/// Ends of the penumbra's ramp, from almost dark to almost lit.
const RAMP: [[u8; 3]; 2] = [[184, 41, 61], [252, 179, 71]];

/// Shares in per cent: of the picture that sees a surface, then of that part. Around 88.7, 16.4, 28.8 and 54.8.
const SHARES: [(&str, f64, f64); 4] =
    [("surface", 84.0, 93.0), ("umbra", 13.0, 20.0), ("penumbra", 25.0, 33.0), ("lit", 50.0, 60.0)];
/// Lit pixels are this much brighter than those in umbra, on average.
const CONTRAST: f64 = 2.5;
/// Least number of distinct colours of a shaded picture.
const FEWEST_COLORS: usize = 1000;

fn read(path: &Path) -> Result<Picture, Box<dyn std::error::Error>> {
    let mut decoder = png::Decoder::new(BufReader::new(File::open(path)?));
    decoder.set_transformations(Transformations::normalize_to_color8());
    let mut reader = decoder.read_info()?;
    let mut bytes = vec![0; reader.output_buffer_size().ok_or("too large")?];
    let info = reader.next_frame(&mut bytes)?;
    if info.color_type != ColorType::Rgb {
        return Err(format!("{}: {:?} and not RGB", path.display(), info.color_type).into());
    }
    Ok(Picture { size: (info.width, info.height), pixels: bytes.as_chunks::<3>().0.to_vec() })
}

fn kind(pixel: [u8; 3]) -> Option<Kind> {
    if let Some((kind, _)) = COLORS.iter().find(|(_, color)| *color == pixel) {
        return Some(*kind);
    }
    // On the ramp: all channels are the same part of the way.
    let part = (f64::from(pixel[0]) - f64::from(RAMP[0][0])) / f64::from(RAMP[1][0] - RAMP[0][0]);
    let near = |k: usize| {
        let (from, to) = (f64::from(RAMP[0][k]), f64::from(RAMP[1][k]));
        (from + part * (to - from) - f64::from(pixel[k])).abs() < 3.0
    };
    ((0.0..=1.0).contains(&part) && near(1) && near(2)).then_some(Kind::Penumbra)
}

fn luminance([r, g, b]: [u8; 3]) -> f64 {
    0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
}

fn check(shaded: &Picture, penumbra: &Picture, size: (u32, u32)) -> Result<String, String> {
    for (name, picture) in [("shaded", shaded), ("penumbra", penumbra)] {
        if picture.size != size || picture.pixels.len() != size.0 as usize * size.1 as usize {
            return Err(format!("the {name} picture is {:?}, not {size:?}", picture.size));
        }
    }
    let kinds: Option<Vec<Kind>> = penumbra.pixels.iter().map(|p| kind(*p)).collect();
    let kinds = kinds.ok_or("the penumbra picture has a colour that means nothing")?;
    let count = |wanted: Kind| kinds.iter().filter(|k| **k == wanted).count() as f64;
    let surface = kinds.len() as f64 - count(Kind::Nothing);
    let shares = [
        surface / kinds.len() as f64,
        count(Kind::Umbra) / surface,
        count(Kind::Penumbra) / surface,
        count(Kind::Lit) / surface,
    ]
    .map(|share| 100.0 * share);
    let mut report = String::new();
    for ((name, least, most), share) in SHARES.into_iter().zip(shares) {
        if !(least..=most).contains(&share) {
            return Err(format!("{name} is {share:.1} %, not {least} to {most} %"));
        }
        report += &format!("{name} {share:.1} %, ");
    }
    let mean = |wanted: Kind| {
        let chosen = shaded.pixels.iter().zip(&kinds).filter(|(_, kind)| **kind == wanted);
        chosen.map(|(pixel, _)| luminance(*pixel)).sum::<f64>() / count(wanted)
    };
    let contrast = mean(Kind::Lit) / mean(Kind::Umbra);
    if contrast.is_nan() || contrast < CONTRAST {
        return Err(format!("lit pixels are only {contrast:.2} times as bright as umbra, not {CONTRAST}"));
    }
    let mut colors = shaded.pixels.clone();
    colors.sort_unstable();
    colors.dedup();
    if colors.len() < FEWEST_COLORS {
        return Err(format!("the shaded picture has only {} colours", colors.len()));
    }
    Ok(format!("{report}lit pixels {contrast:.2} times as bright as umbra, {} colours", colors.len()))
}

fn run() -> Result<String, Box<dyn std::error::Error>> {
    let paths: Vec<_> = std::env::args_os().skip(1).collect();
    let [shaded, penumbra] = paths.as_slice() else {
        return Err("usage: check-picture SHADED.png PENUMBRA.png".into());
    };
    Ok(check(&read(shaded.as_ref())?, &read(penumbra.as_ref())?, (512, 512))?)
}

fn main() -> ExitCode {
    match run() {
        Ok(report) => {
            println!("{report}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("check-picture: {error}");
            ExitCode::FAILURE
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (u32, u32) = (100, 40);

    /// 12 % nothing; of the rest 16, 29 and 55 % umbra, penumbra and lit. `shade` gives the shaded picture.
    fn pictures(shade: impl Fn(usize, Kind) -> [u8; 3]) -> (Picture, Picture) {
        let kinds: Vec<Kind> = (0..4000)
            .map(|i| match i {
                0..480 => Kind::Nothing,
                480..1043 => Kind::Umbra,
                1043..2064 => Kind::Penumbra,
                _ => Kind::Lit,
            })
            .collect();
        let color = |kind: &Kind| COLORS.iter().find(|(k, _)| k == kind).map_or([218, 110, 66], |(_, color)| *color);
        let shaded = kinds.iter().enumerate().map(|(i, kind)| shade(i, *kind)).collect();
        (Picture { size: SIZE, pixels: shaded }, Picture { size: SIZE, pixels: kinds.iter().map(color).collect() })
    }

    fn shade(i: usize, kind: Kind) -> [u8; 3] {
        let base = if kind == Kind::Lit { 160 } else { 40 };
        [base + (i % 50) as u8, base + (i / 50 % 50) as u8, base]
    }

    #[test]
    fn right_pictures_pass() {
        let (shaded, penumbra) = pictures(shade);
        check(&shaded, &penumbra, SIZE).expect("these are right");
        assert!(RAMP.iter().all(|end| kind(*end) == Some(Kind::Penumbra)));
    }

    #[test]
    fn wrong_pictures_fail() {
        let (shaded, penumbra) = pictures(shade);
        let white = || Picture { size: SIZE, pixels: vec![[255; 3]; 4000] };
        let lit = || Picture { size: SIZE, pixels: vec![COLORS[2].1; 4000] };
        let empty = || Picture { size: (0, 0), pixels: Vec::new() };
        let unshadowed = pictures(|i, _| shade(i, Kind::Lit)).0;
        let two_tone = pictures(|_, kind| if kind == Kind::Lit { [200; 3] } else { [50; 3] }).0;
        for (shaded, penumbra, reason) in [
            (&white(), &white(), "means nothing"),
            (&white(), &penumbra, "as bright"),
            (&shaded, &white(), "means nothing"),
            (&shaded, &lit(), "surface is 100.0"),
            (&shaded, &shaded, "means nothing"),
            (&unshadowed, &penumbra, "as bright"),
            (&two_tone, &penumbra, "colours"),
            (&empty(), &penumbra, "picture is (0, 0)"),
        ] {
            let error = check(shaded, penumbra, SIZE).expect_err(reason);
            assert!(error.contains(reason), "{error}: not about {reason}");
        }
    }
}
