//! Images of discs beyond periodic borders.

use super::site::Site;
use crate::world::Periodic;

/// Adds to sites those images of theirs whose cells may border on one in the cell of the borders.
pub(super) fn append(sites: &mut Vec<Site>, periodic: Option<Periodic>) {
    let Some(periodic) = periodic else { return };
    let reach = 2.0 * sites.iter().map(|site| site.reach).fold(0.0, f64::max);
    let images: Vec<Site> = sites
        .iter()
        .flat_map(|site| {
            let by = periodic.images([site.position - reach, site.position + reach]);
            by.map(|by| Site { position: site.position + by, ..*site })
        })
        .filter(|image| {
            let place = image.position;
            [(periodic.x, place.x), (periodic.y, place.y)].into_iter().all(|(borders, at)| {
                borders.is_none_or(|[low, high]| (low - reach..high + reach).contains(&at))
            })
        })
        .collect();
    sites.extend(images);
}

/// A site, and where borders are periodic its images a period to each side: what the walls are to each of them, they
/// and their images are to the site.
pub(super) fn of(site: &Site, periodic: Option<Periodic>) -> impl Iterator<Item = Site> {
    let site = *site;
    let around = periodic.unwrap_or_default().around();
    around.map(move |by| Site { position: site.position + by, ..site })
}
