//! Every figure of the paper and those that its conclusion asks for, from simulation alone, and a
//! report of what holds. One file a figure, listed in `registry`.

mod agreement;
mod cohesion;
mod cradle_map;
mod fig2;
mod fig5;
mod fig6;
mod fig8;
mod figure;
mod friction;
mod paired;
mod pile_map;
mod pile_series;
mod range;
mod registry;
mod reproduce;
mod table;
mod tolerance;
mod two_body;
mod verdict;
mod workshop;

pub(crate) use reproduce::{figure_names, reproduce};

use figure::Figure;
use verdict::Claim;
use workshop::Workshop;
