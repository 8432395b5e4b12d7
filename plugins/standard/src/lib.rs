//! The plugins that Storegga ships.

use bevy_app::{PluginGroup, PluginGroupBuilder};
use storegga::app::PaperPlugins;
use storegga_flow::FlowPlugin;
use storegga_soils::SoilsPlugin;

/// Everything that the program `storegga` knows: the paper's physics and the plugins shipped beside it.
#[derive(Debug, Clone, Copy, Default)]
pub struct StandardPlugins;

impl PluginGroup for StandardPlugins {
    fn build(self) -> PluginGroupBuilder {
        PluginGroupBuilder::start::<Self>().add_group(PaperPlugins).add(FlowPlugin).add(SoilsPlugin)
    }
}
