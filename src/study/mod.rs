//! Studies: a family of runs of one scene over values of its fields, and one table and figures of what came out.
//!
//! A [`Study`] is a file that names the scene, the values and the numbers that are wanted. A [`Plan`] is what follows from it:
//! every run, each of its scenes read and put into effect once, so that a mistake is told before the first run starts.
//! [`Left`] is what earlier starts left of a run. [`execute`] runs the others as processes of the same program, as many at once
//! as processors and memory allow; what they leave are logs, of which a [`Table`] is made.
//!
//! The logs are all that counts: whenever a study is stopped, the next start finds in them what is done.

mod beside;
mod child;
mod document;
mod execute;
mod figures;
mod left;
mod names;
mod pace;
mod plan;
mod record;
mod runs;
mod table;

pub use beside::Beside;
pub use child::Place;
pub use document::{FigureSpec, Measure, Scale, Study};
pub use execute::{Ended, Event, Limits, Task, execute};
pub use figures::{FigureFile, caption, figure_lines, run_name, write_figure, write_figures};
pub use left::{Finished, Left, look};
pub use pace::time_left;
pub use plan::{Drawn, Plan, PlannedRun, Source, Varied};
pub use record::Record;
pub use table::{Asked, Row, Table, escaped};
