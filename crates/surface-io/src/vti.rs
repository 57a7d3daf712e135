//! VTI, the XML file of image data of VTK, for ParaView.
//!
//! After "VTK File Formats" (docs.vtk.org) and, where it is silent, vtkXMLWriter: an array in the appended section is its length in bytes as `UInt64` followed by
//! its numbers, both in one run of base64; offsets count characters of base64 after the underscore.

use crate::error::Problem;
use crate::write::Lines;

/// Numbers on the cells of a square.
#[derive(Debug, Clone, Copy)]
pub struct Field<'a> {
    /// Name, such as `pressure`.
    pub name: &'a str,
    /// Unit, such as `Pa`; it is written behind the name. Empty or `none` for none.
    pub unit: &'a str,
    /// Values, row-major, finite.
    pub values: &'a [f64],
}

/// How numbers are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    /// Base64 in one section at the end: little-endian float64.
    Base64,
    /// Decimals, exact too, about twice as long.
    Ascii,
}

/// The bytes of a VTI file: fields as data of `cells` x `cells` square cells in the plane z = 0, the first corner at the origin.
///
/// Row 0 is at y = 0. In ParaView, "Cell Data to Point Data" goes before "Warp By Scalar".
///
/// # Errors
/// [`Problem::Said`] for a field of another size, no cells, a cell that is not positive; [`Problem::NotFinite`] for a field with a NaN or an infinity: viewers
/// take them for data.
///
/// ```
/// use surface_io::{Encoding, Field, vti};
/// let field = Field { name: "height", unit: "m", values: &[0.0, 1.0, 2.0, 3.0] };
/// let file = String::from_utf8(vti(2, 0.5, &[field], Encoding::Ascii)?)?;
/// assert!(file.contains("WholeExtent=\"0 2 0 2 0 0\" Origin=\"0 0 0\" Spacing=\"0.5 0.5 0.5\""));
/// assert!(file.contains("<DataArray type=\"Float64\" Name=\"height [m]\" format=\"ascii\">\n0 1\n2 3\n</DataArray>"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn vti(cells: usize, cell: f64, fields: &[Field<'_>], encoding: Encoding) -> Result<Vec<u8>, Problem> {
    if !(cell.is_finite() && cell > 0.0) {
        return Err(Problem::Said { what: "cell", value: cell, expected: "a finite number > 0" });
    }
    if cells == 0 {
        return Err(Problem::Empty);
    }
    for field in fields {
        if cells.checked_mul(cells) != Some(field.values.len()) {
            let value = field.values.len() as f64;
            return Err(Problem::Said {
                what: "number of values of a field",
                value,
                expected: "cells x cells",
            });
        }
        if let Some(at) = field.values.iter().position(|v| !v.is_finite()) {
            return Err(Problem::NotFinite { field: field.name.to_owned(), at, value: field.values[at] });
        }
    }
    let active = fields.first().map_or(String::new(), |f| format!(" Scalars=\"{}\"", title(f)));
    let extent = format!("0 {cells} 0 {cells} 0 0");
    let head = format!(
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
         <ImageData WholeExtent=\"{extent}\" Origin=\"0 0 0\" Spacing=\"{cell} {cell} {cell}\">\n\
         <Piece Extent=\"{extent}\">\n<PointData></PointData>\n<CellData{active}>\n"
    );
    let per_field = 24 * cells * cells + 200;
    let mut file = Lines::new(head, fields.len() * per_field + 200);
    let run = 4 * (8 + 8 * cells * cells).div_ceil(3);
    for (k, field) in fields.iter().enumerate() {
        let title = title(field);
        file.add(format_args!("<DataArray type=\"Float64\" Name=\"{title}\" format="));
        match encoding {
            Encoding::Base64 => file.add(format_args!("\"appended\" offset=\"{}\"/>\n", k * run)),
            Encoding::Ascii => {
                file.add(format_args!("\"ascii\">\n"));
                for row in field.values.chunks_exact(cells) {
                    for (i, v) in row.iter().enumerate() {
                        let end = if i + 1 == cells { '\n' } else { ' ' };
                        if v.abs() >= 1e-4 && v.abs() < 1e6 || v.abs() <= 0.0 {
                            file.add(format_args!("{v}{end}"));
                        } else {
                            file.add(format_args!("{v:e}{end}"));
                        }
                    }
                }
                file.add(format_args!("</DataArray>\n"));
            }
        }
    }
    file.add(format_args!("</CellData>\n</Piece>\n</ImageData>\n"));
    if encoding == Encoding::Base64 && !fields.is_empty() {
        file.add(format_args!("<AppendedData encoding=\"base64\">\n_"));
        for field in fields {
            let mut base64 = Base64::new(&mut file.text);
            base64.add((8 * field.values.len() as u64).to_le_bytes());
            for value in field.values {
                base64.add(value.to_le_bytes());
            }
            base64.finish();
        }
        file.add(format_args!("\n</AppendedData>\n"));
    }
    file.add(format_args!("</VTKFile>\n"));
    Ok(file.text.into_bytes())
}

/// Name and unit, safe in an attribute.
fn title(field: &Field<'_>) -> String {
    let unit = if matches!(field.unit, "" | "none") { String::new() } else { format!(" [{}]", field.unit) };
    let mut safe = String::new();
    for c in field.name.chars().chain(unit.chars()) {
        match c {
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '&' => safe.push_str("&amp;"),
            '"' => safe.push_str("&quot;"),
            // XML has no control characters.
            c if c.is_control() => safe.push(' '),
            c => safe.push(c),
        }
    }
    safe
}

/// Base64 (RFC 4648) of a run of bytes.
struct Base64<'a> {
    text: &'a mut String,
    held: [u8; 3],
    count: usize,
}

impl<'a> Base64<'a> {
    fn new(text: &'a mut String) -> Self {
        Self { text, held: [0; 3], count: 0 }
    }

    fn add(&mut self, bytes: impl IntoIterator<Item = u8>) {
        for byte in bytes {
            self.held[self.count] = byte;
            self.count += 1;
            if self.count == 3 {
                self.flush();
            }
        }
    }

    fn flush(&mut self) {
        const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        let word = self.held.iter().fold(0_u32, |word, byte| (word << 8) | u32::from(*byte));
        for i in 0..4 {
            let letter = if i <= self.count { LETTERS[(word >> (18 - 6 * i)) as usize & 63] } else { b'=' };
            self.text.push(char::from(letter));
        }
        self.held = [0; 3];
        self.count = 0;
    }

    fn finish(&mut self) {
        if self.count > 0 {
            self.flush();
        }
    }
}

#[cfg(test)]
mod tests;
