//! The program `storegga`.

use std::process::ExitCode;

use storegga_standard::StandardPlugins;

fn main() -> ExitCode {
    storegga::cli::main(|| StandardPlugins)
}
