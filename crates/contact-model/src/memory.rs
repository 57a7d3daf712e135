//! The memory of a path or of single loads, as bytes that can be kept outside of the contact.

/// The memory of the loads of a contact ([`crate::PreparedContact::memory`]): another contact of the same
/// model, scene and seed can continue from it ([`crate::PreparedContact::recall`]).
///
/// The bytes are those of [postcard](https://postcard.jamesmunns.com), without a name or a version of their
/// format: whoever keeps them must also keep what they belong to, and a check that they are complete.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PathMemory(Vec<u8>);

impl PathMemory {
    /// The memory from its bytes, as [`Self::bytes`] gave them.
    pub fn from_bytes(bytes: Vec<u8>) -> Self {
        Self(bytes)
    }

    /// Its bytes.
    pub fn bytes(&self) -> &[u8] {
        &self.0
    }

    /// The memory from the value that a model remembers.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`] where there is no room for it, [`crate::Error::Shape`] for a value that
    /// cannot be stored as bytes.
    #[cfg(feature = "serde")]
    pub fn of(remembered: &impl serde::Serialize) -> crate::Result<Self> {
        // The length first, so that memory is asked for once.
        let length = postcard::serialize_with_flavor(remembered, postcard::ser_flavors::Size::default());
        let length = length.map_err(|_| Self::unreadable(0))?;
        let mut bytes = Vec::new();
        if bytes.try_reserve_exact(length).is_err() {
            return Err(crate::Error::out_of_memory("the memory of a path", length as f64));
        }
        postcard::to_extend(remembered, bytes).map(Self).map_err(|_| Self::unreadable(length))
    }

    /// The value that a model remembered.
    ///
    /// # Errors
    /// [`crate::Error::Shape`] for bytes that are not of this type, or more than it has.
    #[cfg(feature = "serde")]
    pub fn read<T: serde::de::DeserializeOwned>(&self) -> crate::Result<T> {
        match postcard::take_from_bytes(&self.0) {
            Ok((remembered, [])) => Ok(remembered),
            _ => Err(Self::unreadable(self.0.len())),
        }
    }

    /// The error for bytes that this model did not write on this surface; `found` is their number.
    pub fn unreadable(found: usize) -> crate::Error {
        let expected = "the bytes that this model wrote on this surface".into();
        crate::Error::Shape { name: "memory of a path".into(), found, expected }
    }
}

#[cfg(all(test, feature = "serde"))]
mod tests {
    use super::*;

    type Example = (Vec<f64>, Option<f64>, String);

    #[test]
    fn comes_back_bit_for_bit_or_not_at_all() {
        let remembered = (vec![0.1 + 0.2, -0.0, 5e-324], Some(f64::INFINITY), "branch".to_owned());
        let memory = PathMemory::of(&remembered).unwrap();
        assert_eq!(PathMemory::from_bytes(memory.bytes().to_vec()).read(), Ok(remembered));
        for cut in 0..memory.bytes().len() {
            assert!(PathMemory::from_bytes(memory.bytes()[..cut].to_vec()).read::<Example>().is_err());
        }
        let longer = [memory.bytes(), &[0]].concat();
        assert!(PathMemory::from_bytes(longer).read::<Example>().is_err());
        // A length that no file has.
        assert!(PathMemory::from_bytes(vec![0xff; 9]).read::<Example>().is_err());
    }
}
