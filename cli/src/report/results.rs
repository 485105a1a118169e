//! What a report is about: every method's time, counts and errors.

use image::RgbImage;

use crate::report::{
    difference::Difference,
    methods::{Family, Run, UNIT},
    pareto,
};

/// A method that has been measured, or the reference.
pub struct Entry {
    /// Its name: unlike any other's.
    pub name: String,
    /// Its curve; the reference is on none.
    pub family: Option<Family>,
    /// Light samples a receiver, each way; of shadow maps, their texels.
    pub side: u32,
    /// Receivers that it ran on.
    pub receivers: usize,
    /// It ran on one tile of the picture in so many: of 1, on all.
    pub one_in: u32,
    /// The run that took the least time.
    pub run: Run,
    /// Its visibility against the reference's, over the receivers that it ran on.
    pub difference: Difference,
    /// Mean FLIP of its picture against the reference's, where enough of the picture is its own.
    pub flip: Option<f64>,
    /// Whether no method is as fast and as good, and better in one.
    pub on_front: bool,
    /// Its picture; faint where it did not run.
    pub shaded: RgbImage,
    /// Where it differs from the reference.
    pub map: RgbImage,
}

impl Entry {
    /// A name for files: lower case, without blanks.
    pub fn slug(&self) -> String {
        let words: String = self.name.chars().map(|c| if c == '×' { 'x' } else { c }).collect();
        let words = words.to_lowercase();
        words.split(|c: char| !c.is_ascii_alphanumeric()).filter(|w| !w.is_empty()).collect::<Vec<_>>().join("-")
    }

    /// Pairs tested, kept and relevant, a receiver; rays have none.
    pub fn pairs(&self) -> Option<[f64; 3]> {
        let counts = self.run.counts?;
        Some([counts.pairs_tested, counts.pairs_kept, counts.pairs_relevant].map(|n| n as f64 / self.receivers as f64))
    }

    /// Rays or light samples a receiver; maps have texels.
    pub fn samples(&self) -> Option<u32> {
        let is_map = self.family.is_some_and(Family::is_map);
        (!is_map).then_some(self.side * self.side)
    }
}

/// All that was measured.
pub struct Results {
    /// Every method, in the order of tables.
    pub methods: Vec<Entry>,
    /// What they are compared with.
    pub reference: Entry,
    /// Differences of visibility are shown so many times as large.
    pub gain: f64,
}

impl Results {
    /// Marks the Pareto front.
    pub fn new(mut methods: Vec<Entry>, reference: Entry, gain: f64) -> Self {
        let places: Vec<pareto::Place> = methods.iter().map(|m| (m.run.seconds(), m.difference.mean)).collect();
        for i in pareto::front(&places) {
            methods[i].on_front = true;
        }
        Self { methods, reference, gain }
    }

    /// Seconds that are 1 on relative axes.
    pub fn unit(&self) -> f64 {
        let unit = self.methods.iter().find(|m| (m.family, m.side) == (Some(UNIT.0), UNIT.1));
        unit.map_or(1.0, |m| m.run.seconds()).max(f64::MIN_POSITIVE)
    }

    /// The methods of a family, by rising number of samples.
    pub fn of(&self, family: Family) -> impl Iterator<Item = &Entry> {
        self.methods.iter().filter(move |m| m.family == Some(family))
    }

    /// The families that were measured.
    pub fn families(&self) -> impl Iterator<Item = Family> {
        Family::ALL.into_iter().filter(|&family| self.of(family).next().is_some())
    }

    /// The methods, and then the reference.
    pub fn all(&self) -> impl Iterator<Item = &Entry> {
        self.methods.iter().chain([&self.reference])
    }
}
