//! Images of discs beyond periodic borders.

use glam::DVec2;

use super::site::Site;
use crate::world::Periodic;

/// Adds to sites those images of theirs whose cells may border on one in the cell of the borders.
pub(super) fn append(sites: &mut Vec<Site>, periodic: Option<Periodic>) {
    let Some(periodic) = periodic else { return };
    let reach = 2.0 * sites.iter().map(|site| site.reach).fold(0.0, f64::max);
    let [left, right] = periodic.x;
    let images: Vec<Site> = sites
        .iter()
        .flat_map(|site| {
            let by = periodic.images([site.position.x - reach, site.position.x + reach]);
            by.map(|by| Site { position: site.position + by, ..*site })
        })
        .filter(|image| (left - reach..right + reach).contains(&image.position.x))
        .collect();
    sites.extend(images);
}

/// A site, and where borders are periodic its images a period to either side: what the walls are to each of them, they
/// and their images are to the site.
pub(super) fn of(site: &Site, periodic: Option<Periodic>) -> impl Iterator<Item = Site> {
    let periods = periodic.map(|periodic| DVec2::new(periodic.width(), 0.0));
    let images = periods.into_iter().flat_map(|period| [period, -period]);
    let site = *site;
    std::iter::once(DVec2::ZERO)
        .chain(images)
        .map(move |by| Site { position: site.position + by, ..site })
}
