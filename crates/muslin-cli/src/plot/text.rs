//! Text of plots and tables.

/// Text as a field of comma-separated values.
pub(crate) fn csv_field(text: &str) -> String {
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// 10 with `exponent` as superscript.
pub(crate) fn power_of_ten(exponent: &str) -> String {
    const SUPERSCRIPTS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digits = exponent.chars().filter_map(|character| match character {
        '-' => Some('⁻'),
        digit => digit.to_digit(10).map(|digit| SUPERSCRIPTS[digit as usize]),
    });
    format!("10{}", digits.collect::<String>())
}
