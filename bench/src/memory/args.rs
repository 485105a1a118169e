//! The command `memory`: its arguments, and what it prints.

use std::{
    io::Write,
    path::PathBuf,
    process::{Command, Stdio},
};

use clap::Args;
use umbra4_core::Bounds;

use super::{child::MemoryError, exchange::Handed};
use crate::{
    image_size::ImageSize,
    primary::hits,
    scene::{PAPER_LIGHT, scene},
};

/// Name of the child's command.
pub const CHILD: &str = "memory-child";

const MEBIBYTE: f64 = (1 << 20) as f64;

/// Arguments of the command.
#[derive(Args)]
pub struct MemoryArgs {
    /// Where bench/fetch-scenes.sh put the models.
    #[arg(long, default_value = "target/scenes")]
    scenes: PathBuf,
    /// dragon11k, dragon48k, dragon203k, dragon871k, sponza, foliage, lattice, hairball.
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "dragon48k,dragon203k,dragon871k,sponza,foliage,lattice,hairball"
    )]
    scene: Vec<String>,
    /// Size of the image, WIDTHxHEIGHT in pixels.
    #[arg(long, default_value = "1920x1080")]
    size: ImageSize,
    /// Rows and columns of the light's samples.
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=64))]
    samples: u32,
    /// Diagonal of the light in the paper's units (its table 5: 1 to 5).
    #[arg(long, default_value_t = PAPER_LIGHT, value_parser = crate::shared_args::light_scale)]
    light_scale: f64,
    /// Threads; every one has masks in flight of its own.
    #[arg(long, value_delimiter = ',', default_value = "1,2")]
    threads: Vec<usize>,
}

/// What the child says, in bytes beyond the scene.
struct Beyond {
    /// At most, while the scene is snapped.
    snapping: u64,
    /// Held after that.
    snapped: u64,
    /// At most, while visibility is computed; what is held included.
    computing: u64,
}

impl MemoryArgs {
    /// Measures all scenes, and prints a line each as it is known.
    ///
    /// # Errors
    /// No such scene; a child that fails; a system that does not tell its peak.
    pub fn run(&self) -> Result<(), MemoryError> {
        if super::resident::peak().is_none() {
            return Err(MemoryError::NotMeasurable);
        }
        println!(
            "| scene | triangles | receivers | threads | scene given | peak beyond it | … while snapping | held after that | \
             … while computing | peak beyond, bytes a receiver |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|"
        );
        for name in &self.scene {
            let handed = self.hand(name)?;
            for &threads in &self.threads {
                let Beyond { snapping, snapped, computing } = measure(&handed, threads)?;
                let peak = snapping.max(computing);
                let mebibytes = |bytes: u64| format!("{:.1} MiB", bytes as f64 / MEBIBYTE);
                println!(
                    "| {name} | {} | {} | {threads} | {} | {} | {} | {} | {} | {:.1} |",
                    handed.triangles.len(),
                    handed.positions.len(),
                    mebibytes(handed.bytes()),
                    mebibytes(peak),
                    mebibytes(snapping),
                    mebibytes(snapped),
                    mebibytes(computing),
                    peak as f64 / handed.positions.len().max(1) as f64,
                );
            }
        }
        println!(
            "\nPeak resident memory at {}, {}×{} samples, visibility only. The scene given is triangles, positions and normals \
             in f32. Held after snapping: both once more, in lattice coordinates. Computing adds the index, masks in flight and \
             the result.",
            self.size, self.samples, self.samples
        );
        Ok(())
    }

    /// Makes the scene called `name` ready.
    fn hand(&self, name: &str) -> Result<Handed, MemoryError> {
        eprintln!("{name}");
        let scene = scene(name, &self.scenes, self.samples, self.light_scale)?;
        let hits = hits(&scene.model, &scene.camera, self.size);
        let points = scene.model.vertices.iter().copied().chain(hits.iter().map(|hit| hit.position));
        let bounds = Bounds::of(points.map(|p| p.as_dvec3()).chain(scene.light.corners()));
        Ok(Handed {
            positions: hits.iter().map(|hit| hit.position).collect(),
            normals: hits.iter().map(|hit| hit.normal).collect(),
            lamp: [scene.lamp.corner, scene.lamp.edge_u, scene.lamp.edge_v],
            samples: [self.samples; 2],
            bounds,
            vertices: scene.model.vertices,
            triangles: scene.model.triangles,
        })
    }
}

/// Starts a process for one scene.
fn measure(handed: &Handed, threads: usize) -> Result<Beyond, MemoryError> {
    let program = std::env::current_exe()?;
    let mut child = Command::new(program)
        .args([CHILD, "--threads", &threads.to_string()])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()?;
    if let Some(mut stdin) = child.stdin.take() {
        // A child that fails early closes the pipe: what it says on stderr matters more.
        let _ = handed.write(&mut stdin).and_then(|()| stdin.flush());
    }
    let output = child.wait_with_output()?;
    if !output.status.success() {
        return Err(MemoryError::Child);
    }
    let text = String::from_utf8_lossy(&output.stdout);
    let numbers: Vec<u64> = text.split_whitespace().take(4).filter_map(|number| number.parse().ok()).collect();
    let &[scene, snapping, snapped, computing] = &numbers[..] else { return Err(MemoryError::Child) };
    let [snapping, snapped, computing] = [snapping, snapped, computing].map(|bytes| bytes.saturating_sub(scene));
    Ok(Beyond { snapping, snapped, computing })
}
