//! umbra4 in an engine: a small deferred renderer on plain wgpu, with a moving lamp over moving geometry.
//!
//! ```sh
//! cargo run --release -p umbra4-wgpu --example engine                # writes engine.png
//! cargo run --release -p umbra4-wgpu --example engine -- --window    # where there is a display
//! ```
//!
//! Options: `-o FILE`, `--size WIDTHxHEIGHT`, `--time SECONDS`, `--adapter NAME`.

#[allow(dead_code, reason = "the tests look into it")]
mod renderer;
mod scene;
mod window;

use std::{env, fs::File, io::BufWriter};

use renderer::{Failure, Renderer};
use umbra4_wgpu::{Choice, Gpu, wgpu};

/// Format of the picture.
const PICTURE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// What the command line asks for.
#[derive(Clone, Debug)]
struct Options {
    window: bool,
    output: String,
    size: [u32; 2],
    time: f32,
    adapter: Choice,
}

fn options() -> Result<Options, Failure> {
    let mut options = Options {
        window: false,
        output: "engine.png".to_owned(),
        size: [960, 540],
        time: 2.0,
        adapter: Choice::Hardware,
    };
    let mut arguments = env::args().skip(1);
    while let Some(name) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{name} needs a value"));
        match name.as_str() {
            "--window" => options.window = true,
            "-o" => options.output = value()?,
            "--time" => options.time = value()?.parse()?,
            "--adapter" => options.adapter = Choice::Named(value()?),
            "--size" => {
                let text = value()?;
                let (width, height) = text.split_once('x').ok_or("--size takes WIDTHxHEIGHT")?;
                options.size = [width.parse()?, height.parse()?];
            }
            _ => return Err(format!("{name}: no such option").into()),
        }
    }
    if options.size.contains(&0) {
        return Err("--size: no side may be 0".into());
    }
    Ok(options)
}

fn main() {
    let done = options().and_then(|options| match options.window {
        true => window::run(&options),
        false => headless(&options),
    });
    if let Err(error) = done {
        eprintln!("error: {error}");
        std::process::exit(2);
    }
}

/// One frame, into a file.
fn headless(options: &Options) -> Result<(), Failure> {
    let gpu = Gpu::open(&options.adapter)?;
    let [width, height] = options.size;
    let mut renderer = Renderer::new(&gpu.device, &gpu.queue, options.size, PICTURE)?;
    let picture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("picture"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: PICTURE,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let pitch = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let staging = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("picture"),
        size: u64::from(pitch) * u64::from(height),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    renderer.frame(&mut encoder, &picture.create_view(&wgpu::TextureViewDescriptor::default()), options.time)?;
    encoder.copy_texture_to_buffer(
        picture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &staging,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(pitch), rows_per_image: None },
        },
        picture.size(),
    );
    gpu.queue.submit([encoder.finish()]);
    staging.map_async(wgpu::MapMode::Read, .., |_| {});
    gpu.device.poll(wgpu::PollType::wait_indefinitely())?;
    let rows: Vec<u8> = staging
        .get_mapped_range(..)?
        .chunks_exact(pitch as usize)
        .flat_map(|row| row[..4 * width as usize].to_vec())
        .collect();

    let mut file = png::Encoder::new(BufWriter::new(File::create(&options.output)?), width, height);
    file.set_color(png::ColorType::Rgba);
    file.set_depth(png::BitDepth::Eight);
    let mut writer = file.write_header()?;
    writer.write_image_data(&rows)?;
    writer.finish()?;
    println!("{}: {width} × {height}, 16 × 16 light samples, on {}", options.output, gpu.name);
    Ok(())
}
