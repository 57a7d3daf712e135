//! Maps as X3P.

use crate::error::ContentError;
use crate::write::with_nan;
use crate::zip::archive;
use contact_model::HeightMap;

/// The bytes of an X3P file (ISO 25178-72): float64 heights in metres, row by row, NaN at undefined points;
/// `main.xml` without the record of the instrument, as a map does not know it.
///
/// X3P says the sides of a cell, not those of the map: a side that is read again may differ by its last bit.
///
/// # Errors
/// [`ContentError::OutOfRange`] for a map of 4 GB or more.
///
/// ```
/// use surface_io::{ReadOptions, Scan};
/// let map = contact_model::HeightMap::new(2, [1e-6, 2e-6], vec![0.0, 1e-9, 2e-9, 3e-9])?;
/// let scan = Scan::from_bytes("a.x3p", &surface_io::x3p(&map)?, &ReadOptions::default())?;
/// assert_eq!((scan.height(1, 0), scan.metadata().size.unwrap()[1].value()), (Some(2e-9), 2e-6));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn x3p(map: &HeightMap) -> Result<Vec<u8>, ContentError> {
    let data: Vec<u8> = with_nan(map).iter().flat_map(|height| height.to_le_bytes()).collect();
    let [dx, dy] = [(map.size().x, map.columns()), (map.size().y, map.rows())].map(increment);
    let main = format!(
        r#"<?xml version="1.0" encoding="UTF-8" standalone="no" ?>
<p:ISO5436_2 xmlns:p="http://www.opengps.eu/2008/ISO5436_2" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:schemaLocation="http://www.opengps.eu/2008/ISO5436_2 http://www.opengps.eu/2008/ISO5436_2/ISO5436_2.xsd">
  <Record1>
    <Revision>ISO5436 - 2000</Revision>
    <FeatureType>SUR</FeatureType>
    <Axes>
      <CX>
        <AxisType>I</AxisType>
        <DataType>D</DataType>
        <Increment>{dx:e}</Increment>
        <Offset>0</Offset>
      </CX>
      <CY>
        <AxisType>I</AxisType>
        <DataType>D</DataType>
        <Increment>{dy:e}</Increment>
        <Offset>0</Offset>
      </CY>
      <CZ>
        <AxisType>A</AxisType>
        <DataType>D</DataType>
        <Increment>1</Increment>
        <Offset>0</Offset>
      </CZ>
    </Axes>
  </Record1>
  <Record3>
    <MatrixDimension>
      <SizeX>{}</SizeX>
      <SizeY>{}</SizeY>
      <SizeZ>1</SizeZ>
    </MatrixDimension>
    <DataLink>
      <PointDataLink>bindata/data.bin</PointDataLink>
      <MD5ChecksumPointData>{:X}</MD5ChecksumPointData>
    </DataLink>
  </Record3>
  <Record4>
    <ChecksumFile>md5checksum.hex</ChecksumFile>
  </Record4>
</p:ISO5436_2>
"#,
        map.columns(),
        map.rows(),
        md5::compute(&data),
    );
    let checksum = format!("{:x} *main.xml\n", md5::compute(&main)).into_bytes();
    let value = data.len() as f64;
    archive(&[("main.xml", main.into_bytes()), ("bindata/data.bin", data), ("md5checksum.hex", checksum)])
        .ok_or_else(|| ContentError::out_of_range("bytes of heights", value, "less than 4 GB in X3P"))
}

/// The side of a cell whose multiple is this side, or next to it where no double is.
fn increment((side, count): (f64, usize)) -> f64 {
    let near = side / count as f64;
    let exact = |cell: &f64| (cell * count as f64).to_bits() == side.to_bits();
    [near, near.next_up(), near.next_down()].into_iter().find(exact).unwrap_or(near)
}
