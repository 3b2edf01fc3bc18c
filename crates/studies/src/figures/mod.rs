//! Every figure of the paper and those that its conclusion asks for, from simulation alone, and a
//! report of what holds. One file a figure, listed in `registry`.

mod agreement;
mod chance;
mod choices;
mod cohesion;
mod cradle_choices;
mod cradle_map;
mod dry;
mod fig2;
mod fig5a;
mod fig5b;
mod fig6;
mod fig8;
mod fig8_courses;
mod figure;
mod friction;
mod paired;
mod pile_choices;
mod pile_map;
mod pile_series;
mod pile_tests;
mod range;
mod range_regimes;
mod registry;
pub mod reproduce;
mod table;
mod tolerance;
mod two_body;
mod verdict;
mod workshop;

pub use reproduce::figure_names;
pub use reproduce::reproduce;
pub(super) use table::Table;

use figure::Figure;
use verdict::Claim;
use workshop::Workshop;
