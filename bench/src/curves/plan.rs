//! Which points a curve has.

use clap::ValueEnum;

/// What is varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Quantity {
    /// Triangles: the dragons, coarse to fine
    Triangles,
    /// Receivers: the size of the image
    Receivers,
    /// The light's size: 1 to 5 of the paper's units
    Light,
    /// Samples: rows and columns together
    Samples,
    /// Rows of samples, of 32 columns each
    Rows,
}

impl Quantity {
    /// Name of its files, and in tables.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Triangles => "triangles",
            Self::Receivers => "receivers",
            Self::Light => "light",
            Self::Samples => "samples",
            Self::Rows => "rows",
        }
    }

    /// What its plot is titled.
    pub(super) fn title(self) -> &'static str {
        match self {
            Self::Triangles => "triangles",
            Self::Receivers => "receivers",
            Self::Light => "the light's size",
            Self::Samples => "light samples",
            Self::Rows => "rows of light samples, 32 columns",
        }
    }

    /// A point's label, with the unit.
    pub(super) fn spelled_out(self, label: &str) -> String {
        match self {
            Self::Triangles => label.to_owned(),
            Self::Receivers => format!("{label}² pixels"),
            Self::Light => format!("a light of {label}/58"),
            Self::Samples => format!("{label}² samples"),
            Self::Rows => format!("{label} rows"),
        }
    }

    /// Title of its axis, with the unit.
    pub(super) fn axis(self) -> &'static str {
        match self {
            Self::Triangles => "triangles of the scene",
            Self::Receivers => "receivers (pixels that see a surface)",
            Self::Light => "diagonal of the light (58ths of the scene's)",
            Self::Samples => "light samples (rows × columns)",
            Self::Rows => "rows of light samples",
        }
    }
}

/// One point: everything that can be varied.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Setting {
    /// How it is called in tables and on the command line.
    pub(super) label: String,
    /// Name of the scene.
    pub(super) scene: String,
    /// Edge of the image, pixels.
    pub(super) size: u32,
    /// The diagonal of the light in the paper's units.
    pub(super) light: f64,
    /// Rows of samples.
    pub(super) rows: u32,
    /// Columns of samples.
    pub(super) columns: u32,
}

/// The points of a curve, which differ from `base` in what is varied.
pub(super) fn settings(quantity: Quantity, base: &Setting) -> Vec<Setting> {
    let each = |change: fn(&mut Setting, u32), values: &[u32]| -> Vec<Setting> {
        let setting = |&value: &u32| {
            let mut setting = Setting { label: value.to_string(), ..base.clone() };
            change(&mut setting, value);
            setting
        };
        values.iter().map(setting).collect()
    };
    match quantity {
        Quantity::Triangles => ["dragon11k", "dragon48k", "dragon203k", "dragon871k"]
            .map(|name| Setting { label: name.to_owned(), scene: name.to_owned(), ..base.clone() })
            .to_vec(),
        Quantity::Receivers => each(|setting, size| setting.size = size, &[64, 128, 256, 512, 1024]),
        Quantity::Light => each(|setting, light| setting.light = light.into(), &[1, 2, 3, 4, 5]),
        Quantity::Samples => each(|setting, edge| (setting.rows, setting.columns) = (edge, edge), &[8, 16, 32, 64]),
        Quantity::Rows => each(|setting, rows| (setting.rows, setting.columns) = (rows, 32), &[8, 16, 32, 64]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_differ_in_what_is_varied_alone() {
        let base =
            Setting { label: String::new(), scene: "sponza".to_owned(), size: 256, light: 2.5, rows: 24, columns: 24 };
        for quantity in Quantity::value_variants() {
            let settings = settings(*quantity, &base);
            assert!(settings.len() >= 4);
            for setting in settings {
                let Setting { scene, size, light, rows, columns, .. } = setting.clone();
                assert!(scene == base.scene || *quantity == Quantity::Triangles);
                assert!(size == base.size || *quantity == Quantity::Receivers);
                assert!(light == base.light || *quantity == Quantity::Light);
                assert!(rows == base.rows || matches!(quantity, Quantity::Samples | Quantity::Rows));
                assert!(columns == base.columns || matches!(quantity, Quantity::Samples | Quantity::Rows));
                assert!(!setting.label.is_empty());
            }
        }
    }
}
