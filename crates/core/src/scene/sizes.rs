//! Distributions of the diameters of a new pile.

use std::fmt;
use std::str::FromStr;

use rand::RngExt;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

/// Number of standard deviations from the mean at which normal and log-normal distributions of diameters are cut off.
/// With a larger number, a few very large grains would determine the width of the lattice on which the grains are
/// placed before they fall (method rain).
const CUT: f64 = 2.5;
/// Description of the allowed forms of a distribution of diameters, for error messages.
const FORM: &str = "uniform:S (0 ≤ S ≤ 0.8), normal:S (0 < S ≤ 0.3), lognormal:S (0 < S ≤ 0.5), \
    bidisperse:RATIO,FRACTION (1 < RATIO ≤ 5, 0 < FRACTION < 1) or sieves:DIAMETER=FRACTION,… (2 to 50 sieves; \
    diameters > 0 that rise by at most a factor 20, mass fractions that rise from 0 to 1)";

/// Distribution of the diameters of a new pile. Diameters are scaled so that their mean is the mean diameter d of the
/// scene. A distribution is created from text such as `lognormal:0.2`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Sizes {
    kind: Kind,
    text: String,
}

#[derive(Clone, Debug, PartialEq)]
enum Kind {
    /// Uniform distribution from d·(1 − s) to d·(1 + s), with the mean diameter d of the scene. The number is s,
    /// dimensionless.
    Uniform(f64),
    /// Normal distribution. The number is the standard deviation in mean diameters, before the tails are cut off.
    Normal(f64),
    /// Log-normal distribution. The number is the standard deviation of the logarithm, before the tails are cut off.
    LogNormal(f64),
    /// Two diameters. The numbers are the ratio of the large to the small diameter, and the fraction of the grains
    /// that are large, by number.
    Bidisperse(f64, f64),
    /// Sieve curve: for each sieve the diameter of its openings, in any unit, and the mass fraction of the grains
    /// that pass. Between two sieves the passing mass is linear in the diameter D. The mass of a disc is proportional
    /// to its area, so the number of grains per diameter is proportional to 1/D².
    Sieves(Vec<[f64; 2]>),
}

impl Default for Sizes {
    /// Returns the distribution of the diameters in the pile that is shipped with Slump.
    fn default() -> Self {
        Self { kind: Kind::Uniform(0.2), text: "uniform:0.2".into() }
    }
}

impl Sizes {
    /// Returns the largest diameter that the distribution can give, in mean diameters.
    pub(super) fn largest(&self) -> f64 {
        let largest = match &self.kind {
            Kind::Uniform(spread) => 1.0 + spread,
            Kind::Normal(deviation) => 1.0 + CUT * deviation,
            Kind::LogNormal(deviation) => libm::exp(CUT * deviation),
            Kind::Bidisperse(ratio, _) => *ratio,
            Kind::Sieves(sieves) => sieves[sieves.len() - 1][0],
        };
        largest / self.mean()
    }

    /// Draws a random diameter from the distribution, in mean diameters.
    pub(super) fn draw(&self, random: &mut Pcg64) -> f64 {
        let diameter = match &self.kind {
            Kind::Uniform(spread) => random.random_range(1.0 - spread..=1.0 + spread),
            Kind::Normal(deviation) => 1.0 + deviation * cut_normal(random),
            Kind::LogNormal(deviation) => libm::exp(deviation * cut_normal(random)),
            Kind::Bidisperse(_, large) if random.random_range(0.0..1.0) >= *large => 1.0,
            Kind::Bidisperse(ratio, _) => *ratio,
            Kind::Sieves(sieves) => {
                let mut rank = random.random_range(0.0..count(sieves));
                let is_in = |class: &&[[f64; 2]]| {
                    rank -= count(class);
                    rank < 0.0
                };
                // If rounding leads beyond the last class, take the largest diameter.
                let class = sieves.windows(2).find(is_in);
                // Within a class (between two sieves), 1/D is distributed uniformly.
                class.map_or(sieves[sieves.len() - 1][0], |class| {
                    let [fine, coarse] = [class[0][0], class[1][0]];
                    1.0 / (1.0 / coarse - (1.0 / fine - 1.0 / coarse) * rank / count(class))
                })
            }
        };
        diameter / self.mean()
    }

    /// Returns the mean of the diameters before they are scaled to the mean diameter of the scene: in units of the
    /// smaller diameter if there are two diameters, in the unit of the openings if the distribution is given by sieves,
    /// and otherwise in units of the median diameter.
    fn mean(&self) -> f64 {
        match &self.kind {
            Kind::Uniform(_) | Kind::Normal(_) => 1.0,
            Kind::LogNormal(deviation) => {
                let erf = |bound: f64| libm::erf(bound * std::f64::consts::FRAC_1_SQRT_2);
                let kept = (erf(CUT - deviation) + erf(CUT + deviation)) / (2.0 * erf(CUT));
                libm::exp(0.5 * deviation * deviation) * kept
            }
            Kind::Bidisperse(ratio, large) => 1.0 + large * (ratio - 1.0),
            Kind::Sieves(sieves) => {
                let length = |class: &[[f64; 2]]| {
                    let [[fine, passes], [coarse, more]] = [class[0], class[1]];
                    (more - passes) / (coarse - fine) * libm::log(coarse / fine)
                };
                sieves.windows(2).map(length).sum::<f64>() / count(sieves)
            }
        }
    }
}

/// Returns a random number of the standard normal distribution between −[`CUT`] and +[`CUT`], by rejection sampling.
fn cut_normal(random: &mut Pcg64) -> f64 {
    loop {
        let number = random.random_range(-CUT..=CUT);
        if random.random_range(0.0..1.0) < libm::exp(-0.5 * number * number) {
            return number;
        }
    }
}

/// Returns the number of grains with diameters between the first and the last sieve, ∫ dM/D², in a sample of unit mass.
/// M is the mass fraction that passes a sieve with openings of diameter D. The unit of mass is the mass of a disc whose
/// diameter is 1 in the unit of D.
fn count(sieves: &[[f64; 2]]) -> f64 {
    let count = |class: &[[f64; 2]]| (class[1][1] - class[0][1]) / (class[0][0] * class[1][0]);
    sieves.windows(2).map(count).sum()
}

impl fmt::Display for Sizes {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.text)
    }
}

impl FromStr for Sizes {
    /// Error type: a description of the allowed forms of a distribution of diameters, if the text has none of these
    /// forms.
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, &'static str> {
        let kind = kind_of(text).ok_or(FORM)?;
        Ok(Self { kind, text: text.to_owned() })
    }
}

fn kind_of(text: &str) -> Option<Kind> {
    let number = |text: &str| text.parse::<f64>().ok();
    let (name, rest) = text.split_once(':')?;
    let positive = |most: f64| number(rest).filter(|it| *it > 0.0 && *it <= most);
    match name {
        "uniform" => number(rest).filter(|it| (0.0..=0.8).contains(it)).map(Kind::Uniform),
        "normal" => positive(0.3).map(Kind::Normal),
        "lognormal" => positive(0.5).map(Kind::LogNormal),
        "bidisperse" => {
            let (ratio, large) = rest.split_once(',')?;
            let (ratio, large) = (number(ratio)?, number(large)?);
            let is_sound = ratio > 1.0 && ratio <= 5.0 && large > 0.0 && large < 1.0;
            is_sound.then_some(Kind::Bidisperse(ratio, large))
        }
        "sieves" => {
            let sieve = |row: &str| {
                let (diameter, passes) = row.split_once('=')?;
                Some([number(diameter)?, number(passes)?])
            };
            let sieves = rest.split(',').map(sieve).collect::<Option<Vec<_>>>()?;
            let ([least, none], [most, all]) = (sieves[0], sieves[sieves.len() - 1]);
            let rises =
                |class: &[[f64; 2]]| class[0][0] < class[1][0] && class[0][1] <= class[1][1];
            let is_sound = (2..=50).contains(&sieves.len()) && sieves.windows(2).all(rises);
            let is_whole = least > 0.0 && most <= 20.0 * least && none == 0.0 && all == 1.0;
            (is_sound && is_whole).then_some(Kind::Sieves(sieves))
        }
        _ => None,
    }
}

impl TryFrom<String> for Sizes {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse().map_err(|allowed| format!("sizes is {text}, expected {allowed}"))
    }
}

impl From<Sizes> for String {
    fn from(sizes: Sizes) -> Self {
        sizes.text
    }
}
