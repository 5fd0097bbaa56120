//! The one date in an archive: two builds of the same sources must give the same bytes.

use crate::Error;

/// Seconds since 1970-01-01T00:00:00Z, within what a zip entry can hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp(i64);

/// 1980-01-01T00:00:00Z, where zip dates begin.
const ZIP_EPOCH: i64 = 315_532_800;
/// 2108-01-01T00:00:00Z, where they end.
const ZIP_END: i64 = 4_354_819_200;

impl Default for Stamp {
    fn default() -> Self {
        Self(ZIP_EPOCH)
    }
}

impl Stamp {
    /// From the value of SOURCE_DATE_EPOCH, if it is set.
    pub fn parse(source_date_epoch: Option<&str>) -> Result<Self, Error> {
        let Some(text) = source_date_epoch else { return Ok(Self::default()) };
        let seconds = text.parse().ok().filter(|s| (ZIP_EPOCH..ZIP_END).contains(s));
        seconds.map(Self).ok_or_else(|| Error::Epoch(text.to_owned()))
    }

    /// (year, month, day, hour, minute, second) in UTC.
    fn civil(self) -> (i64, i64, i64, i64, i64, i64) {
        let (mut day, second) = (self.0.div_euclid(86_400), self.0.rem_euclid(86_400));
        let leap = |year: i64| year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
        let mut year = 1970;
        while day >= 365 + i64::from(leap(year)) {
            day -= 365 + i64::from(leap(year));
            year += 1;
        }
        let lengths = [31, 28 + i64::from(leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
        let mut month = 0;
        while day >= lengths[month] {
            day -= lengths[month];
            month += 1;
        }
        (year, month as i64 + 1, day + 1, second / 3600, second / 60 % 60, second % 60)
    }

    /// As `xs:dateTime`.
    pub fn iso(self) -> String {
        let (year, month, day, hour, minute, second) = self.civil();
        format!("{year}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
    }

    pub(crate) fn zip(self) -> zip::DateTime {
        let (year, month, day, hour, minute, second) = self.civil();
        let [month, day, hour, minute, second] =
            [month, day, hour, minute, second].map(|n| n as u8);
        // `parse` admits only what zip can hold, so the default is never taken.
        zip::DateTime::from_date_and_time(year as u16, month, day, hour, minute, second)
            .unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_dates() {
        assert_eq!(Stamp::default().iso(), "1980-01-01T00:00:00Z");
        // `date -u -d @951782399`: the second before a leap day.
        assert_eq!(Stamp(951_782_399).iso(), "2000-02-28T23:59:59Z");
        assert_eq!(Stamp(951_782_400).iso(), "2000-02-29T00:00:00Z");
        assert_eq!(Stamp(ZIP_END - 1).iso(), "2107-12-31T23:59:59Z");
        assert_eq!(Stamp(ZIP_END - 1).zip().year(), 2107);
    }

    #[test]
    fn nonsense_is_refused() {
        for text in ["", "now", "-1", "0", "4354819200"] {
            assert!(Stamp::parse(Some(text)).is_err(), "{text}");
        }
    }
}
