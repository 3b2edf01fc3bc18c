//! How steps by size are drawn and told.

use super::*;

impl StepsBySize {
    /// Draws what the variants came to: a panel a goal, a curve a variant.
    pub(super) fn sheet(&self, bench: &Bench) -> Sheet {
        let all = 0..self.variants.len();
        let sized = || self.sizes.iter().flat_map(|size| all.clone().map(move |one| (size, one)));
        let gap = sized()
            .map(|(size, one)| size.summary(one, CERTIFIED).largest_gap)
            .fold(f64::NAN, f64::max);
        let mut panels =
            RESIDUALS.map(|goal| (format!("to a residual of {goal:e}"), goal, false)).to_vec();
        panels.push((format!("tresca to {CERTIFIED:e}, gap up to {gap:.1e}"), CERTIFIED, true));
        let mut charts = Vec::new();
        for (title, goal, of_models) in panels {
            let mut chart = self.axes(title, charts.is_empty());
            let is_in = |number: &usize| {
                let variant = &self.variants[*number];
                goals(variant).contains(&goal) && variant.is_of_model() == of_models
            };
            let in_panel: Vec<usize> = all.clone().filter(is_in).collect();
            for (place, &number) in in_panel.iter().enumerate() {
                let aside = RING * (place as f64 - 0.5 * (in_panel.len() as f64 - 1.0));
                chart.layers.extend(self.layers(number, goal, aside));
            }
            charts.push(chart);
        }
        let legend = Chart::legend_of(&mut charts, 0.6);
        charts.push(legend);
        let steps = self.sizes[0].summary(0, RESIDUALS[0]).steps;
        let state =
            if self.state == "rest" { "at rest in its box" } else { "that begins to slump" };
        let bonds = BONDS.map(|bond| bond.to_string()).join(" and ");
        let units = listed(&self.sizes, |size| format!("{:.2}", size.unit_ms()));
        let caption = bench.caption(&[
            &format!(
                "Median over {steps} steps of a pile {state}, Bond {bonds}, Δt = 1e-3 s, warm start; in times of a step of {UNIT_SWEEPS} sweeps of nsgs, beside which each was measured ({units} ms)."
            ),
            &format!(
                "Above the upper line: half of the steps or more do not get there within {} times. Shares: steps that reach the last goal of each, size by size.",
                self.limit
            ),
        ]);
        Sheet { size: (2400, 940), charts, caption }.high_enough()
    }

    pub(super) fn axes(&self, title: String, is_first: bool) -> Chart {
        let grains = || self.sizes.iter().map(|size| size.grains as f64);
        let from = grains().fold(f64::INFINITY, f64::min) / MARGIN;
        let to = grains().fold(0.0, f64::max) * MARGIN;
        let label = if is_first { "time of a step (40 sweeps = 1)" } else { "" };
        let mut x = Axis::log("grains", from, to);
        x.ticks = grains().map(|grains| (grains, grains.to_string())).collect();
        let mut chart = Chart::new(title, x, Axis::log(label, LEAST, GIVEN_UP[1] * self.limit));
        for (name, height, look) in [
            ("40 sweeps of nsgs", 1.0, Look::Line(2)),
            ("the most that is given", self.limit, Look::Dashes(2)),
        ] {
            let line = points([from, to].map(|x| (x, height)));
            chart.layers.push(Layer::curve(name, line, GREY, look));
        }
        chart
    }

    /// A curve through the sizes at which a goal is reached, and rings above the limit where it is not.
    pub(super) fn layers(&self, number: usize, goal: f64, aside: f64) -> Vec<Layer> {
        let variant = &self.variants[number];
        let (mut reached, mut missed) = (Vec::new(), Vec::new());
        for size in &self.sizes {
            let grains = size.grains as f64;
            match size.summary(number, goal).median {
                Some(median) => reached.push((grains, median.max(LEAST))),
                None => missed.push((grains, GIVEN_UP[0] * self.limit)),
            }
        }
        let last = goals(variant).last().copied().unwrap_or(goal);
        let shares =
            listed(&self.sizes, |size| format!("{:.0}", 100.0 * size.summary(number, last).share));
        let name = format!("{}\nto {last:e}: {shares} %", variant.name);
        let mut layers = variant.marked_curve(name.clone(), reached);
        let name = format!("{name}, not reached");
        let rings = Layer::quiet(name, points(missed), variant.colour(), Look::Rings(6));
        layers.push(rings.aside(aside));
        layers
    }

    /// Markdown: how long a step of the unit takes, and what each variant comes to.
    pub(super) fn report(&self) -> String {
        let units = listed(&self.sizes, |size| {
            format!("{:.2} ms at {} grains", size.unit_ms(), size.grains)
        });
        let mut lines = vec![format!(
            "A step of {UNIT_SWEEPS} sweeps of nsgs takes {units}. A step is given up where it takes more than {} times \
             that. Medians over all steps; none where half of them or more do not reach the goal.\n\n\
             | grains | method | goal | steps that reach it | times {UNIT_SWEEPS} sweeps | ms | largest duality gap |\n\
             |---|---|---|---|---|---|---|",
            self.limit
        )];
        let cell =
            |number: Option<f64>| number.map_or("none".into(), |number| format!("{number:.2}"));
        for size in &self.sizes {
            for (number, variant) in self.variants.iter().enumerate() {
                for &goal in goals(variant) {
                    let summary = size.summary(number, goal);
                    let gap = Some(summary.largest_gap).filter(|gap| !gap.is_nan());
                    lines.push(format!(
                        "| {} | {} | {goal:e} | {:.0} % of {} | {} | {} | {} |",
                        size.grains,
                        variant.name,
                        100.0 * summary.share,
                        summary.steps,
                        cell(summary.median),
                        cell(summary.median_secs.map(|secs| 1e3 * secs)),
                        gap.map_or(String::new(), |gap| format!("{gap:.1e}"))
                    ));
                }
            }
        }
        lines.join("\n")
    }

    /// Every step as CSV, a row a variant and goal.
    pub(super) fn table(&self) -> String {
        let mut text = String::from(
            "problem,grains,contacts,method,goal,reached,step_secs,times_40_sweeps,solve_secs,left,duality_gap,\
             start,smallest,gave_up_secs\n",
        );
        for SizedSteps { grains, problems, times } in &self.sizes {
            for (variant, times) in self.variants.iter().zip(times) {
                for (problem, times) in problems.iter().zip(times) {
                    for &goal in goals(variant) {
                        let TimedSolves { contacts, start, smallest, gave_up_secs, .. } =
                            times.solves;
                        let reached = times.solves.reached(goal);
                        let step_secs = reached.map(|_| times.step_secs(goal));
                        text.push_str(&format!(
                            "\"{problem}\",{grains},{contacts},{},{goal:e},{},{},{},{},{},{},{start:e},{smallest:e},{}\n",
                            variant.name,
                            reached.is_some(),
                            csv_cell(step_secs),
                            csv_cell(step_secs.map(|secs| secs / times.unit_secs)),
                            csv_cell(reached.map(|reached| reached.solve_secs)),
                            csv_cell(reached.map(|reached| reached.left)),
                            csv_cell(reached.and_then(|reached| reached.duality_gap)),
                            csv_cell(gave_up_secs)
                        ));
                    }
                }
            }
        }
        text
    }
}
