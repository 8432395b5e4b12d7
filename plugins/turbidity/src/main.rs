//! The program `storegga` with fine sediment: `turbidity run plume.ron`.

use std::process::ExitCode;

use bevy_app::PluginGroup;
use storegga_standard::StandardPlugins;
use turbidity::TurbidityPlugin;

fn main() -> ExitCode {
    storegga::cli::main(|| StandardPlugins.build().add(TurbidityPlugin))
}
