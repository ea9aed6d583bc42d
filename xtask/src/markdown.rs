//! Tables as Markdown writes them, aligned so that a terminal shows them well too.

/// A table from its head and rows; cells after the first are aligned to the right.
pub(crate) fn table<const N: usize>(head: [&str; N], rows: &[[String; N]]) -> String {
    let head = head.map(str::to_owned);
    let length = |cell: &String| cell.chars().count();
    let width = |i: usize| rows.iter().chain([&head]).map(|row| length(&row[i])).max().unwrap_or(0).max(3);
    let line = |row: &[String; N]| {
        let cells = row.iter().enumerate().map(|(i, cell)| {
            let blank = " ".repeat(width(i) - length(cell));
            if i == 0 { format!(" {cell}{blank} ") } else { format!(" {blank}{cell} ") }
        });
        format!("|{}|\n", cells.collect::<Vec<_>>().join("|"))
    };
    let rule =
        |i: usize| if i == 0 { "-".repeat(width(i) + 2) } else { format!("{}:", "-".repeat(width(i) + 1)) };
    let rules = format!("|{}|\n", (0..N).map(rule).collect::<Vec<_>>().join("|"));
    line(&head) + &rules + &rows.iter().map(line).collect::<String>()
}

/// `value` with as many significant digits, never as a power of ten.
pub(crate) fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let decimals = digits - 1 - value.abs().log10().floor() as i32;
    let unit = 10.0_f64.powi(decimals);
    let rounded = if decimals < 0 { (value * unit).round() / unit } else { value };
    format!("{rounded:.*}", decimals.max(0) as usize)
}

/// `value` with its sign and a fixed number of decimals, without negative zeros.
pub(crate) fn signed(value: f64, decimals: i32) -> String {
    let unit = 10.0_f64.powi(decimals);
    let rounded = (value * unit).round() / unit + 0.0;
    format!("{rounded:+.*}", decimals.max(0) as usize).replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_significant() {
        assert_eq!(significant(6_716_633.8, 3), "6720000");
        assert_eq!(significant(0.315_3, 3), "0.315");
        assert_eq!(significant(22.805, 3), "22.8");
        assert_eq!(significant(-0.533_6, 2), "-0.53");
    }

    #[test]
    fn signs_are_printed_but_not_of_zero() {
        assert_eq!((signed(-0.004, 2), signed(-0.536, 2)), ("+0.00".to_owned(), "−0.54".to_owned()));
    }

    #[test]
    fn columns_are_aligned() {
        let rows = [["a".to_owned(), "1.25".to_owned()], ["long name".to_owned(), "3".to_owned()]];
        let table = table(["", "value"], &rows);
        assert_eq!(
            table,
            "|           | value |\n|-----------|------:|\n| a         |  1.25 |\n| long name |     3 |\n"
        );
    }
}
