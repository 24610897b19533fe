//! SVG elements, on a page or as files of their own.

/// Colours and lines of figures, for a light and for a dark ground.
pub(crate) const FIGURE_STYLE: &str = include_str!("style.css");

/// The SVG element of a figure of `elements` with its `size`, with a style of its own if it stands alone. `label` says what it
/// shows.
pub(crate) fn svg_element(label: &str, size: [f64; 2], elements: &str, stands_alone: bool) -> String {
    let (label, [width, height]) = (escaped(label), size);
    let (attributes, style) = if stands_alone {
        let attributes =
            format!(" xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\"");
        let ground = "<rect class=\"ground\" width=\"100%\" height=\"100%\"/>";
        (attributes, format!("<style>\n{FIGURE_STYLE}</style>\n{ground}\n"))
    } else {
        (String::new(), String::new())
    };
    format!(
        "<svg{attributes} class=\"figure\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{label}\">\n\
         {style}{elements}</svg>\n"
    )
}

/// `text` for HTML and SVG.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
