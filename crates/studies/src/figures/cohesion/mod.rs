//! Whether slump is a matter of Bond and of the work that it takes to break a bond: piles under `range`, whose
//! debonding distance sets that work, and under `dem`, whose stiffness does, at equal works from the same states.
//!
//! `moreau` knows no work of fracture: its contacts pull as long as they are found. Beside the others it is drawn
//! at the energy ½ m_ij (Bond g Δt)² of the fastest opening that one step stops, as a reference.

mod claims;
mod levels;

use self::claims::{bonds_agree, factor, laws_agree, table};
use self::levels::{Captured, Level, captured, levels};
use super::figure::slump_point;
use super::{Figure, Workshop};
use crate::chart::{Axis, Chart, Layer, Look, PALETTE, Point, Sheet, points};
use crate::error::Result;

pub(super) fn make(workshop: &Workshop) -> Result<Figure> {
    let rows = workshop.rows("cohesion")?;
    let levels = levels(&rows)?;
    let captured = captured(&rows)?;
    let bonds = rows.values(|config| config.parameters.bond);
    let mut charts: Vec<Chart> =
        bonds.iter().map(|&bond| of_bond(bond, &levels, &captured)).collect();
    charts.push(of_all(&bonds, &levels));
    let works = levels.iter().flat_map(|level| level.works);
    let all: Vec<f64> = works.chain(captured.iter().map(|one| one.energy)).collect();
    let ends = [f64::min, f64::max].map(|pick| all.iter().copied().fold(all[0], pick));
    for chart in &mut charts {
        (chart.x.from, chart.x.to) = (0.6 * ends[0], 1.6 * ends[1]);
    }
    let caption = vec![
        format!(
            "Means over {} initial states with 95 % intervals. W breaks the bond of two grains of the mean mass m \
             slowly: C₀δc under range, C₀²/2k under dem.",
            rows.seeds().len()
        ),
        "moreau has no work of fracture: it stands at the energy ½ m_ij (Bond g Δt)² of the fastest opening that a \
         step stops."
            .into(),
    ];
    let mut sheet = Sheet { size: (520 * charts.len() as u32, 620), charts, caption };
    sheet.caption.extend(workshop.note());
    let claims = vec![laws_agree(&levels), factor(&bonds, &levels), bonds_agree(&bonds, &levels)];
    Ok(Figure { name: "cohesion", sheet, claims, table: Some(table(&levels)) })
}

/// The curve of a law at a Bond: 0 is `range`, 1 `dem`.
fn curve(bond: f64, levels: &[Level<'_>], law: usize) -> Vec<Point> {
    let here = levels.iter().filter(|level| level.bond == bond);
    here.map(|level| slump_point(level.works[law], &level.slumps(law))).collect()
}

fn axes(title: String) -> Chart {
    let x = Axis::log("work of fracture W/(m g d)", 1e-3, 1.0);
    Chart::new(title, x, Axis::linear("slump Δy_G", 0.0, 0.7))
}

fn of_bond(bond: f64, levels: &[Level<'_>], captured: &[Captured]) -> Chart {
    let mut chart = axes(format!("Bond {bond}"));
    for (law, name) in [(0, "range"), (1, "dem")] {
        let points = curve(bond, levels, law);
        let layer = Layer::curve(name, points, PALETTE[1 + law], Look::LineAndDots);
        chart.layers.push(layer.beside(law, 3));
    }
    let here = captured.iter().filter(|one| one.bond == bond);
    let points = here.map(|one| slump_point(one.energy, &one.slumps)).collect();
    let layer = Layer::curve("moreau, by its Δt", points, PALETTE[0], Look::Rings(5));
    chart.layers.push(layer.beside(2, 3));
    chart
}

fn of_all(bonds: &[f64], levels: &[Level<'_>]) -> Chart {
    let mut chart = axes("Every Bond".into());
    for (index, &bond) in bonds.iter().enumerate() {
        let colour = PALETTE[1 + index % (PALETTE.len() - 1)];
        for (law, name, look) in [(0, "range", Look::LineAndDots), (1, "dem", Look::Rings(6))] {
            let name = format!("{name}, Bond {bond}");
            // The charts beside it have the intervals.
            let means = points(curve(bond, levels, law).iter().map(|point| (point.x, point.y)));
            chart.layers.push(Layer::curve(name, means, colour, look));
        }
    }
    chart
}
