use std::process::ExitCode;

use clap::Parser;

#[derive(Parser)]
struct Cli {
    #[command(flatten)]
    config: slump::scene::Config,
    #[command(flatten)]
    window: slump::app::WindowOptions,
}

fn main() -> ExitCode {
    // SAFETY: no other thread runs yet.
    unsafe { slump::render::quieten_drivers() };
    let cli = Cli::parse();
    match slump::app::run(&cli.config, &cli.window) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("slump: {error}");
            ExitCode::FAILURE
        }
    }
}
