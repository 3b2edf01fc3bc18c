//! The window: it passes winit's events to egui, and decides when to draw.

mod export_state;
mod keeping;
mod start;
mod surface;

use std::sync::Arc;
use std::time::{Duration, Instant};

use winit::application::ApplicationHandler;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Window, WindowId};

use super::painting::LegendCache;
use super::state::AppState;
use super::theme;
use super::ui::ui;
use crate::config::Config;
use crate::error::{Error, Result};
use crate::headless::HeadlessOptions;
use crate::live::{Live, LiveOptions};
use crate::render::RendererChoice;
use export_state::StateFile;
use keeping::{Keeper, forget, load};
pub(crate) use start::WindowOptions;
use start::{attributes, first, no_display};
use surface::{Drawn, WindowSurface};

/// Least time between two frames that are drawn because the simulation has advanced. It allows about 60 frames per
/// second, the rate of common screens.
pub(crate) const FRAME_INTERVAL: Duration = Duration::from_millis(16);
/// Least time between two frames if the processor draws instead of a graphics card. More than 25 frames per second
/// hardly look smoother, and drawing takes processor time from the solver.
pub const SOFTWARE_FRAME_INTERVAL: Duration = Duration::from_millis(40);
/// Largest number of consecutive losses of the graphics device after which the device is opened again. After one more
/// loss the program ends with an error.
const MOST_LOSSES: u32 = 3;

/// Opens the window and returns when it is closed.
///
/// # Errors
/// If there is no display or no graphics driver; the message names the package that provides it. Other errors have the
/// message of the operating system.
pub(crate) fn run(
    config: &Config,
    pictures: &HeadlessOptions,
    options: &WindowOptions,
) -> Result<()> {
    if options.reset_ui {
        forget();
    }
    let mut stored = load();
    stored.preferences.follow(pictures)?;
    let restart = pictures.restart.as_deref();
    let open_first = first(config, restart, options, &stored.preferences)?;
    // Other threads send an event when a new frame is available or a file was written.
    let events = EventLoop::with_user_event().build().map_err(|error| no_display(&error))?;
    let proxy = events.create_proxy();
    let wake = proxy.clone();
    let live = Live::spawn(LiveOptions {
        // Sending fails only after the loop has ended.
        wake: Box::new(move || {
            let _ = wake.send_event(());
        }),
        ..LiveOptions::default()
    })?;
    let mut state = AppState::idle(live, stored.preferences.clone());
    open_first(&mut state);
    let mut app = App {
        context: context(&proxy, stored.layout),
        proxy,
        state,
        open: None,
        failure: None,
        losses: 0,
        devices: 0,
        next_repaint: None,
        drawn: Instant::now(),
        state_file: options.export_state.clone().map(StateFile::new),
        renderer: pictures.renderer,
        keeper: Keeper::new(stored.preferences),
    };
    events.run_app(&mut app).map_err(|error| no_display(&error))?;
    app.failure.map_or(Ok(()), Err)
}

/// Returns an egui context in the style of the window. It wakes the event loop when another thread requests a frame.
fn context(proxy: &EventLoopProxy<()>, layout: egui::Memory) -> egui::Context {
    let context = egui::Context::default();
    context.memory_mut(|memory| *memory = layout);
    theme::install(&context);
    let wake = proxy.clone();
    let window_thread = std::thread::current().id();
    context.set_request_repaint_callback(move |info| {
        // A repaint that the window's own thread requests is reported as the delay after the present pass.
        if info.delay.is_zero() && std::thread::current().id() != window_thread {
            let _ = wake.send_event(());
        }
    });
    context
}

struct App {
    context: egui::Context,
    proxy: EventLoopProxy<()>,
    state: AppState,
    open: Option<Open>,
    failure: Option<Error>,
    losses: u32,
    devices: u32,
    next_repaint: Option<Instant>,
    drawn: Instant,
    state_file: Option<StateFile>,
    renderer: RendererChoice,
    keeper: Keeper,
}

/// The open window, with its input state and its drawing surface. This value exists as long as the window.
struct Open {
    window: Arc<Window>,
    input: egui_winit::State,
    surface: WindowSurface,
}

impl App {
    /// Connects a window with egui and with the surface of a graphics device, and requests the first frame.
    fn open(&mut self, events: &ActiveEventLoop, window: Arc<Window>) -> Result<()> {
        let surface = WindowSurface::new(events, &window, self.renderer)?;
        let input = egui_winit::State::new(
            self.context.clone(),
            egui::ViewportId::ROOT,
            &window,
            Some(window.scale_factor() as f32),
            window.theme(),
            Some(surface.largest_side()),
        );
        window.request_redraw();
        self.devices += 1;
        self.open = Some(Open { window, input, surface });
        Ok(())
    }

    fn fail(&mut self, events: &ActiveEventLoop, error: Error) {
        self.failure = Some(error);
        events.exit();
    }

    /// Opens the graphics device again after it was lost. The old surface is dropped first, because a window can have
    /// only one surface. The new egui context sends all textures again; the layout is copied from the old context.
    fn recover(&mut self, events: &ActiveEventLoop) {
        let Some(Open { window, input, surface }) = self.open.take() else { return };
        drop(surface);
        drop(input);
        self.losses += 1;
        if self.losses > MOST_LOSSES {
            let message =
                "the graphics device was lost several times in a row; --headless still works";
            return self.fail(events, Error::Renderer(message.into()));
        }
        let memory = self.context.memory(Clone::clone);
        self.context = context(&self.proxy, memory);
        self.state.panels.scene.legend = LegendCache::default();
        self.state.ensemble.stop();
        let text = "The graphics device was lost and opened again; the run continued.";
        match self.open(events, window) {
            Ok(()) => self.state.warn(text),
            Err(error) => self.fail(events, error),
        }
    }

    fn redraw(&mut self, events: &ActiveEventLoop) {
        let Some(Open { window, input, surface }) = &mut self.open else { return };
        let size = window.inner_size();
        if size.width == 0 || size.height == 0 || window.is_minimized() == Some(true) {
            return;
        }
        surface.resize(size);
        let raw_input = input.take_egui_input(window);
        let mut output = self.context.run_ui(raw_input, |ui_root| ui(ui_root, &mut self.state));
        input.handle_platform_output(window, std::mem::take(&mut output.platform_output));
        let viewport = output.viewport_output.get(&egui::ViewportId::ROOT);
        let delay = viewport.map_or(Duration::MAX, |viewport| viewport.repaint_delay);
        let closes = viewport
            .is_some_and(|viewport| viewport.commands.contains(&egui::ViewportCommand::Close));
        if closes {
            output.textures_delta.clear();
            events.exit();
            return;
        }
        let drawn = surface.draw(&self.context, output);
        if let Some(file) = &mut self.state_file {
            file.write(&self.state, window, self.devices);
        }
        if std::mem::take(&mut self.state.restart_graphics) {
            surface.destroy_device();
            window.request_redraw();
            return;
        }
        self.next_repaint = None;
        self.drawn = Instant::now();
        self.state.preferences.window_points =
            Some(window.inner_size().to_logical::<f64>(window.scale_factor()).into());
        let until_kept = self.keeper.look(&self.state.preferences, &self.context);
        let delay = delay.min(until_kept.unwrap_or(Duration::MAX));
        match drawn {
            Drawn::Shown => {
                self.losses = 0;
                if delay.is_zero() {
                    window.request_redraw();
                } else {
                    self.next_repaint = Instant::now().checked_add(delay);
                }
            }
            Drawn::Again => window.request_redraw(),
            Drawn::Hidden => {}
            Drawn::Lost => self.recover(events),
        }
    }
}

impl ApplicationHandler<()> for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.open.is_some() {
            return;
        }
        let attributes = attributes(events, self.state.preferences.window_points);
        let window = events.create_window(attributes).map_err(|error| no_display(&error));
        if let Err(error) = window.and_then(|window| self.open(events, Arc::new(window))) {
            self.fail(events, error);
        }
    }

    fn user_event(&mut self, _events: &ActiveEventLoop, _repaint: ()) {
        let software = self.open.as_ref().is_some_and(|open| open.surface.is_software);
        let interval = if software { SOFTWARE_FRAME_INTERVAL } else { FRAME_INTERVAL };
        let at = self.drawn + interval;
        self.next_repaint = Some(self.next_repaint.map_or(at, |planned| planned.min(at)));
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _window: WindowId, event: WindowEvent) {
        if let WindowEvent::CloseRequested | WindowEvent::Destroyed = event {
            events.exit();
            return;
        }
        if let WindowEvent::RedrawRequested = event {
            self.redraw(events);
            return;
        }
        let Some(Open { window, input, .. }) = &mut self.open else { return };
        if input.on_window_event(window, &event).repaint {
            window.request_redraw();
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        let due = self.next_repaint.take_if(|at| *at <= Instant::now());
        if let Some(open) = self.open.as_ref().filter(|_| due.is_some()) {
            open.window.request_redraw();
        }
        let planned = self.next_repaint.map(ControlFlow::WaitUntil);
        events.set_control_flow(planned.unwrap_or(ControlFlow::Wait));
    }

    fn exiting(&mut self, _events: &ActiveEventLoop) {
        self.keeper.keep(&self.state.preferences, &self.context);
        // The surface must be dropped while its window and display still exist.
        self.open = None;
    }
}
