//! What an engine would have: buffers and textures with contents, and both read back.

use umbra4_wgpu::{
    Gpu,
    wgpu::{self, BufferUsages, Extent3d, TextureFormat, TextureUsages},
};

/// A buffer with contents, padded to whole words.
pub fn buffer(gpu: &Gpu, contents: &[u8], usage: BufferUsages) -> wgpu::Buffer {
    let size = contents.len().max(4).next_multiple_of(4) as u64;
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("test"),
        size,
        usage: usage | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut padded = contents.to_vec();
    padded.resize(size as usize, 0);
    gpu.queue.write_buffer(&buffer, 0, &padded);
    buffer
}

/// A texture of `size` (columns, rows, layers).
pub fn texture(gpu: &Gpu, size: [u32; 3], format: TextureFormat, usage: TextureUsages) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("test"),
        size: Extent3d { width: size[0], height: size[1], depth_or_array_layers: size[2] },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

/// A texture that can be bound, with contents: rows of pixels without padding.
pub fn filled(gpu: &Gpu, [width, height]: [u32; 2], format: TextureFormat, contents: &[u8]) -> wgpu::TextureView {
    let texture = texture(gpu, [width, height, 1], format, TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST);
    gpu.queue.write_texture(
        texture.as_image_copy(),
        contents,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(contents.len() as u32 / height),
            rows_per_image: None,
        },
        texture.size(),
    );
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// The first `bytes` bytes of a buffer.
pub fn read(gpu: &Gpu, source: &wgpu::Buffer, bytes: u64) -> Vec<u8> {
    let staging = staging(gpu, bytes);
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(source, 0, &staging, 0, bytes);
    gpu.queue.submit([encoder.finish()]);
    mapped(gpu, &staging)
}

/// The pixels of a layer of a texture, rows without padding.
pub fn read_layer(gpu: &Gpu, source: &wgpu::Texture, layer: u32) -> Vec<u8> {
    let row = source.width() * source.format().block_copy_size(None).expect("a colour format");
    let pitch = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let staging = staging(gpu, u64::from(pitch) * u64::from(source.height()));
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo { origin: wgpu::Origin3d { x: 0, y: 0, z: layer }, ..source.as_image_copy() },
        wgpu::TexelCopyBufferInfo {
            buffer: &staging,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(pitch), rows_per_image: None },
        },
        Extent3d { depth_or_array_layers: 1, ..source.size() },
    );
    gpu.queue.submit([encoder.finish()]);
    mapped(gpu, &staging).chunks_exact(pitch as usize).flat_map(|line| line[..row as usize].to_vec()).collect()
}

fn staging(gpu: &Gpu, size: u64) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read back"),
        size,
        usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

fn mapped(gpu: &Gpu, staging: &wgpu::Buffer) -> Vec<u8> {
    staging.map_async(wgpu::MapMode::Read, .., |result| result.expect("the device answers"));
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device answers");
    staging.get_mapped_range(..).expect("it is mapped").to_vec()
}
