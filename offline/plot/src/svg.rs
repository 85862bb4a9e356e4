//! Writes SVG elements; plots are elsewhere.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use std::fmt::Write;

/// Sans-serif faces in the order in which systems have them.
const FACES: &str = "system-ui, 'Segoe UI', Roboto, Helvetica, Arial, 'DejaVu Sans', sans-serif";

/// A document that grows element by element.
#[derive(Debug, Default)]
pub struct Svg {
    body: String,
    clips: usize,
}

/// Alignment of text to its point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextStyle<'a> {
    /// `start`, `middle` or `end`.
    pub anchor: &'a str,
    /// Size in pixels.
    pub size: f64,
    /// Colour.
    pub colour: &'a str,
    /// Heavy letters.
    pub bold: bool,
    /// Reads upwards.
    pub upwards: bool,
    /// A pale edge, so that it reads over anything.
    pub halo: bool,
}

impl Default for TextStyle<'_> {
    fn default() -> Self {
        Self { anchor: "start", size: 11.0, colour: "#333", bold: false, upwards: false, halo: false }
    }
}

impl Svg {
    /// A rectangle; an empty colour leaves out fill or stroke.
    pub fn rect(&mut self, [x, y, w, h]: [f64; 4], fill: &str, stroke: &str) {
        let _ = write!(
            self.body,
            r#"<rect x="{x:.2}" y="{y:.2}" width="{w:.2}" height="{h:.2}" fill="{}" stroke="{}"/>"#,
            none(fill),
            none(stroke)
        );
        self.body.push('\n');
    }

    /// A straight line.
    pub fn line(&mut self, from: [f64; 2], to: [f64; 2], colour: &str, width: f64) {
        let _ = writeln!(
            self.body,
            r#"<path d="M{:.2} {:.2}L{:.2} {:.2}" stroke="{colour}" stroke-width="{width}" fill="none"/>"#,
            from[0], from[1], to[0], to[1]
        );
    }

    /// Many vertical lines of one colour in one element.
    pub fn verticals(&mut self, lines: &[(f64, f64, f64)], colour: &str, width: f64, opacity: f64) {
        if lines.is_empty() {
            return;
        }
        let mut path = String::with_capacity(lines.len() * 24);
        for (x, from, to) in lines {
            let _ = write!(path, "M{x:.1} {from:.1}V{to:.1}");
        }
        let _ = writeln!(
            self.body,
            r#"<path d="{path}" stroke="{colour}" stroke-width="{width}" stroke-opacity="{opacity}" fill="none"/>"#
        );
    }

    /// A polyline.
    pub fn polyline(&mut self, points: &[[f64; 2]], colour: &str, width: f64, dashed: bool) {
        if let [only] = points {
            self.circle(*only, width, colour);
            return;
        }
        let path = path(points);
        let dashes = if dashed { r#" stroke-dasharray="5 4""# } else { "" };
        let _ = writeln!(
            self.body,
            r#"<path d="{path}" stroke="{colour}" stroke-width="{width}" fill="none" stroke-linejoin="round"{dashes}/>"#
        );
    }

    /// The area between a polyline and a horizontal.
    pub fn area(&mut self, points: &[[f64; 2]], bottom: f64, fill: &str) {
        if let (Some(first), Some(last)) = (points.first(), points.last()) {
            let path = path(points);
            let _ = writeln!(
                self.body,
                r#"<path d="{path}L{:.1} {bottom:.1}L{:.1} {bottom:.1}Z" fill="{fill}" stroke="none"/>"#,
                last[0], first[0]
            );
        }
    }

    /// A dot.
    pub fn circle(&mut self, [x, y]: [f64; 2], radius: f64, fill: &str) {
        let _ = writeln!(
            self.body,
            r##"<circle cx="{x:.1}" cy="{y:.1}" r="{radius:.1}" fill="{fill}" fill-opacity="0.85" stroke="#fff" stroke-width="0.6"/>"##
        );
    }

    /// Words.
    pub fn text(&mut self, [x, y]: [f64; 2], style: TextStyle<'_>, words: &str) {
        let weight = if style.bold { r#" font-weight="600""# } else { "" };
        let turn =
            if style.upwards { format!(r#" transform="rotate(-90 {x:.1} {y:.1})""#) } else { String::new() };
        let halo = if style.halo {
            r##" stroke="#fff" stroke-width="3" stroke-opacity="0.85" stroke-linejoin="round" paint-order="stroke""##
        } else {
            ""
        };
        let _ = writeln!(
            self.body,
            r#"<text x="{x:.1}" y="{y:.1}" text-anchor="{}" font-size="{}" fill="{}"{weight}{turn}{halo}>{}</text>"#,
            style.anchor,
            style.size,
            style.colour,
            escape(words)
        );
    }

    /// A PNG stretched over a rectangle.
    pub fn png(&mut self, [x, y, w, h]: [f64; 4], png: &[u8], smooth: bool) {
        let rendering = if smooth { "auto" } else { "pixelated" };
        let _ = write!(
            self.body,
            r#"<image x="{x:.2}" y="{y:.2}" width="{w:.2}" height="{h:.2}" preserveAspectRatio="none" style="image-rendering:{rendering}" href="data:image/png;base64,"#,
        );
        STANDARD.encode_string(png, &mut self.body);
        self.body.push_str("\"/>\n");
    }

    /// Draws only inside a rectangle until [`Self::end_clip`].
    pub fn clip(&mut self, [x, y, w, h]: [f64; 4]) {
        self.clips += 1;
        let id = self.clips;
        let _ = writeln!(
            self.body,
            r#"<clipPath id="c{id}"><rect x="{x:.2}" y="{y:.2}" width="{w:.2}" height="{h:.2}"/></clipPath><g clip-path="url(#c{id})">"#
        );
    }

    /// Ends [`Self::clip`].
    pub fn end_clip(&mut self) {
        self.body.push_str("</g>\n");
    }

    /// The whole document.
    pub fn finish(self, width: f64, height: f64, title: &str) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"{FACES}\">\n<title>{}</title>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{}</svg>\n",
            escape(title),
            self.body
        )
    }
}

fn none(colour: &str) -> &str {
    if colour.is_empty() { "none" } else { colour }
}

/// Path data with a tenth of a pixel.
fn path(points: &[[f64; 2]]) -> String {
    let mut path = String::with_capacity(points.len() * 12);
    for (index, [x, y]) in points.iter().enumerate() {
        let _ = write!(path, "{}{x:.1} {:.1}", if index == 0 { 'M' } else { 'L' }, y.clamp(-1e5, 1e5));
    }
    path
}

/// Text as XML allows it.
fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_from_outside_cannot_break_the_document() {
        let mut svg = Svg::default();
        svg.text([0.0, 0.0], TextStyle::default(), "a<b>&\"\u{1}\n");
        assert!(svg.finish(10.0, 10.0, "</title>").contains("a&lt;b&gt;&amp;&quot;  </text>"));
    }
}
