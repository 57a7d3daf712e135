//! What an interface lets through and what it bears, read off the fields of a contact state.
