//! What nearly every reader of a format uses.

pub(in crate::instruments) use crate::channel::{
    AxisOrder, Bytes, RawHeights, StoredChannel, StoredUnit, Undefined,
};
pub(in crate::instruments) use crate::cursor::Cursor;
pub(in crate::instruments) use crate::error::Result;
pub(in crate::instruments) use crate::extent::Extent;
pub(in crate::instruments) use crate::fields::{ByteFields, Text, decoded, header};
pub(in crate::instruments) use crate::format::Format;
pub(in crate::instruments) use crate::number_type::{ByteOrder, NumberType};
pub(in crate::instruments) use crate::reader::Reader;
pub(in crate::instruments) use crate::source::OpenedFile;
