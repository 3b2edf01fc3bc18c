//! Other piles go with the worlds of the window.

use crate::app::state::AppState;

impl AppState {
    /// Has the other piles follow the worlds that there are.
    pub(crate) fn follow_other_piles(&mut self, context: &egui::Context) {
        self.other_piles.look_up(self.last_opened.get());
        if !self.preferences.other_piles {
            self.other_piles.stop();
            return;
        }
        let worlds = self.frame.worlds.iter().map(|world| {
            let is_from_the_start = world.recorded_from_secs == 0.0;
            (world.is_even && is_from_the_start).then_some(world.controls.settings)
        });
        let worlds = worlds.collect();
        self.other_piles.follow(context, worlds, self.frame.number);
    }
}
