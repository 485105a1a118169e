//! The engine in a window, until it is closed.

use std::{sync::Arc, time::Instant};

use umbra4_wgpu::wgpu;
use winit::{
    application::ApplicationHandler,
    dpi::PhysicalSize,
    event::WindowEvent,
    event_loop::{ActiveEventLoop, ControlFlow, EventLoop},
    window::{Window, WindowId},
};

use crate::{
    Options,
    renderer::{Failure, Renderer},
};

/// Runs until the window is closed, or something fails.
pub fn run(options: &Options) -> Result<(), Failure> {
    let events = EventLoop::new()?;
    events.set_control_flow(ControlFlow::Poll);
    let mut app = App { options: options.clone(), start: Instant::now(), open: None, failure: None };
    events.run_app(&mut app)?;
    app.failure.map_or(Ok(()), Err)
}

struct App {
    options: Options,
    start: Instant,
    open: Option<Open>,
    failure: Option<Failure>,
}

/// A window, and what draws into it.
struct Open {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    device: wgpu::Device,
    queue: wgpu::Queue,
    renderer: Renderer,
}

impl Open {
    fn new(events: &ActiveEventLoop, [width, height]: [u32; 2]) -> Result<Self, Failure> {
        let attributes = Window::default_attributes()
            .with_title("umbra4 in an engine")
            .with_inner_size(PhysicalSize::new(width, height));
        let window = Arc::new(events.create_window(attributes)?);
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let surface = instance.create_surface(window.clone())?;
        let wanted = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: Some(&surface),
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&wanted))?;
        // The engine's own device, with wgpu's default limits and no feature: umbra4 needs no more.
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default()))?;
        let size = window.inner_size();
        let mut config = surface
            .get_default_config(&adapter, size.width.max(1), size.height.max(1))
            .ok_or("the adapter cannot draw into the window")?;
        // The light pass writes sRGB by itself.
        config.format = config.format.remove_srgb_suffix();
        surface.configure(&device, &config);
        let renderer = Renderer::new(&device, &queue, [config.width, config.height], config.format)?;
        Ok(Self { window, surface, config, device, queue, renderer })
    }

    fn resize(&mut self, size: PhysicalSize<u32>) {
        if size.width == 0 || size.height == 0 {
            return;
        }
        (self.config.width, self.config.height) = (size.width, size.height);
        self.surface.configure(&self.device, &self.config);
        self.renderer.resize([size.width, size.height]);
    }

    fn draw(&mut self, time: f32) -> Result<(), Failure> {
        let picture = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(picture) | wgpu::CurrentSurfaceTexture::Suboptimal(picture) => picture,
            wgpu::CurrentSurfaceTexture::Outdated | wgpu::CurrentSurfaceTexture::Lost => {
                self.surface.configure(&self.device, &self.config);
                return Ok(());
            }
            _ => return Ok(()),
        };
        let view = picture.texture.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.renderer.frame(&mut encoder, &view, time)?;
        self.queue.submit([encoder.finish()]);
        self.window.pre_present_notify();
        self.queue.present(picture);
        Ok(())
    }
}

impl App {
    /// Keeps the first failure, and ends.
    fn check(&mut self, events: &ActiveEventLoop, done: Result<(), Failure>) {
        if let Err(failure) = done {
            self.failure.get_or_insert(failure);
            events.exit();
        }
    }
}

impl ApplicationHandler for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.open.is_none() {
            let opened = Open::new(events, self.options.size).map(|open| self.open = Some(open));
            self.check(events, opened);
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else { return };
        match event {
            WindowEvent::CloseRequested => events.exit(),
            WindowEvent::Resized(size) => open.resize(size),
            WindowEvent::RedrawRequested => {
                let drawn = open.draw(self.start.elapsed().as_secs_f32());
                self.check(events, drawn);
            }
            _ => {}
        }
    }

    fn about_to_wait(&mut self, _: &ActiveEventLoop) {
        if let Some(open) = &self.open {
            open.window.request_redraw();
        }
    }
}
