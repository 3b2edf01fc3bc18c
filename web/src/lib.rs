//! The browser version of Slump. The page draws and sends commands. Its web worker, another instance of this module,
//! computes the simulation.
//!
//! The page and the worker exchange only messages of bytes, which `static/page.js` and `static/worker.js` pass on.

use std::cell::RefCell;
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::mpsc::{Sender, channel};

use eframe::egui::{Context, Ui};
use slump::app::{AppState, Opening, browser};
use slump::live::{Live, RemoteEngine};
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
extern "C" {
    /// Sends a message from the page to its worker. If `interrupts` is true, the worker cancels the loading of a scene
    /// that is under way.
    fn slump_ask(message: Vec<u8>, interrupts: bool);
    /// Returns true if the worker must cancel the loading.
    fn slump_gives_up() -> bool;
    /// Sends a message from the worker to its page.
    fn slump_answer(message: Vec<u8>);
    /// Makes the browser save a file.
    fn slump_save(name: &str, bytes: Vec<u8>);
    /// Stores the preferences of the page.
    fn slump_store(text: &str);
}

/// The simulation engine in the web worker.
#[wasm_bindgen]
pub struct Engine(RemoteEngine<Opening>);

#[wasm_bindgen]
impl Engine {
    /// Returns an engine without a scene.
    #[wasm_bindgen(constructor)]
    #[allow(clippy::new_without_default, reason = "a page asks for it by `new`")]
    pub fn new() -> Self {
        console_error_panic_hook::set_once();
        Self(browser::engine(Box::new(slump_answer), slump_gives_up))
    }

    /// Handles a message from the page.
    ///
    /// # Errors
    /// If the message is invalid.
    pub fn receive(&mut self, message: &[u8]) -> Result<(), JsError> {
        self.0.receive(message).map_err(|error| JsError::new(&error.to_string()))
    }

    /// Does all work that is due. Returns the time until more work is due, ms; −1 if only a message can cause more
    /// work.
    pub fn turn(&mut self) -> f64 {
        self.0.turn().map_or(-1.0, |wait| 1e3 * wait.as_secs_f64())
    }
}

/// Computes the run that a link describes, and returns the hash of its last state. This is for programs that have no
/// page.
///
/// # Errors
/// If the link is invalid. The error names the fault.
#[wasm_bindgen]
pub fn state_of(link: &str) -> Result<String, JsError> {
    browser::state_of(link).map_err(|error| JsError::new(&error.to_string()))
}

/// Dropped files that have been read: name and content.
type Dropped = Rc<RefCell<Vec<(PathBuf, Vec<u8>)>>>;

/// The window in the browser page.
#[wasm_bindgen]
pub struct Page {
    answers: Sender<Vec<u8>>,
    context: Context,
    state: Rc<RefCell<AppState>>,
}

#[wasm_bindgen]
impl Page {
    /// Handles a message from the worker.
    pub fn receive(&self, message: Vec<u8>) {
        // Sending fails only if the page has been closed.
        let _ = self.answers.send(message);
        self.context.request_repaint();
    }

    /// Returns the state of the page and its run as JSON, for tests.
    pub fn told(&self) -> String {
        let (size, scale) = (self.context.content_rect().size(), self.context.pixels_per_point());
        let pixels = [size.x * scale, size.y * scale].map(|side| side as u32);
        browser::told(&self.state.borrow(), pixels, scale)
    }
}

/// Opens the window on a canvas, with its `stored` preferences and the run that the page's `address` names.
///
/// # Errors
/// If the browser supports neither WebGPU nor WebGL 2.
#[wasm_bindgen]
pub async fn open(
    canvas: web_sys::HtmlCanvasElement,
    stored: String,
    address: String,
) -> Result<Page, JsValue> {
    console_error_panic_hook::set_once();
    let (answers, inbox) = channel();
    let begun: Rc<RefCell<Option<(Context, Rc<RefCell<AppState>>)>>> = Rc::default();
    let beginning = Rc::clone(&begun);
    let options = eframe::WebOptions { dithering: false, ..eframe::WebOptions::default() };
    let make = move |creation: &eframe::CreationContext<'_>| {
        if let Some(target) = &creation.wgpu_render_state {
            let format = target.target_format;
            browser::prepare(&mut target.renderer.write().callback_resources, format);
        }
        let live = Live::remote(Box::new(slump_ask), inbox);
        let context = creation.egui_ctx.clone();
        let state = browser::begin(live, &stored, &address, &context);
        let state = Rc::new(RefCell::new(state));
        *beginning.borrow_mut() = Some((context.clone(), Rc::clone(&state)));
        let app: Box<dyn eframe::App> =
            Box::new(Laboratory { state, context, dropped: Dropped::default() });
        Ok(app)
    };
    eframe::WebRunner::new().start(canvas, options, Box::new(make)).await?;
    let (context, state) = begun.take().ok_or("the browser has not begun to draw")?;
    Ok(Page { answers, context, state })
}

struct Laboratory {
    state: Rc<RefCell<AppState>>,
    context: Context,
    dropped: Dropped,
}

impl Laboratory {
    /// Begins to read the files that were dropped in this frame, and opens the files that have been read.
    fn take_dropped_files(&mut self, context: &Context) {
        for file in context.input(|input| input.raw.dropped_files.clone()) {
            let (dropped, context) = (Rc::clone(&self.dropped), context.clone());
            wasm_bindgen_futures::spawn_local(async move {
                if let Ok(bytes) = file.bytes_async().await {
                    dropped.borrow_mut().push((file.path().to_owned(), bytes));
                    context.request_repaint();
                }
            });
        }
        for (path, bytes) in self.dropped.take() {
            browser::open_file(&mut self.state.borrow_mut(), path, bytes);
        }
    }
}

impl eframe::App for Laboratory {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        self.take_dropped_files(&context);
        slump::app::ui(ui, &mut self.state.borrow_mut());
        for (path, bytes) in browser::written_files() {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            slump_save(&name, bytes);
        }
    }

    fn save(&mut self, _: &mut dyn eframe::Storage) {
        slump_store(&browser::stored(&self.state.borrow().preferences, &self.context));
    }

    fn auto_save_interval(&self) -> std::time::Duration {
        std::time::Duration::from_secs(5)
    }

    fn persist_egui_memory(&self) -> bool {
        false
    }
}
