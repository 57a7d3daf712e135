//! VTI, the XML file of image data of VTK, for ParaView.
//!
//! After "VTK File Formats" (docs.vtk.org) and, where it is silent, vtkXMLWriter: an array in the appended
//! section is its length in bytes as `UInt64` followed by its numbers, both in one run of base64; offsets
//! count characters of base64 after the underscore.

use crate::error::ContentError;
use crate::lines::Lines;
use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderStringWriter;
use contact_model::{Cells, Size};
use std::io::Write as _;

/// Numbers on the cells of a rectangle.
#[derive(Debug, Clone, Copy)]
pub struct DataArray<'a> {
    /// Name, such as `pressure`.
    pub name: &'a str,
    /// Unit, such as `Pa`; it is written behind the name. Empty or `none` for none.
    pub unit: &'a str,
    /// Values, row-major; NaN at undefined points.
    pub values: &'a [f64],
}

/// How numbers are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    /// Base64 in one section at the end: little-endian float64.
    Base64,
    /// Decimals, exact too, about twice as long; it has no undefined points.
    Ascii,
}

/// VTK's mark of a cell that is not shown (`vtkDataSetAttributes::HIDDENCELL`).
const HIDDEN: u8 = 32;

/// The bytes of a VTI file: fields as data of cells (columns along x, rows along y) on a rectangle of the
/// given size in the plane z = 0, the first corner at the origin. A single number for the cells or the size
/// makes it a square.
///
/// Row 0 is at y = 0. In ParaView, "Cell Data to Point Data" goes before "Warp By Scalar". An undefined point
/// is NaN in the field, and VTK's array `vtkGhostType` hides the cells where any field is undefined; without
/// such a point there is no such array.
///
/// # Errors
/// [`ContentError::OutOfRange`] for a field of another size or a side that is not positive,
/// [`ContentError::NoCells`] for no rows or columns; [`ContentError::NotFinite`] for a field with an
/// infinity, and in [`Encoding::Ascii`] for one with a NaN: VTK's reader of decimals stops there.
///
/// ```
/// use surface_io::{Encoding, DataArray, vti};
/// let field = DataArray { name: "height", unit: "m", values: &[0.0, 1.0, 2.0, 3.0] };
/// let file = String::from_utf8(vti(2, [1.0, 4.0], &[field], Encoding::Ascii)?)?;
/// assert!(file.contains("WholeExtent=\"0 2 0 2 0 0\" Origin=\"0 0 0\" Spacing=\"0.5 2 0.5\""));
/// assert!(file.contains("<DataArray type=\"Float64\" Name=\"height [m]\" format=\"ascii\">\n0 1\n2 3\n</DataArray>"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn vti(
    cells: impl Into<Cells>,
    size: impl Into<Size>,
    fields: &[DataArray<'_>],
    encoding: Encoding,
) -> Result<Vec<u8>, ContentError> {
    bytes(ImageGrid { cells: cells.into(), size: size.into(), layers: None }, fields, encoding)
}

/// The bytes of a VTI file with fields on the cells of a box: layers of the same thickness, one behind the other
/// along z, each with columns along x and rows along y. The values of a field go layer by layer, each row-major.
///
/// The first layer begins at z = 0. Otherwise as [`vti`].
///
/// # Errors
/// As [`vti`]; [`ContentError::OutOfRange`] for a thickness that is not positive, [`ContentError::NoCells`] for no
/// layers.
///
/// ```
/// use surface_io::{Encoding, DataArray, vti_volume};
/// let field = DataArray { name: "stress_zz", unit: "Pa", values: &[0.0, 1.0, 2.0, 3.0] };
/// let file = String::from_utf8(vti_volume([2, 1], [1.0, 0.5], 2, 0.25, &[field], Encoding::Ascii)?)?;
/// assert!(file.contains("WholeExtent=\"0 2 0 1 0 2\" Origin=\"0 0 0\" Spacing=\"0.5 0.5 0.25\""));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn vti_volume(
    cells: impl Into<Cells>,
    size: impl Into<Size>,
    layers: usize,
    thickness: f64,
    fields: &[DataArray<'_>],
    encoding: Encoding,
) -> Result<Vec<u8>, ContentError> {
    let layers = Some((layers, thickness));
    bytes(ImageGrid { cells: cells.into(), size: size.into(), layers }, fields, encoding)
}

/// The cells of a rectangle or a box.
#[derive(Clone, Copy)]
struct ImageGrid {
    cells: Cells,
    size: Size,
    /// Number of layers along z and the thickness of each; none for a rectangle.
    layers: Option<(usize, f64)>,
}

fn bytes(grid: ImageGrid, fields: &[DataArray<'_>], encoding: Encoding) -> Result<Vec<u8>, ContentError> {
    check(grid, fields, encoding)?;
    let ImageGrid { cells, .. } = grid;
    let hidden = hidden_cells(fields);
    let count = fields.first().map_or(0, |f| f.values.len());
    let per_field = 24 * count + 200;
    let mut file = Lines::new(head(grid, fields), fields.len() * per_field + 200);
    // Every array is one run of base64 behind the ones before.
    let run = encoded_length(8 * count);
    for (k, field) in fields.iter().enumerate() {
        let title = title(field);
        file.add(format_args!("<DataArray type=\"Float64\" Name=\"{title}\" format="));
        match encoding {
            Encoding::Base64 => file.add(format_args!("\"appended\" offset=\"{}\"/>\n", k * run)),
            Encoding::Ascii => {
                file.add(format_args!("\"ascii\">\n"));
                add_decimals(&mut file, field.values, cells.columns);
                file.add(format_args!("</DataArray>\n"));
            }
        }
    }
    if !hidden.is_empty() {
        let offset = fields.len() * run;
        file.add(format_args!(
            "<DataArray type=\"UInt8\" Name=\"vtkGhostType\" format=\"appended\" offset=\"{offset}\"/>\n"
        ));
    }
    file.add(format_args!("</CellData>\n</Piece>\n</ImageData>\n"));
    if encoding == Encoding::Base64 && !fields.is_empty() {
        add_appended_data(&mut file, fields, &hidden);
    }
    file.add(format_args!("</VTKFile>\n"));
    Ok(file.text.into_bytes())
}

/// Refuses sides, numbers of cells and fields that the file cannot hold.
fn check(grid: ImageGrid, fields: &[DataArray<'_>], encoding: Encoding) -> Result<(), ContentError> {
    let ImageGrid { cells, size, layers } = grid;
    let (count, thickness) = layers.unwrap_or((1, 1.0));
    for (what, side) in
        [("side along x", size.x), ("side along y", size.y), ("thickness of a layer", thickness)]
    {
        if !(side.is_finite() && side > 0.0) {
            return Err(ContentError::OutOfRange { what, value: side, expected: "a finite number > 0" });
        }
    }
    let Cells { columns, rows } = cells;
    if columns == 0 || rows == 0 || count == 0 {
        return Err(ContentError::NoCells { rows: rows as u64, columns: columns as u64 });
    }
    for field in fields {
        if cells.checked_count().and_then(|cells| cells.checked_mul(count)) != Some(field.values.len()) {
            let (what, value) = ("number of values of a field", field.values.len() as f64);
            let expected = if layers.is_some() { "layers x rows x columns" } else { "rows x columns" };
            return Err(ContentError::out_of_range(what, value, expected));
        }
        let wrong = |v: &f64| v.is_infinite() || (v.is_nan() && encoding == Encoding::Ascii);
        if let Some(at) = field.values.iter().position(wrong) {
            return Err(ContentError::NotFinite {
                field: field.name.to_owned(),
                at,
                value: field.values[at],
            });
        }
    }
    Ok(())
}

/// The marks of all cells, of which those with an undefined value are hidden; empty where there are none.
fn hidden_cells(fields: &[DataArray<'_>]) -> Vec<u8> {
    let count = fields.first().map_or(0, |f| f.values.len());
    let undefined = |i: usize| fields.iter().any(|f| f.values[i].is_nan());
    let mut hidden: Vec<u8> = Vec::new();
    if (0..count).any(undefined) {
        hidden.extend((0..count).map(|i| if undefined(i) { HIDDEN } else { 0 }));
    }
    hidden
}

/// The file up to its first array.
fn head(grid: ImageGrid, fields: &[DataArray<'_>]) -> String {
    let ImageGrid { cells: Cells { columns, rows }, size, layers } = grid;
    let active = fields.first().map_or(String::new(), |f| format!(" Scalars=\"{}\"", title(f)));
    let (dx, dy) = (size.x / columns as f64, size.y / rows as f64);
    let (count, dz) = layers.unwrap_or((0, dx));
    let extent = format!("0 {columns} 0 {rows} 0 {count}");
    format!(
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
         <ImageData WholeExtent=\"{extent}\" Origin=\"0 0 0\" Spacing=\"{dx} {dy} {dz}\">\n\
         <Piece Extent=\"{extent}\">\n<PointData></PointData>\n<CellData{active}>\n"
    )
}

/// Writes values as decimals, a line for each row.
fn add_decimals(file: &mut Lines, values: &[f64], columns: usize) {
    for row in values.chunks_exact(columns) {
        for (i, v) in row.iter().enumerate() {
            let end = if i + 1 == columns { '\n' } else { ' ' };
            if v.abs() >= 1e-4 && v.abs() < 1e6 || v.abs() <= 0.0 {
                file.add(format_args!("{v}{end}"));
            } else {
                file.add(format_args!("{v:e}{end}"));
            }
        }
    }
}

/// Writes the section with the numbers of all arrays.
fn add_appended_data(file: &mut Lines, fields: &[DataArray<'_>], hidden: &[u8]) {
    file.add(format_args!("<AppendedData encoding=\"base64\">\n_"));
    for field in fields {
        append(&mut file.text, 8 * field.values.len(), field.values.iter().map(|v| v.to_le_bytes()));
    }
    if !hidden.is_empty() {
        append(&mut file.text, hidden.len(), hidden.iter().map(|&v| [v]));
    }
    file.add(format_args!("\n</AppendedData>\n"));
}

/// Name and unit, safe in an attribute.
fn title(field: &DataArray<'_>) -> String {
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

/// Characters of the run of base64 of an array of this number of bytes.
fn encoded_length(bytes: usize) -> usize {
    4 * (8 + bytes).div_ceil(3)
}

/// Appends a run of base64: the number of bytes, then the bytes.
fn append<const N: usize>(text: &mut String, length: usize, parts: impl Iterator<Item = [u8; N]>) {
    let mut run = EncoderStringWriter::from_consumer(text, &STANDARD);
    // A string takes every byte.
    let _ = run.write_all(&(length as u64).to_le_bytes());
    for part in parts {
        let _ = run.write_all(&part);
    }
    run.into_inner();
}

#[cfg(test)]
mod tests;
