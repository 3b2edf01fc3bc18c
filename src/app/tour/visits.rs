//! Going from station to station.

use super::progress::{Choices, Tour};
use super::station::Station;
use super::stations::STATIONS;
use crate::app::loader::loader_of_station;
use crate::app::preferences::Preferences;
use crate::app::state::AppState;
use crate::live::Command;

impl AppState {
    /// Goes to a station of the tour.
    pub fn visit(&mut self, at: usize) {
        let station = self.preferences.visit(at);
        self.touring = true;
        self.opened_panel = station.panel;
        self.live.send(Command::SetPace(self.preferences.pace()));
        let loader = loader_of_station(station, self.last_opened.clone());
        self.live.send(Command::Load(loader));
    }

    /// Ends the tour, with the worlds as they are.
    pub(crate) fn leave_tour(&mut self) {
        if std::mem::take(&mut self.touring) {
            self.preferences.put_tour_away();
            self.preferences.tour.on = false;
            self.live.send(Command::SetPace(self.preferences.pace()));
        }
    }
}

impl Preferences {
    /// Goes to a station of the tour, or to the last where there are not so many, and makes its choices.
    pub(in crate::app) fn visit(&mut self, at: usize) -> &'static Station {
        let at = at.min(STATIONS.len() - 1);
        let station = &STATIONS[at];
        let choices = Choices {
            quantities: std::mem::replace(
                &mut self.quantities,
                station.plots.iter().map(|name| (*name).to_owned()).collect(),
            ),
            speed: std::mem::replace(&mut self.speed, station.speed),
            full_speed: std::mem::replace(&mut self.full_speed, false),
        };
        let before = self.tour.before.take().unwrap_or(choices);
        self.tour = Tour { at, on: true, before: Some(before) };
        station
    }

    /// Brings back what was chosen before the tour.
    pub(in crate::app) fn put_tour_away(&mut self) {
        if let Some(Choices { quantities, speed, full_speed }) = self.tour.before.take() {
            (self.quantities, self.speed, self.full_speed) = (quantities, speed, full_speed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_chosen_before_the_tour_comes_back_after_it() {
        let chosen = Preferences {
            quantities: vec!["energy".into()],
            speed: 3.0,
            full_speed: true,
            ..Preferences::default()
        };
        let mut preferences = chosen.clone();
        assert_eq!(preferences.visit(0).title, STATIONS[0].title);
        assert_eq!(preferences.visit(99).title, STATIONS[STATIONS.len() - 1].title);
        assert_ne!(preferences.quantities, chosen.quantities);
        preferences.put_tour_away();
        let tour = Tour { at: STATIONS.len() - 1, on: true, before: None };
        assert_eq!(preferences, Preferences { tour, ..chosen });
    }
}
