//! Totals of a suite, printed when its last test is through. The number of tests is known, so that a test that failed,
//! or was filtered out, leaves the total unprinted.

use std::{
    collections::BTreeMap,
    io::{Write, stderr},
    sync::Mutex,
};

use crate::compare::Compared;

/// Writes a line past the test harness, which keeps what passing tests print to itself.
pub fn say(line: &str) {
    // A closed stderr is no reason to fail a test.
    let _ = writeln!(stderr(), "{line}");
}

#[derive(Debug)]
struct Totals {
    finished: usize,
    by_subject: BTreeMap<String, Compared>,
}

/// The totals of one suite.
#[derive(Debug)]
pub struct Ledger {
    tests: usize,
    least: u64,
    totals: Mutex<Totals>,
}

impl Ledger {
    /// The ledger of a suite of `tests` tests, which have to compare at least `least` bits together.
    pub fn new(tests: usize, least: u64) -> Self {
        Self { tests, least, totals: Mutex::new(Totals { finished: 0, by_subject: BTreeMap::new() }) }
    }

    /// Enters what one test compared and found equal. The last one prints the totals.
    ///
    /// # Panics
    /// When all tests are through and have compared fewer bits than they had to.
    pub fn enter(&self, subject: &str, compared: Compared) {
        let mut totals = self.totals.lock().expect("no test panics while it holds the ledger");
        totals.finished += 1;
        let entry = totals.by_subject.entry(subject.to_owned()).or_default();
        entry.bits += compared.bits;
        entry.blocked += compared.blocked;
        if totals.finished < self.tests {
            return;
        }
        let by_subject = totals.by_subject.clone();
        drop(totals);
        let bits: u64 = by_subject.values().map(|compared| compared.bits).sum();
        let blocked: u64 = by_subject.values().map(|compared| compared.blocked).sum();
        assert!(bits >= self.least, "only {bits} bits were compared, {} were asked for", self.least);
        for (subject, compared) in &by_subject {
            say(&format!("{subject}: bits compared: {}, differing: 0", compared.bits));
        }
        let share = 100.0 * blocked as f64 / bits.max(1) as f64;
        let tests = self.tests;
        say(&format!("bits compared: {bits}, differing: 0 ({tests} tests; {share:.1} % of the bits are blocked)"));
    }
}
