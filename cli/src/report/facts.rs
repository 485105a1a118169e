//! What a reader must know to judge the numbers: scene, machine, command.

use std::env;

use umbra4_core::glam::DVec3;

use crate::{
    args::{PrecisionArg, SceneArgs},
    executor::{AnyExecutor, Device},
    report::problem::Problem,
};

/// Names of facts, and what they are.
pub type Facts = Vec<(&'static str, String)>;

/// All of them, for the head of the page.
pub fn facts(args: &SceneArgs, problem: &Problem, device: &Device) -> Facts {
    let light = &problem.scene.light;
    let [corner, u, v] = [light.corner, light.edge_u, light.edge_v].map(DVec3::from_array);
    let center = corner + (u + v) * 0.5;
    let gpu = device.name().map_or_else(|reason| format!("not measured: {reason}"), str::to_owned);
    vec![
        ("Scene", scene_and_triangles(args, problem)),
        ("Receivers", receivers(problem)),
        (
            "Light",
            format!(
                "{:.3} × {:.3}, centre at ({:.3}, {:.3}, {:.3})",
                u.length(),
                v.length(),
                center.x,
                center.y,
                center.z
            ),
        ),
        ("Processor", format!("{}; {}", processor(), AnyExecutor::cpu(PrecisionArg::Exact).name())),
        ("GPU", gpu),
        ("Command", command()),
    ]
}

/// Scene and receivers, for the head of the plot.
pub fn scene(args: &SceneArgs, problem: &Problem) -> String {
    format!("{}, {} receivers", scene_and_triangles(args, problem), grouped(problem.receivers()))
}

fn scene_and_triangles(args: &SceneArgs, problem: &Problem) -> String {
    let name = args.model.as_ref().map_or("the built-in scene".to_owned(), |path| {
        path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
    });
    format!("{name}, {} triangles", grouped(problem.scene.model.triangles.len()))
}

fn receivers(problem: &Problem) -> String {
    format!("{}, of {} × {} pixels", grouped(problem.receivers()), problem.seen.width, problem.seen.height)
}

/// The command line, as a shell would take it.
fn command() -> String {
    let words = env::args().enumerate().map(|(i, word)| {
        // Where the program lies says nothing.
        let word = if i == 0 { word.rsplit(['/', '\\']).next().unwrap_or("umbra4").to_owned() } else { word };
        let plain = !word.is_empty() && word.chars().all(|c| c.is_alphanumeric() || "-_./,=:+".contains(c));
        if plain { word } else { format!("'{}'", word.replace('\'', r"'\''")) }
    });
    words.collect::<Vec<_>>().join(" ")
}

/// What the processor calls itself.
fn processor() -> String {
    #[cfg(target_arch = "x86_64")]
    if let Some(brand) = raw_cpuid::CpuId::new().get_processor_brand_string() {
        return brand.as_str().split_whitespace().collect::<Vec<_>>().join(" ");
    }
    env::consts::ARCH.to_owned()
}

/// 1234567 as 1,234,567.
pub fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_are_set_apart() {
        assert_eq!([0, 12, 999, 1000, 1_234_567].map(grouped), ["0", "12", "999", "1,000", "1,234,567"]);
    }

    #[test]
    fn the_processor_has_a_name() {
        assert!(!processor().is_empty());
    }
}
